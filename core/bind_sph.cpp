// Bindings of sph.hpp, by kernel name.
#include "bind.hpp"
#include "sph.hpp"

namespace houle {

template <class F>
static void with_kernel(const std::string& name, int dimension, double radius, F f) {
  if (!(radius > 0)) throw std::invalid_argument("the radius of the kernel must be positive");
  if (name == "wendland") return f(WendlandC2(dimension, radius));
  if (name == "gaussian") return f(TruncatedGaussian(dimension, radius));
  throw std::invalid_argument("unknown SPH kernel " + name);
}

template <int D>
static Walls<D> walls_of(const std::vector<std::string>& names) {  // lower and upper side of each axis in turn
  if (names.size() != 2 * D) throw std::invalid_argument("walls needs two names per axis");
  Walls<D> walls;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] != "free" && names[k] != "slip" && names[k] != "no-slip")
      throw std::invalid_argument("unknown wall " + names[k]);
    walls.side[k / 2][k % 2] = names[k] == "free" ? Wall::free : (names[k] == "slip" ? Wall::slip : Wall::no_slip);
  }
  return walls;
}

template <int D>
static Neighbours<D> neighbours(const Grid<D>& g, const Walls<D>& walls, const Array<double>& x,
                                const Array<std::int32_t>& start) {
  const index n = points_of<D>(x, "position");
  require_start(g, start, n);
  return {g, walls, n, x.data(), start.data()};
}

template <int D>
static void bind(nb::module_& m) {
  using Names = std::vector<std::string>;
  m.def(
      "sph_density_sum",
      [](const Grid<D>& g, const Names& walls, const std::string& kernel, double radius, Array<double> x,
         Array<std::int32_t> start, Array<double> bulk, Array<double> out) {
        const auto near = neighbours<D>(g, walls_of<D>(walls), x, start);
        require_size(bulk.size(), near.n, "bulk");
        require_size(out.size(), near.n, "out");
        with_kernel(kernel, D, radius, [&](const auto& k) {
          nb::gil_scoped_release release;
          density_sum<D>(near, k, bulk.data(), out.data());
        });
      },
      "grid"_a, "walls"_a, "kernel"_a, "radius"_a, "position"_a, "cell_start"_a, "bulk"_a, "out"_a,
      "out (N,) = sum_j bulk_j W(x_i - x_j).");
  m.def(
      "sph_viscous_acceleration",
      [](const Grid<D>& g, const Names& walls, const std::string& kernel, double radius, Array<double> x,
         Array<std::int32_t> start, Array<double> u, Array<double> bulk, Array<double> nu, Array<double> out) {
        const auto near = neighbours<D>(g, walls_of<D>(walls), x, start);
        require_size(u.size(), near.n * D, "velocity");
        require_size(bulk.size(), near.n, "bulk");
        require_size(nu.size(), near.n, "viscosity");
        require_size(out.size(), near.n * D, "out");
        with_kernel(kernel, D, radius, [&](const auto& k) {
          nb::gil_scoped_release release;
          viscous_acceleration<D>(near, k, u.data(), bulk.data(), nu.data(), out.data());
        });
      },
      "grid"_a, "walls"_a, "kernel"_a, "radius"_a, "position"_a, "cell_start"_a, "velocity"_a, "bulk"_a, "viscosity"_a,
      "out"_a, "out (N, d): the viscous term of the paper's eq. (3).");
  m.def(
      "sph_velocity_gradient",
      [](const Grid<D>& g, const std::string& kernel, double radius, Array<double> x, Array<std::int32_t> start,
         Array<double> u, Array<double> bulk, Array<double> out) {
        const auto near = neighbours<D>(g, Walls<D>{}, x, start);
        require_size(u.size(), near.n * D, "velocity");
        require_size(bulk.size(), near.n, "bulk");
        require_size(out.size(), near.n * D * D, "out");
        with_kernel(kernel, D, radius, [&](const auto& k) {
          nb::gil_scoped_release release;
          velocity_gradient<D>(near, k, u.data(), bulk.data(), out.data());
        });
      },
      "grid"_a, "kernel"_a, "radius"_a, "position"_a, "cell_start"_a, "velocity"_a, "bulk"_a, "out"_a,
      "out (N, d, d) = du_a/dx_b, exact for linear fields.");
}

void bind_sph(nb::module_& m) {
  bind<2>(m);
  bind<3>(m);
}

}  // namespace houle
