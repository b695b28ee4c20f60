// Bindings of remesh.hpp. The number of particles changes, so these functions return new arrays.
#include "bind.hpp"
#include "bind_solids.hpp"
#include "remesh.hpp"

namespace houle {

using Doubles = nb::ndarray<nb::numpy, double>;

static Doubles as_array(std::vector<double>&& values, std::initializer_list<std::size_t> shape) {
  auto* kept = new std::vector<double>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return Doubles(kept->data(), shape, owner);
}

template <int D>
static nb::tuple as_tuple(ParticleArrays<D>&& p) {
  const std::size_t n = p.volume.size();
  return nb::make_tuple(as_array(std::move(p.x), {n, D}), as_array(std::move(p.u), {n, D}),
                        as_array(std::move(p.volume), {n}));
}

template <int D>
static ParticleView<D> particles_of(const Array<double>& x, const Array<double>& u, const Array<double>& volume,
                                    const OptionalField& porosity) {
  const index n = points_of<D>(x, "position");
  if (points_of<D>(u, "velocity") != n) throw std::invalid_argument("velocity and position differ in length");
  require_size(volume.size(), n, "volume");
  if (porosity) require_size(porosity->size(), n, "porosity");
  return {n, x.data(), u.data(), volume.data(), pointer(porosity)};
}

template <int D>
static void bind(nb::module_& m) {
  m.def(
      "remesh_conservative",
      [](const Grid<D>& g, OptionalListed cells, Array<std::int8_t> body, Outline outline, Field x, Field u,
         Field volume, OptionalField porosity, index first, index last) {
        const auto p = particles_of<D>(x, u, volume, porosity);
        const Listed pores = listed_of(g, cells, "cell_porosity");
        require_size(body.size(), g.cells() << D, "body");
        const Solids<D> solids = solids_of(g, outline);
        if (last < 0) last = 2 * g.shape[0];
        if (first < 0 || first >= last || last > 2 * g.shape[0]) throw std::invalid_argument("no nodes between walls");
        ParticleArrays<D> out(0);
        {
          nb::gil_scoped_release release;
          out = remesh_conservative<D>(g, {pores, body.data()}, solids, p, first, last);
        }
        return as_tuple<D>(std::move(out));
      },
      "grid"_a, "cell_porosity"_a.none(), "body"_a, "solids"_a.none(), "position"_a, "velocity"_a, "volume"_a,
      "porosity"_a.none(), "first"_a = 0, "last"_a = -1,
      "(position, velocity, volume) on the half-cell lattice; volume, momentum and centre conserved.");
  m.def(
      "remesh_paper",
      [](const Grid<D>& g, Field x, Field u, Field volume, OptionalField porosity, double threshold) {
        const auto p = particles_of<D>(x, u, volume, porosity);
        ParticleArrays<D> out(0);
        {
          nb::gil_scoped_release release;
          out = remesh_paper<D>(g, p, threshold);
        }
        return as_tuple<D>(std::move(out));
      },
      "grid"_a, "position"_a, "velocity"_a, "volume"_a, "porosity"_a.none(), "threshold"_a,
      "(position, velocity, volume): a full particle on every lattice node whose fill exceeds the threshold.");
}

void bind_remesh(nb::module_& m) {
  bind<2>(m);
  bind<3>(m);
}

}  // namespace houle
