// Bindings of surface, forces, projection, extrapolation, moving particles and sums.
#include "advect.hpp"
#include "bind.hpp"
#include "bind_solids.hpp"
#include "crossing.hpp"
#include "energy.hpp"
#include "held.hpp"
#include "projection.hpp"
#include "viscous.hpp"

namespace houle {

using Mask = Array<std::uint8_t>;
using FaceFields = std::vector<Field>;  // empty: null
using FloatFaceFields = std::vector<Array<float>>;

template <int D, class Real>
static ConstFaces<D, Real> optional_faces(const Grid<D>& g, std::vector<Array<Real>>& f, const char* name) {
  return f.empty() ? ConstFaces<D, Real>() : ConstFaces<D, Real>(faces_of(g, f, name));
}

template <int D>
static std::array<std::uint8_t*, D> masks_of(const Grid<D>& g, std::vector<Mask>& f) {
  if (f.size() != D) throw std::invalid_argument("masks need one array per axis");
  std::array<std::uint8_t*, D> out;
  for (int a = 0; a < D; ++a) {
    require_size(f[a].size(), g.faces(a), "mask");
    out[a] = f[a].data();
  }
  return out;
}

using FaceNumbers = std::vector<Array<std::int32_t>>;  // empty: null

static const Material* materials_of(const Field& table) {  // (K, 3)
  static_assert(sizeof(Material) == 3 * sizeof(double));
  if (table.ndim() != 2 || table.shape(1) != 3) throw std::invalid_argument("the materials must have shape (K, 3)");
  return reinterpret_cast<const Material*>(table.data());
}

template <int D>
static Resistance<D> resistance_of(const Grid<D>& g, FaceNumbers& number, const OptionalField& table, FaceFields& rate,
                                   const OptionalListed& energy, std::vector<Mask>& held) {
  Resistance<D> r;
  if (!table) return r;
  r.number = optional_faces(g, number, "number");
  r.table = materials_of(*table);
  r.rate = optional_faces(g, rate, "rate");
  r.energy = listed_of(g, energy, "energy");
  r.held = optional_faces(g, held, "held");
  return r;
}

template <int D>
static Obstacles<D> obstacles_of(const Grid<D>& g, const Outline& solids, const Field& gates,
                                 const OptionalField& paddles) {
  static_assert(sizeof(Gate) == 2 * sizeof(double));
  return {solids_of(g, solids), reinterpret_cast<const Gate*>(gates.data()), static_cast<int>(gates.size() / 2),
          paddles_of(paddles)};
}

template <int D>
static Crossing<D> crossing_of(const Grid<D>& g, FaceNumbers& number, const Field& table, const ListedField& contrast,
                               std::vector<Mask>& held) {
  return {ConstFaces<D, std::int32_t>(faces_of(g, number, "number")), materials_of(table),
          listed_of<D>(g, contrast, "contrast"), optional_faces(g, held, "held")};
}

template <int D>
static void bind_crossing(nb::module_& m) {
  using G = const Grid<D>&;
  m.def(
      "sample_medium",
      [](G g, FaceNumbers number, Field table, ListedField contrast, ListedField porosity, Field x, Field volume,
         Field bulk, Array<float> inertia) {
        const index n = points_of<D>(x, "position");
        std::vector<Mask> none;
        const auto medium = crossing_of<D>(g, number, table, contrast, none);
        const Listed pores = listed_of<D>(g, porosity, "porosity");
        require_size(volume.size(), n, "volume");
        require_size(bulk.size(), n, "bulk");
        require_size(inertia.size(), n * D, "inertia");
        nb::gil_scoped_release release;
        sample_medium<D>(g, n, medium, pores, x.data(), volume.data(), bulk.data(), inertia.data());
      },
      "grid"_a, "number"_a, "table"_a, "contrast"_a, "porosity"_a, "position"_a, "volume"_a, "bulk"_a, "inertia"_a,
      "Bulk volume and inertia at the particles, linear from the cells and the faces.");
  m.def(
      "hold_faces",
      [](G g, Mask active, ListedField open, ListedField contrast, double most, std::vector<Mask> held) {
        require_cells(g, active.size(), "active");
        const Listed o = listed_of<D>(g, open, "open"), c = listed_of<D>(g, contrast, "contrast");
        const auto h = masks_of<D>(g, held);
        nb::gil_scoped_release release;
        hold_faces<D>(g, active.data(), o, c, most, h);
      },
      "grid"_a, "active"_a, "open"_a, "contrast"_a, "most"_a, "held"_a,
      "Faces near porous ones where the pressure of the water on both sides holds its flux.");
  m.def(
      "carry",
      [](G g, FaceNumbers number, Field table, ListedField contrast, std::vector<Mask> held, ListedField coefficient,
         double dt, Field x, Field volume, Field bulk, Array<float> inertia, Field before, Field u) {
        const index n = points_of<D>(x, "position");
        const auto medium = crossing_of<D>(g, number, table, contrast, held);
        const Listed C = listed_of<D>(g, coefficient, "coefficient");
        for (const Field* f : {&volume, &bulk}) require_size(f->size(), n, "particle array");
        require_size(inertia.size(), n * D, "inertia");
        for (const Field* f : {&before, &u}) require_size(f->size(), n * D, "particle array");
        nb::gil_scoped_release release;
        carry<D>(g, n, medium, C, dt, x.data(), volume.data(), bulk.data(), inertia.data(), before.data(), u.data());
      },
      "grid"_a, "number"_a, "table"_a, "contrast"_a, "held"_a, "coefficient"_a, "dt"_a, "position"_a, "volume"_a,
      "bulk"_a, "inertia"_a, "before"_a, "u"_a,
      "Velocities of particles that nothing holds, with the energy they had.");
  m.def(
      "settle",
      [](G g, FaceNumbers number, Field table, ListedField contrast, std::vector<Mask> held, FaceFields velocity,
         Field x, Field u, OptionalField affine) {
        const index n = points_of<D>(x, "position");
        const auto medium = crossing_of<D>(g, number, table, contrast, held);
        const auto v = ConstFaces<D>(faces_of(g, velocity, "velocity"));
        require_size(u.size(), n * D, "u");
        if (affine) require_size(affine->size(), n * D * D, "affine");
        double* gradient = affine ? affine->data() : nullptr;
        nb::gil_scoped_release release;
        settle<D>(g, n, medium, v, x.data(), u.data(), gradient);
      },
      "grid"_a, "number"_a, "table"_a, "contrast"_a, "held"_a, "velocity"_a, "position"_a, "u"_a, "affine"_a.none(),
      "Velocities of particles that nothing holds, with no more energy than the faces around them have.");
}

template <int D>
static void bind(nb::module_& m) {
  using G = const Grid<D>&;
  bind_crossing<D>(m);
  m.def(
      "column_heights",
      [](G g, Array<std::int32_t> start, Field x, Field volume, Field height, OptionalField paddles) {
        const index n = points_of<D>(x, "position");
        require_size(volume.size(), n, "volume");
        require_start(g, start, n);
        require_columns(g, height.size(), "height");
        nb::gil_scoped_release release;
        column_heights<D>(g, start.data(), x.data(), volume.data(), paddles_of(paddles), height.data());
      },
      "grid"_a, "start"_a, "position"_a, "volume"_a, "height"_a, "paddles"_a = nb::none(),
      "Height of the water in each column of cells [m].");
  m.def(
      "column_levels",
      [](G g, Field height, Field porosity, Field fill, Field inverse_capacity, Array<std::int64_t> column,
         Array<std::int64_t> start, Field pieces, Field level) {
        static_assert(sizeof(CapacityPiece) == 5 * sizeof(double));
        const index count = static_cast<index>(column.size());
        require_columns(g, height.size(), "height");
        require_columns(g, porosity.size(), "porosity");
        require_cells(g, fill.size(), "fill");
        require_cells(g, inverse_capacity.size(), "inverse capacity");
        require_size(start.size(), count + 1, "start");
        require_size(pieces.size(), 5 * start.data()[count], "pieces");
        require_columns(g, level.size(), "level");
        nb::gil_scoped_release release;
        column_levels<D>(g, height.data(), porosity.data(), fill.data(), inverse_capacity.data(), count, column.data(),
                         start.data(), reinterpret_cast<const CapacityPiece*>(pieces.data()), level.data());
      },
      "grid"_a, "height"_a, "porosity"_a, "fill"_a, "inverse_capacity"_a, "column"_a, "start"_a, "pieces"_a, "level"_a,
      "Level to which their water fills the pores of the columns [m].");
  m.def(
      "find_surface",
      [](G g, Field fill, ListedField open, Field level, Field depth, Mask active, Field column, Field eta) {
        require_cells(g, fill.size(), "fill");
        const Listed o = listed_of(g, open, "open");
        require_cells(g, depth.size(), "depth");
        require_cells(g, active.size(), "active");
        require_columns(g, column.size(), "column");
        require_columns(g, level.size(), "level");
        require_columns(g, eta.size(), "eta");
        nb::gil_scoped_release release;
        find_surface<D>(g, fill.data(), o, level.data(), depth.data(), active.data(), column.data(), eta.data());
      },
      "grid"_a, "fill"_a, "open"_a, "level"_a, "depth"_a, "active"_a, "column"_a, "eta"_a,
      "Depth of the cell centres below the free surface [cells], active cells, level of the surface per column [m].");
  m.def(
      "water_above",
      [](G g, Field fill, index row) {
        require_cells(g, fill.size(), "fill");
        nb::gil_scoped_release release;
        return water_above<D>(g, fill.data(), row);
      },
      "grid"_a, "fill"_a, "row"_a, "Whether there is water in this row of cells or above.");
  m.def(
      "water_held",
      [](G g, Mask active, ListedField open, Field fill, Field inverse_capacity, Field height,
         Array<std::int64_t> column, Field held) {
        require_cells(g, active.size(), "active");
        const Listed o = listed_of(g, open, "open");
        require_cells(g, fill.size(), "fill");
        require_cells(g, inverse_capacity.size(), "inverse_capacity");
        const index count = static_cast<index>(column.size());
        require_columns(g, height.size(), "height");
        water_held<D>(g, active.data(), o, fill.data(), inverse_capacity.data(), height.data(), count, column.data(),
                      held.data());
      },
      "grid"_a, "active"_a, "open"_a, "fill"_a, "inverse_capacity"_a, "height"_a, "column"_a, "held"_a,
      "Water in the listed columns [m^d], cells under the surface being full.");
  m.def(
      "apply_forces",
      [](G g, FaceFields u, FaceNumbers number, OptionalField table, FaceFields rate, OptionalListed energy,
         std::vector<Mask> held, std::array<double, D> gravity, FaceFields extra, double dt, FaceFields star,
         FaceFields drag, FaceFields mobility) {
        const auto r = resistance_of<D>(g, number, table, rate, energy, held);
        const auto uu = ConstFaces<D>(faces_of(g, u, "velocity"));
        const auto ex = optional_faces(g, extra, "extra");
        const auto s = faces_of(g, star, "star");
        const auto d = drag.empty() ? Faces<D>() : faces_of(g, drag, "drag");
        const auto b = mobility.empty() && !table ? Faces<D>() : faces_of(g, mobility, "mobility");
        nb::gil_scoped_release release;
        apply_forces<D>(g, uu, r, gravity.data(), ex, dt, s, d, b);
      },
      "grid"_a, "u"_a, "number"_a, "table"_a.none(), "rate"_a, "energy"_a.none(), "held"_a, "gravity"_a, "extra"_a,
      "dt"_a, "star"_a, "drag"_a, "mobility"_a,
      "Body forces, implicit porous resistance and Bernoulli term over one step.");
  m.def(
      "drag_work",
      [](G g, FaceNumbers number, Field table, FaceFields rate, FaceFields mass, FaceFields mobility, FaceFields before,
         FaceFields after) {
        std::vector<Mask> everywhere;
        const auto r = resistance_of<D>(g, number, table, rate, std::nullopt, everywhere);
        const auto mm = ConstFaces<D>(faces_of(g, mass, "mass"));
        const auto mo = ConstFaces<D>(faces_of(g, mobility, "mobility"));
        const auto b = ConstFaces<D>(faces_of(g, before, "before")), e = ConstFaces<D>(faces_of(g, after, "after"));
        nb::gil_scoped_release release;
        return drag_work<D>(g, r, mm, mo, b, e);
      },
      "grid"_a, "number"_a, "table"_a, "rate"_a, "mass"_a, "mobility"_a, "before"_a, "after"_a,
      "Energy the drag took in a step, per unit density.");
  m.def(
      "pressure_system",
      [](G g, Mask active, Field depth, FloatFaceFields open, FaceFields mobility, double step, FaceFields star,
         double least, FaceFields k, Field e, Field rhs) {
        require_cells(g, active.size(), "active");
        require_cells(g, depth.size(), "depth");
        require_cells(g, e.size(), "e");
        require_cells(g, rhs.size(), "rhs");
        const auto o = ConstFaces<D, float>(faces_of(g, open, "open"));
        const auto mo = optional_faces(g, mobility, "mobility");
        const auto st = optional_faces(g, star, "star");
        const auto kk = faces_of(g, k, "k");
        nb::gil_scoped_release release;
        pressure_system<D>(g, active.data(), depth.data(), o, mo, step, st, least, kk, e.data(), rhs.data());
      },
      "grid"_a, "active"_a, "depth"_a, "open"_a, "mobility"_a, "step"_a, "star"_a, "least"_a, "k"_a, "e"_a, "rhs"_a,
      "Coefficients and right-hand side of the pressure system at the sub-cell surface.");
  m.def(
      "project",
      [](G g, Mask active, Field depth, FloatFaceFields open, FaceFields mobility, double step, Field p, double least,
         FaceFields u, std::vector<Mask> valid, bool still) {
        require_cells(g, active.size(), "active");
        require_cells(g, depth.size(), "depth");
        require_cells(g, p.size(), "pressure");
        const auto o = ConstFaces<D, float>(faces_of(g, open, "open"));
        const auto mo = optional_faces(g, mobility, "mobility");
        const auto uu = faces_of(g, u, "velocity");
        const auto v = masks_of(g, valid);
        nb::gil_scoped_release release;
        project<D>(g, active.data(), depth.data(), o, mo, step, p.data(), least, uu, v, still);
      },
      "grid"_a, "active"_a, "depth"_a, "open"_a, "mobility"_a, "step"_a, "pressure"_a, "least"_a, "u"_a, "valid"_a,
      "still"_a = false, "Takes the pressure gradient off the faces of the water, in place; still: u was 0.");
  m.def(
      "extrapolate",
      [](G g, int layers, int near, FaceFields mass, double keep_mass, FaceFields u, std::vector<Mask> known) {
        const auto mm = optional_faces(g, mass, "mass");
        const auto uu = faces_of(g, u, "velocity");
        const auto k = masks_of(g, known);
        nb::gil_scoped_release release;
        extrapolate<D>(g, layers, near, mm, keep_mass, uu, k);
      },
      "grid"_a, "layers"_a, "near"_a, "mass"_a, "keep_mass"_a, "u"_a, "known"_a,
      "Carries known face velocities outwards by averaging, layer by layer.");
  m.def(
      "continue_upwards",
      [](G g, int layers, Mask active, Field column, FaceFields u) {
        require_cells(g, active.size(), "active");
        require_columns(g, column.size(), "column");
        const auto uu = faces_of(g, u, "velocity");
        nb::gil_scoped_release release;
        continue_upwards<D>(g, layers, active.data(), column.data(), uu);
      },
      "grid"_a, "layers"_a, "active"_a, "column"_a, "u"_a,
      "Divergence-free vertical velocity above the surface of single-valued columns.");
  m.def(
      "move",
      [](G g, FaceFields u, OptionalListed porosity, OptionalField own, OptionalField volume, OptionalField bulk,
         Outline solids, Field gates, double dt, Field x, OptionalField paddles) {
        const index n = points_of<D>(x, "position");
        const Listed pores = listed_of(g, porosity, "porosity");
        if (own) require_size(own->size(), n * D, "own velocity");
        if (volume) require_size(volume->size(), n, "volume");
        if (bulk) require_size(bulk->size(), n, "bulk");
        if (own && porosity && !(volume && bulk)) throw std::invalid_argument("own velocity needs volume and bulk");
        const auto uu = ConstFaces<D>(faces_of(g, u, "velocity"));
        const auto obstacles = obstacles_of<D>(g, solids, gates, paddles);
        nb::gil_scoped_release release;
        move<D>(g, n, uu, pores, pointer(own), pointer(volume), pointer(bulk), obstacles, dt, x.data());
      },
      "grid"_a, "u"_a, "porosity"_a.none(), "own"_a.none(), "volume"_a.none(), "bulk"_a.none(), "solids"_a.none(),
      "gates"_a, "dt"_a, "position"_a, "paddles"_a = nb::none(),
      "Moves the particles with the pore velocity, midpoint rule.");
  m.def(
      "travel",
      [](G g, double dt, FaceFields u, FaceFields mass, double least, OptionalListed porosity,
         std::vector<Array<float>> way) {
        const Listed pores = listed_of(g, porosity, "porosity");
        if (way.size() != D) throw std::invalid_argument("way needs one array per axis");
        std::array<float*, D> ways;
        for (int a = 0; a < D; ++a) {
          require_size(way[a].size(), g.faces(a), "way");
          ways[a] = way[a].data();
        }
        const auto uu = ConstFaces<D>(faces_of(g, u, "velocity")), mm = ConstFaces<D>(faces_of(g, mass, "mass"));
        std::vector<double> farthest;
        {
          nb::gil_scoped_release release;
          const auto found = travel<D>(g, dt, uu, mm, least, pores, ways);
          farthest.assign(found.begin(), found.end());
        }
        return farthest;
      },
      "grid"_a, "dt"_a, "u"_a, "mass"_a, "least"_a, "porosity"_a.none(), "way"_a,
      "Way of the water on the faces, float32; returns the farthest along each axis where there is water [m].");
  m.def(
      "drift",
      [](G g, Field from, Field u, OptionalField porosity, Outline solids, Field gates, double dt, Field x,
         OptionalField paddles) {
        const index n = points_of<D>(from, "from");
        require_size(u.size(), n * D, "velocity");
        require_size(x.size(), n * D, "position");
        if (porosity) require_size(porosity->size(), n, "porosity");
        const auto obstacles = obstacles_of<D>(g, solids, gates, paddles);
        nb::gil_scoped_release release;
        drift<D>(g, n, from.data(), u.data(), pointer(porosity), obstacles, dt, x.data());
      },
      "grid"_a, "from_"_a, "u"_a, "porosity"_a.none(), "solids"_a.none(), "gates"_a, "dt"_a, "position"_a,
      "paddles"_a = nb::none(), "Moves the particles with their own pore velocities.");
  m.def(
      "eddy_viscosity",
      [](G g, FaceFields u, double molecular, double constant, Field nu) {
        require_cells(g, nu.size(), "nu");
        const auto uu = ConstFaces<D>(faces_of(g, u, "velocity"));
        nb::gil_scoped_release release;
        eddy_viscosity<D>(g, uu, molecular, constant, nu.data());
      },
      "grid"_a, "u"_a, "molecular"_a, "constant"_a, "nu"_a, "Smagorinsky viscosity of the cells [m2/s].");
  m.def(
      "viscous_acceleration",
      [](G g, FaceFields u, FaceFields mass, double least, double molecular, OptionalField nu, OptionalListed porosity,
         std::array<bool, 2 * D> no_slip, FaceFields out) {
        if (nu) require_cells(g, nu->size(), "nu");
        const Listed pores = listed_of(g, porosity, "porosity");
        const auto uu = ConstFaces<D>(faces_of(g, u, "velocity")), mm = ConstFaces<D>(faces_of(g, mass, "mass"));
        const auto oo = faces_of(g, out, "out");
        nb::gil_scoped_release release;
        viscous_acceleration<D>(g, uu, mm, least, molecular, pointer(nu), pores, no_slip.data(), oo);
      },
      "grid"_a, "u"_a, "mass"_a, "least"_a, "molecular"_a, "nu"_a.none(), "porosity"_a.none(), "no_slip"_a, "out"_a,
      "Viscous acceleration of the faces [m/s2].");
  m.def(
      "density_excess",
      [](G g, Mask active, Field depth, Field column, Field eta, Field fill, ListedField open, OptionalListed porosity,
         double omega, Field rhs) {
        require_cells(g, active.size(), "active");
        require_cells(g, fill.size(), "fill");
        const Listed o = listed_of(g, open, "open"), pores = listed_of(g, porosity, "porosity");
        require_cells(g, rhs.size(), "rhs");
        require_cells(g, depth.size(), "depth");
        require_columns(g, column.size(), "column");
        require_columns(g, eta.size(), "eta");
        nb::gil_scoped_release release;
        return density_excess<D>(g, active.data(), depth.data(), column.data(), eta.data(), fill.data(), o, pores,
                                 omega, rhs.data());
      },
      "grid"_a, "active"_a, "depth"_a, "column"_a, "eta"_a, "fill"_a, "open"_a, "porosity"_a.none(), "omega"_a, "rhs"_a,
      "Right-hand side of the position correction: the share of each cell's excess fill to be spread. Its largest "
      "size.");
  m.def(
      "displace",
      [](G g, FaceFields displacement, OptionalListed porosity, Outline solids, Field gates, double limit, Field x,
         OptionalField paddles) {
        const index n = points_of<D>(x, "position");
        const auto dd = ConstFaces<D>(faces_of(g, displacement, "displacement"));
        const auto obstacles = obstacles_of<D>(g, solids, gates, paddles);
        nb::gil_scoped_release release;
        displace<D>(g, n, dd, listed_of(g, porosity, "porosity"), obstacles, limit, x.data());
      },
      "grid"_a, "displacement"_a, "porosity"_a.none(), "solids"_a.none(), "gates"_a, "limit"_a, "position"_a,
      "paddles"_a = nb::none(), "Moves the particles along a displacement given on the faces.");
  m.def(
      "stop_at_solids",
      [](G g, std::vector<std::pair<Array<std::int64_t>, Field>> closed, FaceFields u) {
        if (closed.size() != D) throw std::invalid_argument("closed needs one entry per axis");
        ClosedFaces<D> faces;
        static_assert(sizeof(ClosedFace<D>) == (2 * D + 1) * sizeof(double));
        for (int a = 0; a < D; ++a) {
          faces.count[a] = static_cast<index>(closed[a].first.size());
          require_size(closed[a].second.size(), (2 * D + 1) * faces.count[a], "closed");
          faces.face[a] = closed[a].first.data();
          faces.at[a] = reinterpret_cast<const ClosedFace<D>*>(closed[a].second.data());
        }
        const auto uu = faces_of(g, u, "velocity");
        nb::gil_scoped_release release;
        stop_at_solids<D>(g, faces, uu);
      },
      "grid"_a, "closed"_a, "velocity"_a, "Velocity on closed faces such that none crosses the outline of the solids.");
  m.def(
      "face_kinetic_energy",
      [](G g, FaceFields mass, FaceNumbers number, Field table, FaceFields u) {
        const auto mm = ConstFaces<D>(faces_of(g, mass, "mass")), uu = ConstFaces<D>(faces_of(g, u, "velocity"));
        const auto numbers = optional_faces(g, number, "number");
        nb::gil_scoped_release release;
        return face_kinetic_energy<D>(g, mm, numbers, materials_of(table), uu);
      },
      "grid"_a, "mass"_a, "number"_a, "table"_a, "u"_a, "Kinetic energy of the faces per unit density.");
  m.def(
      "face_power",
      [](G g, FaceFields mass, FaceFields u, FaceFields acceleration) {
        const auto mm = ConstFaces<D>(faces_of(g, mass, "mass")), uu = ConstFaces<D>(faces_of(g, u, "velocity"));
        const auto ff = ConstFaces<D>(faces_of(g, acceleration, "acceleration"));
        nb::gil_scoped_release release;
        return face_power<D>(g, mm, uu, ff);
      },
      "grid"_a, "mass"_a, "u"_a, "acceleration"_a, "Power of the accelerations on the faces per unit density.");
  m.def(
      "leave_solids",
      [](G g, Outline solids, Field x) {
        const index n = points_of<D>(x, "position");
        const auto s = solids_of(g, solids);
        nb::gil_scoped_release release;
        if (s.edge) leave_solids<D>(g, n, s, x.data());
      },
      "grid"_a, "solids"_a.none(), "position"_a, "Takes particles that lie in solids to the nearest place outside.");
}

static void bind_sums(nb::module_& m) {
  m.def(
      "energy_factor",
      [](Field volume, Field bulk, Array<float> inertia, Field factor) {
        const index n = static_cast<index>(volume.size()), d = factor.ndim() == 2 ? factor.shape(1) : 0;
        require_size(bulk.size(), n, "bulk");
        require_size(factor.size(), n * d, "factor");
        require_size(inertia.size(), n * d, "inertia");
        if (d != 2 && d != 3) throw std::invalid_argument("factor must have shape (N, d)");
        nb::gil_scoped_release release;
        const auto energy = d == 2 ? energy_factor<2> : energy_factor<3>;
        energy(n, volume.data(), bulk.data(), inertia.data(), factor.data());
      },
      "volume"_a, "bulk"_a, "inertia"_a, "factor"_a, "s^2 = C_r/n^2 of the particles along each axis (N, d).");
  m.def(
      "kinetic_energy",
      [](Field bulk, std::optional<Array<float>> inertia, Field u) {
        const index n = static_cast<index>(bulk.size());
        if (u.ndim() != 2) throw std::invalid_argument("velocity must have shape (N, d)");
        require_size(u.shape(0), n, "velocity");
        if (inertia) require_size(inertia->size(), n * static_cast<index>(u.shape(1)), "inertia");
        const float* J = inertia ? inertia->data() : nullptr;
        nb::gil_scoped_release release;
        return u.shape(1) == 2 ? kinetic_energy<2>(n, bulk.data(), J, u.data())
                               : kinetic_energy<3>(n, bulk.data(), J, u.data());
      },
      "bulk"_a, "inertia"_a.none(), "u"_a, "Kinetic energy of the particles per unit density.");
  m.def(
      "all_finite",
      [](Field x) {
        nb::gil_scoped_release release;
        return all_finite(static_cast<index>(x.size()), x.data());
      },
      "x"_a, "Whether no number is infinite or NaN.");
  m.def(
      "max_speed",
      [](Field u, Field volume, Field bulk) {
        if (u.ndim() != 2) throw std::invalid_argument("velocity must have shape (N, d)");
        const index n = static_cast<index>(u.shape(0));
        require_size(volume.size(), n, "volume");
        require_size(bulk.size(), n, "bulk");
        const auto list = [](const auto& speed) { return std::vector<double>(speed.begin(), speed.end()); };
        nb::gil_scoped_release release;
        return u.shape(1) == 2 ? list(max_speed<2>(n, u.data(), volume.data(), bulk.data()))
                               : list(max_speed<3>(n, u.data(), volume.data(), bulk.data()));
      },
      "u"_a, "volume"_a, "bulk"_a, "Largest pore speed along each axis [m/s].");
  m.def(
      "total",
      [](Field value) {
        nb::gil_scoped_release release;
        return total(static_cast<index>(value.size()), value.data());
      },
      "value"_a, "Sum, in blocks: the same for any threads.");
  m.def(
      "weighted_sum",
      [](Field weight, Field value, index column) {
        const index n = static_cast<index>(weight.size());
        if (value.ndim() != 2 || column < 0 || column >= static_cast<index>(value.shape(1)))
          throw std::invalid_argument("value must have shape (N, d) with a column of that number");
        require_size(value.shape(0), n, "value");
        nb::gil_scoped_release release;
        return weighted_sum(n, weight.data(), value.data() + column, static_cast<index>(value.shape(1)));
      },
      "weight"_a, "value"_a, "column"_a, "Sum of weight times one column, in blocks: the same for any threads.");
}

void bind_flow(nb::module_& m) {
  m.attr("thinnest_sheet") = thinnest_sheet;
  bind_sums(m);
  bind<2>(m);
  bind<3>(m);
}

}  // namespace houle
