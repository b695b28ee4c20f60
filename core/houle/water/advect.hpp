// Moving the particles: with the pore velocity u_d / n, along the correction, and never through walls, gates or solids.
#pragma once

#include <houle/exec/reduce.hpp>
#include <houle/water/solids.hpp>
#include <houle/water/surface.hpp>

namespace houle {

// The obstacles that stop a particle beside the walls of the tank: solids, gates, walls between the faces.
template <int D>
struct Obstacles {
  Solids<D> solids;
  Gates gates;
  Paddles paddles;
};

// A particle in a solid comes out of it. Not inlined, and what it is given is copied: few tanks have solids.
template <int D>
HOULE_NOINLINE inline std::array<double, D> outside_solids(const Grid<D> g, const Solids<D> solids, const Gates gates,
                                                           const std::array<double, D> from, std::array<double, D> x) {
  bring_into_tank(g, x.data());
  leave_solids(g, solids, gates, from.data(), x.data());
  return x;
}

// Brings a particle that went from `from` to x back to where water can be: in the tank, outside solids, on its side of
// gates and paddles.
template <int D>
inline void keep_inside(const Grid<D>& g, const Obstacles<D>& obstacles, const double* from, double* x) {
  stop_at_gates(g, obstacles.gates, from, x);
  if (obstacles.solids.edge) {
    const auto out = outside_solids<D>(g, obstacles.solids, obstacles.gates, point<D>(from), point<D>(x));
    std::copy_n(out.begin(), D, x);
  }
  for (int k = 0; k < obstacles.paddles.count; ++k) {
    const Paddle& paddle = obstacles.paddles.paddle[k];
    const double margin = 1e-9 * g.h[0];
    x[0] = paddle.side > 0 ? std::max(x[0], paddle.x + margin) : std::min(x[0], paddle.x - margin);
  }
  bring_into_tank(g, x);
}

// Moves particles with the pore velocity for dt by the midpoint rule (19): x += dt u_d(x_mid) / n(x_mid), x_mid = x +
// dt/2 u_d(x) / n(x). porosity (cells) null: 1. own, volume, bulk: u_d(x) (n, D), V and V/n(x) (n,) of the particles
// where they are known already, else null.
template <int D>
void move(const Grid<D>& g, index n, ConstFaces<D> u, const Listed& porosity, const double* own, const double* volume,
          const double* bulk, const Interfaces<D>& media, const Obstacles<D>& obstacles, double dt, double* x) {
  const auto stride = face_strides(g);
  const auto cell_stride = Grid<D>::strides(g.shape);
  parallel_for(n, [=](index p) {
    double from[D], at[D];
    for (int a = 0; a < D; ++a) from[a] = at[a] = x[D * p + a];
    int stage = 0;
    if (own) {
      const double time = porosity ? 0.5 * dt * bulk[p] / volume[p] : 0.5 * dt;
      for (int a = 0; a < D; ++a) at[a] = from[a] + time * own[D * p + a];
      keep_inside(g, obstacles, from, at);
      stage = 1;
    }
    for (; stage < 2; ++stage) {
      double time = stage == 0 ? 0.5 * dt : dt;
      Stencil<LinearKernel, D> st;
      st.set(g, at);
      if (porosity) time /= st.template gather<-1>(cell_stride, porosity);
      std::array<double, D> v, own_side;
      const auto take = [u, out = &own_side](const Beside<D>& beside) { *out = beside.gather(u); };
      if (beside_interface<LinearKernel, D>(g, stride, media, st, at, {}, take))
        v = own_side;
      else
        each_of<D>([&](auto a) { v[a] = st.template gather<a>(stride[a], u[a]); });
      for (int a = 0; a < D; ++a) at[a] = from[a] + time * v[a];
      keep_inside(g, obstacles, from, at);
    }
    for (int a = 0; a < D; ++a) x[D * p + a] = at[a];
  });
}

// Moves particles with their own velocities: x = from + dt u_d / n, paper (12) and (17). porosity (n,) at the
// particles, null: 1.
template <int D>
void drift(const Grid<D>& g, index n, const double* from, const double* u, const double* porosity,
           const Obstacles<D>& obstacles, double dt, double* x) {
  parallel_for(n, [=](index p) {
    double at[D];
    for (int a = 0; a < D; ++a) at[a] = from[D * p + a] + dt * u[D * p + a] / (porosity ? porosity[p] : 1.0);
    keep_inside(g, obstacles, from + D * p, at);
    for (int a = 0; a < D; ++a) x[D * p + a] = at[a];
  });
}

// Adds the way of the water in a step to `way` (faces, single precision), way += dt u: how far it has come from where
// it was [m]. Returns the largest |way| / n along each axis where a face carries more mass than `least`. porosity
// (cells) null: 1; n is the mean of the cells on both sides of a face.
template <int D>
std::array<double, D> travel(const Grid<D>& g, double dt, ConstFaces<D> u, ConstFaces<D> mass, double least,
                             const Listed& porosity, const std::array<float*, D>& way) {
  constexpr int up = D - 1;
  const index nz = g.shape[up];
  std::array<double, D> farthest{};
  each_of<D>([&](auto axis) {
    constexpr int a = decltype(axis)::value;
    const auto shape = g.face_shape(a);
    const index line = shape[up], rows = g.faces(a) / line;
    const double *ua = u[a], *m = mass[a];
    float* far = way[a];
    const auto each = parallel_values(rows, [=](index r) {
      const auto stride = Grid<D>::strides(g.shape);
      auto low = Grid<D>::unflat(r, rows_of<D>(shape)), high = low;
      if (a != up) {
        low[a] = inside(low[a] - 1, g.shape[a], false);
        high[a] = inside(high[a], g.shape[a], false);
      }
      const index below = Grid<D>::flat(low, stride), above = Grid<D>::flat(high, stride);
      constexpr index block = 256;
      float most = 0.0f, size[block];
      for (index first = 0; first < line; first += block) {
        const index f = r * line + first, count = std::min(block, line - first);
        for (index k = 0; k < count; ++k) {
          far[f + k] = static_cast<float>(far[f + k] + dt * ua[f + k]);
          size[k] = m[f + k] > least ? std::abs(far[f + k]) : 0.0f;
        }
        for (index k = 0; porosity && k < count; ++k) {
          const index kl = a == up ? inside(first + k - 1, nz, false) : first + k,
                      kh = a == up ? inside(first + k, nz, false) : first + k;
          size[k] /= 0.5f * static_cast<float>(porosity[below + kl] + porosity[above + kh]);
        }
        for (index k = 0; k < count; ++k) most = ((size[k] > most) | (size[k] != size[k])) ? size[k] : most;
      }
      return static_cast<double>(most);
    });
    farthest[a] = parallel_max(rows, [far = each.data()](index r) { return far[r]; });
  });
  return farthest;
}

// The largest share of a cell's tent that a flat surface leaves empty while there is water across all faces of the
// cell: the surface then runs through the centres of the cells on one side.
template <int D>
constexpr double corner = D == 2 ? 1.0 / 24.0 : 29.0 / 360.0;

// The excess of each active cell that the position correction spreads, rhs (cells): omega n E, |E| <= 0.25, in -div
// grad psi = omega n E (psi: potential of the Darcy displacement), E = F - 1. Returns the largest |omega n E|.
//
// In a column whose surface eta is its level (column, in cells), the cells that it cuts have none: their level is that
// of the column's volume, and to chase the fill of single surface cells stirs the surface (docs/decisions/0001).
// Elsewhere, where depth says no more than the fill, a deficit next to air is the surface. But a cell with air only at
// an edge or a corner that lacks the place of a particle has a hole, and is filled to what a flat surface leaves.
template <int D>
double density_excess(const Grid<D>& g, const std::uint8_t* active, const double* depth, const double* column,
                      const double* eta, const double* fill, const Listed& open, const Listed& porosity, double omega,
                      double* rhs) {
  return parallel_max(g.cells(), [=](index c) {
    rhs[c] = 0.0;
    if (!active[c]) return 0.0;
    double excess = fill[c] - 1.0;
    const index col = c / g.shape[D - 1];
    if (eta[col] == column[col] * g.h[D - 1]) {
      excess = depth[c] >= 1.0 ? excess : 0.0;
    } else if (excess < 0.0 && !without_air(g, active, open, c)) {
      excess = excess > -particle_place<D> || air_beside(g, active, open, c) ? 0.0 : excess + corner<D>;
    }
    excess = excess > 0.25 ? 0.25 : (excess < -0.25 ? -0.25 : excess);
    rhs[c] = omega * (porosity ? porosity[c] : 1.0) * excess;
    return std::abs(rhs[c]);
  });
}

// Moves particles along a Darcy displacement on the faces [m]: x += displacement(x) / n(x), each component at most
// `limit` cells.
template <int D>
void displace(const Grid<D>& g, index n, ConstFaces<D> displacement, const Listed& porosity,
              const Obstacles<D>& obstacles, double limit, double* x) {
  const auto stride = face_strides(g);
  const auto cell_stride = Grid<D>::strides(g.shape);
  parallel_for(n, [=](index p) {
    double from[D], at[D];
    for (int a = 0; a < D; ++a) from[a] = x[D * p + a];
    Stencil<LinearKernel, D> st;
    st.set(g, from);
    const double slow = porosity ? 1.0 / st.template gather<-1>(cell_stride, porosity) : 1.0;
    each_of<D>([&](auto a) {
      const double d = slow * st.template gather<a>(stride[a], displacement[a]), most = limit * g.h[a];
      at[a] = from[a] + std::min(std::max(d, -most), most);
    });
    keep_inside(g, obstacles, from, at);
    for (int a = 0; a < D; ++a) x[D * p + a] = at[a];
  });
}

}  // namespace houle
