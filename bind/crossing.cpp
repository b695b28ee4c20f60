// Bindings of crossing.hpp: particles and faces where water crosses from one porosity to another.
#include <houle/compiled/lists.hpp>
#include <houle/water/crossing.hpp>

#include "medium.hpp"

namespace houle {

template <int D>
static Crossing<D> crossing_of(const Grid<D>& g, const FaceNumbers& number, const Given& table,
                               const ListedField& inertia, const ListedField& uniform, const GivenMasks* held,
                               const OptionalInterfaces& interfaces = {}) {
  const auto materials = materials_of(table);
  return {numbers_of(g, number, materials.n, false),
          materials.data,
          listed_of(g, inertia, "cell_inertia"),
          listed_of(g, uniform, "uniform"),
          held ? faces(g, *held, "held") : ConstFaces<D, std::uint8_t>(),
          interfaces_of(g, interfaces)};
}

template <int D>
static void bind_crossing(nb::module_& m) {
  using G = const Grid<D>&;
  define(
      m, "sample_medium",
      [](G g, FaceNumbers number, Given table, ListedField cell_inertia, ListedField uniform, ListedField porosity,
         Given x, Given volume, Field bulk, Array<float> inertia, OptionalInterfaces interfaces) {
        const auto at = points<D>(x, "position");
        const auto medium = crossing_of<D>(g, number, table, cell_inertia, uniform, nullptr, interfaces);
        const Listed pores = listed_of(g, porosity, "porosity");
        const double* v = entries(volume, at.n, "volume");
        double* b = entries(bulk, at.n, "bulk");
        float* J = entries(inertia, at.n * D, "inertia");
        nb::gil_scoped_release release;
        sample_medium<D>(g, at.n, medium, pores, at.data, v, b, J);
      },
      "grid"_a, "number"_a, "table"_a, "cell_inertia"_a, "uniform"_a, "porosity"_a, "position"_a, "volume"_a, "bulk"_a,
      "inertia"_a, "interfaces"_a = nb::none(),
      "Bulk volume and inertia at the particles, linear from the cells and the faces.");
  define(
      m, "hold_faces",
      [](G g, GivenMask active, ListedField open, ListedField contrast, double most, Arrays<std::uint8_t> held) {
        const std::uint8_t* wet = cells(g, active, "active");
        const Listed o = listed_of(g, open, "open"), c = listed_of(g, contrast, "contrast");
        const auto h = of_faces(g, held, "held");
        nb::gil_scoped_release release;
        hold_faces<D>(g, wet, o, c, most, h);
      },
      "grid"_a, "active"_a, "open"_a, "contrast"_a, "most"_a, "held"_a,
      "Marks the faces near porous ones whose flux the pressure on both sides holds: there the Bernoulli force "
      "acts.");
  define(
      m, "carry",
      [](G g, FaceNumbers number, Given table, ListedField cell_inertia, ListedField uniform, GivenMasks held,
         ListedField porosity, ListedField coefficient, double dt, Given x, Given volume, Field bulk,
         Array<float> inertia, Field u, OptionalListed lag, OptionalGiven ago, OptionalInterfaces interfaces) {
        const auto at = points<D>(x, "position");
        const auto medium = crossing_of<D>(g, number, table, cell_inertia, uniform, &held, interfaces);
        const Listed pores = listed_of(g, porosity, "porosity"), C = listed_of(g, coefficient, "coefficient");
        const Listed behind = listed_of(g, lag, "lag");
        const double *v = entries(volume, at.n, "volume"), *share = entries(ago, at.n, "ago");
        if (static_cast<bool>(behind) != (share != nullptr)) refuse("lag and ago go together");
        double *b = entries(bulk, at.n, "bulk"), *uu = entries(u, at.n * D, "u");
        float* J = entries(inertia, at.n * D, "inertia");
        nb::gil_scoped_release release;
        carry<D>(g, at.n, medium, pores, C, behind, share, dt, at.data, v, b, J, uu);
      },
      "grid"_a, "number"_a, "table"_a, "cell_inertia"_a, "uniform"_a, "held"_a, "porosity"_a, "coefficient"_a, "dt"_a,
      "position"_a, "volume"_a, "bulk"_a, "inertia"_a, "u"_a, "lag"_a = nb::none(), "ago"_a = nb::none(),
      "interfaces"_a = nb::none(),
      "Gives particles that have moved the medium where they are, and keeps the energy of those that no pressure "
      "holds.");
  define(
      m, "fall_behind",
      [](G g, FaceNumbers number, Given table, ListedField cell_inertia, ListedField uniform, GivenMasks held,
         ListedField lag, ListedField porosity, Givens velocity, double dt, Fields change,
         OptionalInterfaces interfaces) {
        const auto medium = crossing_of<D>(g, number, table, cell_inertia, uniform, &held, interfaces);
        const Listed behind = listed_of(g, lag, "lag"), pores = listed_of(g, porosity, "porosity");
        const auto u = faces(g, velocity, "velocity");
        const auto out = faces(g, change, "change");
        nb::gil_scoped_release release;
        fall_behind<D>(g, medium, behind, pores, u, dt, out);
      },
      "grid"_a, "number"_a, "table"_a, "cell_inertia"_a, "uniform"_a, "held"_a, "lag"_a, "porosity"_a, "velocity"_a,
      "dt"_a, "change"_a, "interfaces"_a = nb::none(),
      "Change of the velocity on faces [m/s] where momentum moves slower than the water: added mass on the rate "
      "alone.");
  define(
      m, "cell_energy",
      [](G g, GivenMask near, Given x, Given bulk, Array<const float> inertia, Given u, Field out) {
        const auto at = points<D>(x, "position");
        const std::uint8_t* where = cells(g, near, "near");
        const double *b = entries(bulk, at.n, "bulk"), *uu = entries(u, at.n * D, "u");
        const float* J = entries(inertia, at.n * D, "inertia");
        double* energy = cells(g, out, "out");
        nb::gil_scoped_release release;
        cell_energy<D>(g, at.n, where, at.data, b, J, uu, energy);
      },
      "grid"_a, "near"_a, "position"_a, "bulk"_a, "inertia"_a, "u"_a, "out"_a,
      "Twice the kinetic energy of the particles in each cell marked near, per unit density; 0 in the others.");
  define(
      m, "scale_by_cell",
      [](G g, Given share, Given x, Field u) {
        const auto at = points<D>(x, "position");
        const double* s = cells(g, share, "share");
        double* uu = entries(u, at.n * D, "u");
        nb::gil_scoped_release release;
        scale_by_cell<D>(g, at.n, s, at.data, uu);
      },
      "grid"_a, "share"_a, "position"_a, "u"_a,
      "Multiplies the velocity of each particle by the share of its cell, in place.");
  define(
      m, "settle",
      [](G g, FaceNumbers number, Given table, ListedField cell_inertia, ListedField uniform, GivenMasks held,
         Givens velocity, Given x, Field u, std::optional<Field> affine, OptionalInterfaces interfaces) {
        const auto at = points<D>(x, "position");
        const auto medium = crossing_of<D>(g, number, table, cell_inertia, uniform, &held, interfaces);
        const auto v = faces(g, velocity, "velocity");
        double *uu = entries(u, at.n * D, "u"), *gradient = entries(affine, at.n * D * D, "affine");
        nb::gil_scoped_release release;
        settle<D>(g, at.n, medium, v, at.data, uu, gradient);
      },
      "grid"_a, "number"_a, "table"_a, "cell_inertia"_a, "uniform"_a, "held"_a, "velocity"_a, "position"_a, "u"_a,
      "affine"_a.none(), "interfaces"_a = nb::none(),
      "Velocities among faces of different inertia: linear from these, with no more energy where no pressure holds "
      "them.");
}

void bind_crossing(nb::module_& m) {
  bind_crossing<2>(m);
  bind_crossing<3>(m);
}

}  // namespace houle
