// Bindings of sph.hpp, by kernel name.
#include <houle/compiled/lists.hpp>
#include <houle/water/sph.hpp>

#include "arguments.hpp"

namespace houle {

template <class F>
static void with_kernel(const std::string& name, int dimension, double radius, F f) {
  if (!(radius > 0)) refuse("radius must be positive, not " + std::to_string(radius));
  if (name == "wendland") return f(WendlandC2(dimension, radius));
  if (name == "gaussian") return f(TruncatedGaussian(dimension, radius));
  refuse("unknown SPH kernel " + name);
}

template <int D>
static Walls<D> walls_of(const std::vector<std::string>& names) {  // lower and upper side of each axis in turn
  if (names.size() != 2 * D) refuse("walls needs two names per axis");
  Walls<D> walls;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] != "free" && names[k] != "slip" && names[k] != "no-slip") refuse("walls: unknown wall " + names[k]);
    walls.side[k / 2][k % 2] = names[k] == "free" ? Wall::free : (names[k] == "slip" ? Wall::slip : Wall::no_slip);
  }
  return walls;
}

constexpr double farthest = 32.0;  // cells that a kernel may reach

template <int D>
static Neighbours<D> neighbours(const Grid<D>& g, const Walls<D>& walls, double radius, const Given& x,
                                const Numbers& start) {
  const auto at = points<D>(x, "position");
  for (double h : g.h)
    if (radius > farthest * h) refuse("radius reaches " + std::to_string(radius / h) + " cells: at most 32");
  return {g, walls, at.n, at.data, cell_start_of(g, start, at.n)};
}

template <int D>
static void bind_sums_of_neighbours(nb::module_& m) {
  using Names = std::vector<std::string>;
  define(
      m, "sph_density_sum",
      [](const Grid<D>& g, const Names& walls, const std::string& kernel, double radius, Given x, Numbers cell_start,
         Given bulk, Field out) {
        const auto near = neighbours<D>(g, walls_of<D>(walls), radius, x, cell_start);
        const double* b = entries(bulk, near.n, "bulk");
        double* sums = entries(out, near.n, "out");
        with_kernel(kernel, D, radius, [&](const auto& k) {
          nb::gil_scoped_release release;
          density_sum<D>(near, k, b, sums);
        });
      },
      "grid"_a, "walls"_a, "kernel"_a, "radius"_a, "position"_a, "cell_start"_a, "bulk"_a, "out"_a,
      "Volume sum at the particles: out (N,) = sum_j bulk_j W(x_i - x_j), 1 in full water.");
  define(
      m, "sph_viscous_acceleration",
      [](const Grid<D>& g, const Names& walls, const std::string& kernel, double radius, Given x, Numbers cell_start,
         Given u, Given bulk, Given nu, Field out) {
        const auto near = neighbours<D>(g, walls_of<D>(walls), radius, x, cell_start);
        const double *v = entries(u, near.n * D, "velocity"), *b = entries(bulk, near.n, "bulk"),
                     *eddies = entries(nu, near.n, "viscosity");
        double* a = entries(out, near.n * D, "out");
        with_kernel(kernel, D, radius, [&](const auto& k) {
          nb::gil_scoped_release release;
          sph_viscous_acceleration<D>(near, k, v, b, eddies, a);
        });
      },
      "grid"_a, "walls"_a, "kernel"_a, "radius"_a, "position"_a, "cell_start"_a, "velocity"_a, "bulk"_a, "viscosity"_a,
      "out"_a, "Viscous acceleration of the particles, eq. (3) of the paper: out (N, d) [m/s2].");
  define(
      m, "sph_velocity_gradient",
      [](const Grid<D>& g, const std::string& kernel, double radius, Given x, Numbers cell_start, Given u, Given bulk,
         Field out) {
        const auto near = neighbours<D>(g, Walls<D>{}, radius, x, cell_start);
        const double *v = entries(u, near.n * D, "velocity"), *b = entries(bulk, near.n, "bulk");
        double* slope = entries(out, near.n * D * D, "out");
        with_kernel(kernel, D, radius, [&](const auto& k) {
          nb::gil_scoped_release release;
          velocity_gradient<D>(near, k, v, b, slope);
        });
      },
      "grid"_a, "kernel"_a, "radius"_a, "position"_a, "cell_start"_a, "velocity"_a, "bulk"_a, "out"_a,
      "Velocity gradient at the particles, exact for linear fields: out (N, d, d) = du_a/dx_b.");
}

void bind_sph(nb::module_& m) {
  bind_sums_of_neighbours<2>(m);
  bind_sums_of_neighbours<3>(m);
}

}  // namespace houle
