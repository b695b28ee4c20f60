// Water at rest in a tank, by the core alone: one time step of a pool whose surface cuts through cells.
//
// Nothing may move, and p = g (level - z) in the centre of every cell under water: with p = 0 on the true surface this
// is exact on the grid. Allowed is what the divergence that the pressure solver may leave makes where it has one sign
// everywhere: the velocity r z, and the pressure r (level^2 - z^2) / (2 dt).
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <numeric>
#include <vector>

#include <houle/pressure/poisson.hpp>
#include <houle/pressure/projection.hpp>
#include <houle/water/advect.hpp>
#include <houle/water/forces.hpp>
#include <houle/water/surface.hpp>
#include <houle/water/transfer.hpp>

namespace rest {

using namespace houle;
using houle::index;  // not that of <strings.h>

constexpr double gravity = 9.81;    // [m/s2]
constexpr double step = 0.01;       // [s]
constexpr double residual = 1e-10;  // divergence that the solver may leave [1/s]

template <class Number, int D>
struct FaceFields {  // one field for each axis, and what the core takes
  std::array<std::vector<Number>, D> store;
  std::array<Number*, D> data;

  FaceFields(const Grid<D>& g, Number value) {
    for (int a = 0; a < D; ++a) {
      store[a].assign(static_cast<std::size_t>(g.faces(a)), value);
      data[a] = store[a].data();
    }
  }
  Faces<D, Number> all() { return {data}; }
};

// Two particles per cell and axis up to `level` [m], in an order that is no order. The uppermost row, which the surface
// cuts, holds less water than the others.
template <int D>
struct Pool {
  std::vector<double> x, u, volume;

  Pool(const Grid<D>& g, double level) {
    constexpr int up = D - 1;
    const double row = 0.5 * g.h[up], rows = level / row;
    std::array<index, D> shape;
    for (int a = 0; a < D; ++a) shape[a] = 2 * g.shape[a];
    shape[up] = static_cast<index>(std::ceil(rows));
    const index n = std::accumulate(shape.begin(), shape.end(), index{1}, std::multiplies<>());
    for (index k = 0; k < n; ++k) {
      const auto i = Grid<D>::unflat(k * 7919 % n, shape);  // a prime that does not divide n
      const double share = std::min(1.0, rows - static_cast<double>(i[up]));
      for (int a = 0; a < up; ++a) x.push_back((static_cast<double>(i[a]) + 0.5) * 0.5 * g.h[a]);
      x.push_back((static_cast<double>(i[up]) + 0.5 * share) * row);
      volume.push_back(share * g.cell_volume() / (1 << D));
    }
    u.assign(x.size(), 0.0);
  }
  index count() const { return static_cast<index>(volume.size()); }
};

inline bool check(bool good, const char* what, double value) {
  std::printf("%-4s %s: %.2e\n", good ? "ok" : "BAD", what, value);
  return good;
}

// Returns true if water at rest stays at rest to round-off; prints each check on standard output.
template <int D>
inline bool at_rest(const Grid<D>& g, double level) {
  constexpr int up = D - 1;
  const index cells = g.cells(), columns = cells / g.shape[up];
  Pool<D> water(g, level);

  std::vector<std::int32_t> order(water.volume.size()), start(static_cast<std::size_t>(cells) + 1);
  std::vector<double> spare(water.x.size());
  const index outside = sort_particles(g, water.count(), water.x.data(), water.u.data(), water.volume.data(),
                                       spare.data(), order.data(), start.data());
  bool good = check(outside == -1 && start.back() == water.count(), "particles outside", static_cast<double>(outside));

  // The surface and the fill of the cells.
  const std::vector<double> capacity(static_cast<std::size_t>(cells), 1.0 / g.cell_volume());
  const std::vector<std::int32_t> one(static_cast<std::size_t>(cells), 0);  // all cells are alike: open
  const std::vector<double> wide{1.0};
  const Listed open_cells{one.data(), wide.data()};
  std::vector<double> fill(capacity.size()), depth(capacity.size());
  std::vector<double> height(static_cast<std::size_t>(columns)), column(height.size()), eta(height.size());
  std::vector<std::uint8_t> active(capacity.size());
  scatter_cells(g, start.data(), water.x.data(), water.volume.data(), {}, {}, capacity.data(), fill.data());
  column_heights(g, start.data(), water.x.data(), water.volume.data(), {}, {}, height.data());
  find_surface(g, fill.data(), open_cells, height.data(), {}, depth.data(), active.data(), column.data(), eta.data());
  double worst = 0.0;
  for (double e : eta) worst = std::max(worst, std::abs(e - level));
  good &= check(worst < 1e-13, "surface is off by [m]", worst);

  // Velocities of the faces, gravity.
  FaceFields<double, D> velocity(g, 0.0), mass(g, 0.0), coefficient(g, 0.0);
  FaceFields<float, D> open(g, 1.0f);
  FaceFields<std::uint8_t, D> valid(g, 0);
  const Cloud<D> cloud{water.count(), water.x.data(), nullptr, water.volume.data(), start.data(), {}};
  to_faces<LinearKernel, D>(g, cloud, water.u.data(), nullptr, velocity.all(), mass.all());
  double down[D] = {};
  down[up] = -gravity;
  apply_forces<D>(g, velocity.all(), {}, down, {}, step, velocity.all(), {}, {});

  // The pressure that takes it off again.
  std::vector<double> air(capacity.size()), rhs(capacity.size()), pressure(capacity.size(), 0.0);
  constexpr double least = 1e-6;  // depth of a centre that counts, in cells
  pressure_system<D>(g, active.data(), depth.data(), open.all(), {}, step, velocity.all(), least, coefficient.all(),
                     air.data(), rhs.data());
  PressureSolver<D> solver(g);
  solver.setup(active.data(), coefficient.all(), air.data());
  const SolveResult solved = solver.solve(rhs.data(), pressure.data(), residual, 200);
  good &= check(solved.iterations > 0, "residual [1/s]", solved.residual);
  worst = 0.0;
  for (index c = 0; c < cells; ++c) {
    const double below = level - (static_cast<double>(c % g.shape[up]) + 0.5) * g.h[up];
    if (active[static_cast<std::size_t>(c)] != (below > 0.0)) return check(false, "cells under water", below);
    if (below > 0.0) worst = std::max(worst, std::abs(pressure[static_cast<std::size_t>(c)] - gravity * below));
  }
  good &= check(worst < 0.5 * residual * level * level / step, "pressure is off by [m2/s2]", worst);

  project<D>(g, active.data(), depth.data(), open.all(), {}, step, pressure.data(), least, velocity.all(), valid.data,
             false);
  extrapolate<D>(g, 4, 2, {}, 0.0, velocity.all(), valid.data);
  worst = 0.0;
  for (const auto& field : velocity.store)
    for (double v : field) worst = std::max(worst, std::abs(v));
  good &= check(worst < residual * level, "velocity of the faces [m/s]", worst);

  // The particles stay where they are.
  to_particles<LinearKernel, D>(g, cloud, velocity.all(), {}, {}, 0.0, water.u.data());
  const std::vector<double> sorted = water.x;
  move<D>(g, water.count(), velocity.all(), {}, nullptr, nullptr, nullptr, {}, {}, step, water.x.data());
  worst = 0.0;
  for (std::size_t k = 0; k < sorted.size(); ++k) worst = std::max(worst, std::abs(water.x[k] - sorted[k]));
  return check(worst < residual * level * step, "way of the particles [m]", worst) && good;
}

}  // namespace rest
