// Bindings of remesh.hpp. The number of particles changes, so these functions return new arrays.
#include <nanobind/ndarray.h>

#include <houle/compiled/lists.hpp>
#include <houle/water/energy.hpp>
#include <houle/water/remesh.hpp>
#include <houle/water/transfer.hpp>

#include "places.hpp"
#include "solids.hpp"

namespace houle {

using Doubles = nb::ndarray<nb::numpy, double>;

static Doubles as_array(std::vector<double>&& values, std::initializer_list<std::size_t> shape) {
  auto* kept = new std::vector<double>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return Doubles(kept->data(), shape, owner);
}

template <int D>
static std::tuple<Doubles, Doubles, Doubles> as_tuple(ParticleArrays<D>&& p) {
  const std::size_t n = p.volume.size();
  return {as_array(std::move(p.x), {n, D}), as_array(std::move(p.u), {n, D}), as_array(std::move(p.volume), {n})};
}

static void require_finite(index n, const double* values, const char* name) {
  if (!all_finite(n, values)) raise_blown_up(std::string(name) + " of the particles is no longer a number");
}

// Refuses particles that have no position in the tank, or no numbers: they would be handed to nodes at a wall, or be
// looked for without end.
template <int D>
static void require_water(const Grid<D>& g, const ParticleView<D>& p) {
  const double* x = p.x;
  const index n = p.n;
  const index outside = parallel_reduce(
      n, n, [=](index i) { return place_of<D>(g, x + D * i).inside ? n : i; },
      [](index a, index b) { return std::min(a, b); });
  require_inside<D>(outside < n ? outside : -1, x);
  require_finite(n * D, p.u, "velocity");
  require_finite(n, p.volume, "volume");
  if (p.porosity) require_finite(n, p.porosity, "porosity");
}

template <int D>
static ParticleView<D> particles_of(const Grid<D>& g, const Given& x, const Given& u, const Given& volume,
                                    const OptionalGiven& porosity) {
  const auto at = points<D>(x, "position");
  const ParticleView<D> p{at.n, at.data, entries(u, at.n * D, "velocity"), entries(volume, at.n, "volume"),
                          entries(porosity, at.n, "porosity")};
  if (g.cells() > (std::numeric_limits<std::int32_t>::max() >> D))
    refuse("the grid has " + std::to_string(g.cells()) + " cells: at most 2^31 - 1 half cells can be numbered");
  require_water(g, p);
  return p;
}

template <int D>
static void bind_remeshing(nb::module_& m) {
  define(
      m, "remesh_conservative",
      [](const Grid<D>& g, OptionalListed cell_porosity, Array<const std::int8_t> body, Outline outline, Given x,
         Given u, Given volume, OptionalGiven porosity, index first, index last, OptionalInterfaces interfaces,
         bool along, OptionalGiven gates) {
        const auto media = interfaces_of(g, interfaces);
        const auto p = particles_of<D>(g, x, u, volume, porosity);
        const Listed pores = listed_of(g, cell_porosity, "cell_porosity");
        const index half_cells = g.cells() << D;
        const std::int8_t* bodies = entries(body, half_cells, "body");
        const Solids<D> solids = solids_of(g, outline);
        const Gates shut = gates_of(g, gates);
        if (last < 0) last = 2 * g.shape[0];
        if (first < 0 || first >= last || last > 2 * g.shape[0]) refuse("no nodes between walls: first and last");
        ParticleArrays<D> out(0);
        {
          nb::gil_scoped_release release;
          const bool solid = std::any_of(bodies, bodies + half_cells, [](std::int8_t b) { return b < 0; });
          out = remesh_conservative<D>(g, {pores, bodies, media, along, solid}, solids, shut, p, first, last);
        }
        return as_tuple<D>(std::move(out));
      },
      "grid"_a, "cell_porosity"_a.none(), "body"_a, "solids"_a.none(), "position"_a, "velocity"_a, "volume"_a,
      "porosity"_a.none(), "first"_a = 0, "last"_a = -1, "interfaces"_a = nb::none(), "along"_a = true,
      "gates"_a = nb::none(),
      "New particles (position, velocity, volume) on the lattice of half cells; volume, momentum and centre are "
      "conserved.");
  define(
      m, "remesh_paper",
      [](const Grid<D>& g, Given x, Given u, Given volume, OptionalGiven porosity, double threshold,
         OptionalGiven gates) {
        const Gates shut = gates_of(g, gates);
        const auto p = particles_of<D>(g, x, u, volume, porosity);
        ParticleArrays<D> out(0);
        {
          nb::gil_scoped_release release;
          out = remesh_paper<D>(g, shut, p, threshold);
        }
        return as_tuple<D>(std::move(out));
      },
      "grid"_a, "position"_a, "velocity"_a, "volume"_a, "porosity"_a.none(), "threshold"_a, "gates"_a = nb::none(),
      "New particles (position, velocity, volume): a full one on every lattice node whose fill exceeds the "
      "threshold.");
}

void bind_remesh(nb::module_& m) {
  bind_remeshing<2>(m);
  bind_remeshing<3>(m);
}

}  // namespace houle
