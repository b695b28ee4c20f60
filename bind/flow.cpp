// Bindings of surface, forces, projection, extrapolation, moving particles and sums.
#include <houle/compiled/lists.hpp>
#include <houle/pressure/projection.hpp>
#include <houle/water/advect.hpp>
#include <houle/water/energy.hpp>
#include <houle/water/friction.hpp>
#include <houle/water/held.hpp>
#include <houle/water/viscous.hpp>

#include "medium.hpp"
#include "solids.hpp"

namespace houle {

template <int D>
static Resistance<D> resistance_of(const Grid<D>& g, const FaceNumbers& number, const OptionalGiven& table,
                                   const Givens& rate, const OptionalListed& energy, const GivenMasks& held) {
  const auto materials = table ? materials_of(*table) : Points<2, const Material>{};
  Resistance<D> r;
  r.number = table ? numbers_of(g, number, materials.n, true) : faces(g, number, "number", true);
  r.table = materials.data;
  r.rate = faces(g, rate, "rate", true);
  r.energy = listed_of(g, energy, "energy");
  r.held = faces(g, held, "held", true);
  return r;
}

template <int D>
static Obstacles<D> obstacles_of(const Grid<D>& g, const Outline& solids, const Given& gates,
                                 const OptionalGiven& paddles) {
  return {solids_of(g, solids), gates_of(g, gates), paddles_of(paddles)};
}

// The closed faces of each axis, houle.medium.solids.ClosedFaces.
using Closed = std::vector<std::pair<LongNumbers, Given>>;

template <int D>
static ClosedFaces<D> closed_of(const Grid<D>& g, const Closed& closed) {
  static_assert(sizeof(ClosedFace<D>) == (2 * D + 1) * sizeof(double));
  if (closed.size() != D) refuse("closed needs one entry per axis");
  ClosedFaces<D> faces;
  for (int a = 0; a < D; ++a) {
    const auto at = rows<ClosedFace<D>>(closed[a].second, "closed");
    faces.count[a] = at.n;
    faces.face[a] = numbers(closed[a].first, at.n, g.faces(a), "closed: face");
    faces.at[a] = at.data;
  }
  return faces;
}

// The walls that rub: cells, first plane of each, cells in front of the planes, planes; houle.medium.rough_walls.
using GivenWalls = std::tuple<LongNumbers, LongNumbers, LongNumbers, Given>;

template <int D>
static RoughWalls<D> walls_of(const Grid<D>& g, const GivenWalls& walls) {
  static_assert(sizeof(WallPlane<D>) == (D + 2) * sizeof(double));
  const auto& [cell, first, front, plane] = walls;
  const auto planes = rows<WallPlane<D>>(plane, "walls: plane");
  const auto listed = cell.view("walls: cell"), begins = first.view("walls: first");
  require_table(listed, "walls: cell", Table::numbers, g.cells());
  for (index k = 1; k < listed.size; ++k)
    if (listed.data[k] <= listed.data[k - 1]) refuse("walls: cell must rise: two rows share the particles of a cell");
  if (begins.size != listed.size + 1) wrong_size(begins, "walls: first", std::to_string(listed.size + 1));
  require_table(begins, "walls: first", Table::starts, planes.n);
  return {listed.size, listed.data, begins.data, numbers(front, planes.n, g.cells(), "walls: front"), planes.data};
}

template <int D>
static void bind_surface(nb::module_& m) {
  using G = const Grid<D>&;
  define(
      m, "column_heights",
      [](G g, Numbers start, Given x, Given volume, Field height, OptionalGiven paddles, OptionalGiven gates) {
        const auto at = points<D>(x, "position");
        const double* v = entries(volume, at.n, "volume");
        const std::int32_t* s = slabs_of(g, start, at.n);
        double* h = columns(g, height, "height");
        const Paddles walls = paddles_of(paddles);
        const Gates shut = gates_of(g, gates);
        nb::gil_scoped_release release;
        column_heights<D>(g, s, at.data, v, walls, shut, h);
      },
      "grid"_a, "start"_a, "position"_a, "volume"_a, "height"_a, "paddles"_a = nb::none(), "gates"_a = nb::none(),
      "Height of the water in each column of cells [m].");
  define(
      m, "column_levels",
      [](G g, Given height, Given porosity, Given fill, Given inverse_capacity, LongNumbers column, LongNumbers start,
         Given pieces, Field level) {
        static_assert(sizeof(CapacityPiece) == 5 * sizeof(double));
        const double *h = columns(g, height, "height"), *n = columns(g, porosity, "porosity"),
                     *F = cells(g, fill, "fill"), *inverse = cells(g, inverse_capacity, "inverse_capacity");
        const auto listed = column.view("column");
        require_table(listed, "column", Table::numbers, g.cells() / g.shape[D - 1]);
        const auto piece = rows<CapacityPiece>(pieces, "pieces");
        entries(start, listed.size + 1, "start");
        const auto first = start.view("start");
        require_table(first, "start", Table::groups, piece.n);
        double* l = columns(g, level, "level");
        nb::gil_scoped_release release;
        column_levels<D>(g, h, n, F, inverse, listed.size, listed.data, first.data, piece.data, l);
      },
      "grid"_a, "height"_a, "porosity"_a, "fill"_a, "inverse_capacity"_a, "column"_a, "start"_a, "pieces"_a, "level"_a,
      "Level to which its water fills the pores of each column [m].");
  define(
      m, "find_surface",
      [](G g, Given fill, ListedField open, Given level, Field depth, Mask active, Field column, Field eta,
         OptionalGiven gates) {
        const double *F = cells(g, fill, "fill"), *l = columns(g, level, "level");
        const Listed o = listed_of(g, open, "open");
        double *d = cells(g, depth, "depth"), *c = columns(g, column, "column"), *e = columns(g, eta, "eta");
        std::uint8_t* wet = cells(g, active, "active");
        const Gates shut = gates_of(g, gates);
        nb::gil_scoped_release release;
        find_surface<D>(g, F, o, l, shut, d, wet, c, e);
      },
      "grid"_a, "fill"_a, "open"_a, "level"_a, "depth"_a, "active"_a, "column"_a, "eta"_a, "gates"_a = nb::none(),
      "Depth of the cell centres below the free surface [cells], active cells, level of the surface per column [m].");
  define(
      m, "water_above",
      [](G g, Given fill, index row) {
        const double* F = cells(g, fill, "fill");
        nb::gil_scoped_release release;
        return water_above<D>(g, F, row);
      },
      "grid"_a, "fill"_a, "row"_a, "True if there is water in this row of cells, counted upwards, or above.");
  define(
      m, "water_held",
      [](G g, GivenMask active, ListedField open, Given fill, Given inverse_capacity, Given height, LongNumbers column,
         Field held) {
        const std::uint8_t* wet = cells(g, active, "active");
        const Listed o = listed_of(g, open, "open");
        const double *F = cells(g, fill, "fill"), *inverse = cells(g, inverse_capacity, "inverse_capacity"),
                     *h = columns(g, height, "height");
        const auto listed = column.view("column");
        require_table(listed, "column", Table::numbers, g.cells() / g.shape[D - 1]);
        double* out = entries(held, listed.size, "held");
        nb::gil_scoped_release release;
        water_held<D>(g, wet, o, F, inverse, h, listed.size, listed.data, out);
      },
      "grid"_a, "active"_a, "open"_a, "fill"_a, "inverse_capacity"_a, "height"_a, "column"_a, "held"_a,
      "Water in the listed columns of cells [m^d]; cells under the surface count as full.");
  define(
      m, "density_excess",
      [](G g, GivenMask active, Given depth, Given column, Given eta, Given fill, ListedField open,
         OptionalListed porosity, double omega, Field rhs) {
        const std::uint8_t* wet = cells(g, active, "active");
        const double *d = cells(g, depth, "depth"), *c = columns(g, column, "column"), *e = columns(g, eta, "eta"),
                     *F = cells(g, fill, "fill");
        const Listed o = listed_of(g, open, "open"), pores = listed_of(g, porosity, "porosity");
        double* out = cells(g, rhs, "rhs");
        nb::gil_scoped_release release;
        return density_excess<D>(g, wet, d, c, e, F, o, pores, omega, out);
      },
      "grid"_a, "active"_a, "depth"_a, "column"_a, "eta"_a, "fill"_a, "open"_a, "porosity"_a.none(), "omega"_a, "rhs"_a,
      "Right-hand side of the position correction: the share of each cell's excess fill to be spread. Its largest "
      "size.");
}

template <int D>
static void bind_forces(nb::module_& m) {
  using G = const Grid<D>&;
  define(
      m, "apply_forces",
      [](G g, Givens u, FaceNumbers number, OptionalGiven table, Givens rate, OptionalListed energy, GivenMasks held,
         std::array<double, D> gravity, Givens extra, double dt, Fields star, Fields drag, Fields mobility) {
        const auto r = resistance_of<D>(g, number, table, rate, energy, held);
        const auto uu = faces(g, u, "u"), ex = faces(g, extra, "extra", true);
        const auto s = faces(g, star, "star"), d = faces(g, drag, "drag", true),
                   b = faces(g, mobility, "mobility", !table);
        nb::gil_scoped_release release;
        apply_forces<D>(g, uu, r, gravity.data(), ex, dt, s, d, b);
      },
      "grid"_a, "u"_a, "number"_a, "table"_a.none(), "rate"_a, "energy"_a.none(), "held"_a, "gravity"_a, "extra"_a,
      "dt"_a, "star"_a, "drag"_a, "mobility"_a,
      "Body forces, implicit porous resistance and Bernoulli term over one step.");
  define(
      m, "drag_work",
      [](G g, FaceNumbers number, OptionalGiven table, Givens rate, Givens mass, Givens mobility, Givens before,
         Givens after) {
        if (!table) refuse("table must have shape (K, 3)");
        const auto r = resistance_of<D>(g, number, table, rate, std::nullopt, {});
        const auto mm = faces(g, mass, "mass"), mo = faces(g, mobility, "mobility"), b = faces(g, before, "before"),
                   e = faces(g, after, "after");
        nb::gil_scoped_release release;
        return drag_work<D>(g, r, mm, mo, b, e);
      },
      "grid"_a, "number"_a, "table"_a, "rate"_a, "mass"_a, "mobility"_a, "before"_a, "after"_a,
      "Energy that the drag took in a step, per unit density.");
  define(
      m, "eddy_viscosity",
      [](G g, Givens u, double molecular, double constant, Field nu) {
        const auto uu = faces(g, u, "u");
        double* out = cells(g, nu, "nu");
        nb::gil_scoped_release release;
        eddy_viscosity<D>(g, uu, molecular, constant, out);
      },
      "grid"_a, "u"_a, "molecular"_a, "constant"_a, "nu"_a, "Smagorinsky viscosity of the cells [m2/s].");
  define(
      m, "viscous_acceleration",
      [](G g, Givens u, Givens mass, double least, double molecular, OptionalGiven nu, OptionalListed porosity,
         Fields out) {
        const double* eddies = cells(g, nu, "nu");
        const Listed pores = listed_of(g, porosity, "porosity");
        const auto uu = faces(g, u, "u"), mm = faces(g, mass, "mass");
        const auto oo = faces(g, out, "out");
        nb::gil_scoped_release release;
        viscous_acceleration<D>(g, uu, mm, least, molecular, eddies, pores, oo);
      },
      "grid"_a, "u"_a, "mass"_a, "least"_a, "molecular"_a, "nu"_a.none(), "porosity"_a.none(), "out"_a,
      "Viscous acceleration of the faces [m/s2].");
  define(
      m, "rub",
      [](G g, GivenWalls walls, Numbers start, Given x, Given volume, Given bulk,
         std::optional<Array<const float>> inertia, Given fill, double nu, double dt, Field u, Field impulse) {
        const RoughWalls<D> rough = walls_of(g, walls);
        const auto at = points<D>(x, "position");
        const Rubbed<D> water{cell_start_of(g, start, at.n),         at.data,
                              entries(volume, at.n, "volume"),       entries(bulk, at.n, "bulk"),
                              entries(inertia, at.n * D, "inertia"), cells(g, fill, "fill")};
        double *speed = entries(u, at.n * D, "velocity"),
               *got = entries(impulse, D * std::get<2>(walls).view("walls: front").size, "impulse");
        nb::gil_scoped_release release;
        return rub<D>(g, rough, water, nu, dt, speed, got);
      },
      "grid"_a, "walls"_a, "start"_a, "position"_a, "volume"_a, "bulk"_a, "inertia"_a.none(), "fill"_a, "nu"_a, "dt"_a,
      "velocity"_a, "impulse"_a,
      "Slows particles down along the walls near them, by the law of the wall. Returns the energy taken per unit "
      "density.");
  define(
      m, "face_kinetic_energy",
      [](G g, Givens mass, FaceNumbers number, Given table, Givens u) {
        const auto mm = faces(g, mass, "mass"), uu = faces(g, u, "u");
        const auto materials = materials_of(table);
        const auto of = numbers_of(g, number, materials.n, true);
        nb::gil_scoped_release release;
        return face_kinetic_energy<D>(g, mm, of, materials.data, uu);
      },
      "grid"_a, "mass"_a, "number"_a, "table"_a, "u"_a, "Kinetic energy of the faces per unit density.");
  define(
      m, "face_power",
      [](G g, Givens mass, Givens u, Givens acceleration) {
        const auto mm = faces(g, mass, "mass"), uu = faces(g, u, "u"), ff = faces(g, acceleration, "acceleration");
        nb::gil_scoped_release release;
        return face_power<D>(g, mm, uu, ff);
      },
      "grid"_a, "mass"_a, "u"_a, "acceleration"_a, "Power of the accelerations on the faces per unit density.");
}

template <int D>
static void bind_projection(nb::module_& m) {
  using G = const Grid<D>&;
  using Singles = Arrays<const float>;
  define(
      m, "pressure_system",
      [](G g, GivenMask active, Given depth, Singles open, Givens mobility, double step, Givens star, double least,
         Fields k, Field e, Field rhs) {
        const std::uint8_t* wet = cells(g, active, "active");
        const double* d = cells(g, depth, "depth");
        const auto o = faces(g, open, "open");
        const auto mo = faces(g, mobility, "mobility", true), st = faces(g, star, "star", true);
        const auto kk = faces(g, k, "k");
        double *air = cells(g, e, "e"), *source = cells(g, rhs, "rhs");
        nb::gil_scoped_release release;
        pressure_system<D>(g, wet, d, o, mo, step, st, least, kk, air, source);
      },
      "grid"_a, "active"_a, "depth"_a, "open"_a, "mobility"_a, "step"_a, "star"_a, "least"_a, "k"_a, "e"_a, "rhs"_a,
      "Coefficients and right-hand side of the pressure system at the sub-cell surface.");
  define(
      m, "project",
      [](G g, GivenMask active, Given depth, Singles open, Givens mobility, double step, Given p, double least,
         Fields u, Arrays<std::uint8_t> valid, bool still) {
        const std::uint8_t* wet = cells(g, active, "active");
        const double *d = cells(g, depth, "depth"), *pressure = cells(g, p, "pressure");
        const auto o = faces(g, open, "open");
        const auto mo = faces(g, mobility, "mobility", true);
        const auto uu = faces(g, u, "u");
        const auto known = of_faces(g, valid, "valid");
        nb::gil_scoped_release release;
        project<D>(g, wet, d, o, mo, step, pressure, least, uu, known, still);
      },
      "grid"_a, "active"_a, "depth"_a, "open"_a, "mobility"_a, "step"_a, "pressure"_a, "least"_a, "u"_a, "valid"_a,
      "still"_a = false,
      "Takes the pressure gradient off the velocity u of the faces of the water, in place; still: u counts as 0 "
      "before.");
  define(
      m, "extrapolate",
      [](G g, int layers, int near, Givens mass, double keep_mass, Fields u, Arrays<std::uint8_t> known) {
        if (layers < 0 || layers > 250) refuse("layers is " + std::to_string(layers) + ": 0 to 250");
        const auto mm = faces(g, mass, "mass", true);
        const auto uu = faces(g, u, "u");
        const auto k = of_faces(g, known, "known");
        nb::gil_scoped_release release;
        extrapolate<D>(g, layers, near, mm, keep_mass, uu, k);
      },
      "grid"_a, "layers"_a, "near"_a, "mass"_a, "keep_mass"_a, "u"_a, "known"_a,
      "Carries known face velocities outwards by averaging, layer by layer.");
  define(
      m, "continue_upwards",
      [](G g, int layers, GivenMask active, Given column, Fields u) {
        const std::uint8_t* wet = cells(g, active, "active");
        const double* c = columns(g, column, "column");
        const auto uu = faces(g, u, "u");
        nb::gil_scoped_release release;
        continue_upwards<D>(g, layers, wet, c, uu);
      },
      "grid"_a, "layers"_a, "active"_a, "column"_a, "u"_a,
      "Divergence-free vertical velocity above the surface of single-valued columns.");
  define(
      m, "stop_at_solids",
      [](G g, Closed closed, Fields velocity) {
        const ClosedFaces<D> at = closed_of(g, closed);
        const auto uu = faces(g, velocity, "velocity");
        nb::gil_scoped_release release;
        stop_at_solids<D>(g, at, uu);
      },
      "grid"_a, "closed"_a, "velocity"_a,
      "Changes the velocity of the closed faces, in place, so that no water crosses the outline of the solids.");
}

template <int D>
static void bind_motion(nb::module_& m) {
  using G = const Grid<D>&;
  define(
      m, "move",
      [](G g, Givens u, OptionalListed porosity, OptionalGiven own, OptionalGiven volume, OptionalGiven bulk,
         Outline solids, Given gates, double dt, Field x, OptionalGiven paddles, OptionalInterfaces interfaces) {
        const auto at = points<D>(x, "position");
        const auto media = interfaces_of(g, interfaces);
        const Listed pores = listed_of(g, porosity, "porosity");
        const double *mine = entries(own, at.n * D, "own"), *v = entries(volume, at.n, "volume"),
                     *b = entries(bulk, at.n, "bulk");
        if (own && porosity && !(volume && bulk)) refuse("own needs volume and bulk");
        const auto uu = faces(g, u, "u");
        const auto obstacles = obstacles_of<D>(g, solids, gates, paddles);
        nb::gil_scoped_release release;
        move<D>(g, at.n, uu, pores, mine, v, b, media, obstacles, dt, at.data);
      },
      "grid"_a, "u"_a, "porosity"_a.none(), "own"_a.none(), "volume"_a.none(), "bulk"_a.none(), "solids"_a.none(),
      "gates"_a, "dt"_a, "position"_a, "paddles"_a = nb::none(), "interfaces"_a = nb::none(),
      "Moves the particles with the pore velocity, midpoint rule.");
  define(
      m, "travel",
      [](G g, double dt, Givens u, Givens mass, double least, OptionalListed porosity, Arrays<float> way) {
        const Listed pores = listed_of(g, porosity, "porosity");
        const auto ways = of_faces(g, way, "way");
        const auto uu = faces(g, u, "u"), mm = faces(g, mass, "mass");
        std::array<double, D> farthest;
        {
          nb::gil_scoped_release release;
          farthest = travel<D>(g, dt, uu, mm, least, pores, ways);
        }
        return std::vector<double>(farthest.begin(), farthest.end());
      },
      "grid"_a, "dt"_a, "u"_a, "mass"_a, "least"_a, "porosity"_a.none(), "way"_a,
      "Adds dt u to the way of the water on the faces (float32) [m]; returns the farthest along each axis where "
      "there is water.");
  define(
      m, "drift",
      [](G g, Given from, Given u, OptionalGiven porosity, Outline solids, Given gates, double dt, Field x,
         OptionalGiven paddles) {
        const auto start = points<D>(from, "from_");
        const double *own = entries(u, start.n * D, "u"), *pores = entries(porosity, start.n, "porosity");
        double* to = entries(x, start.n * D, "position");
        const auto obstacles = obstacles_of<D>(g, solids, gates, paddles);
        nb::gil_scoped_release release;
        drift<D>(g, start.n, start.data, own, pores, obstacles, dt, to);
      },
      "grid"_a, "from_"_a, "u"_a, "porosity"_a.none(), "solids"_a.none(), "gates"_a, "dt"_a, "position"_a,
      "paddles"_a = nb::none(), "Moves the particles with their own pore velocities.");
  define(
      m, "displace",
      [](G g, Givens displacement, OptionalListed porosity, Outline solids, Given gates, double limit, Field x,
         OptionalGiven paddles) {
        const auto at = points<D>(x, "position");
        const auto dd = faces(g, displacement, "displacement");
        const Listed pores = listed_of(g, porosity, "porosity");
        const auto obstacles = obstacles_of<D>(g, solids, gates, paddles);
        nb::gil_scoped_release release;
        displace<D>(g, at.n, dd, pores, obstacles, limit, at.data);
      },
      "grid"_a, "displacement"_a, "porosity"_a.none(), "solids"_a.none(), "gates"_a, "limit"_a, "position"_a,
      "paddles"_a = nb::none(), "Moves the particles along a displacement given on the faces.");
  define(
      m, "leave_solids",
      [](G g, Outline solids, Field x) {
        const auto at = points<D>(x, "position");
        const auto s = solids_of(g, solids);
        nb::gil_scoped_release release;
        if (s.edge) all_leave_solids<D>(g, at.n, s, at.data);
      },
      "grid"_a, "solids"_a.none(), "position"_a, "Takes particles that lie in solids to the nearest place outside.");
}

static void bind_sums(nb::module_& m) {
  define(
      m, "kinetic_energy",
      [](Given bulk, std::optional<Array<const float>> inertia, Given u) {
        const auto v = u.view("u");
        return with_dimension(v, "u", [&](auto d, index n) {
          const double* b = entries(bulk, n, "bulk");
          const float* J = entries(inertia, n * d, "inertia");
          nb::gil_scoped_release release;
          return kinetic_energy<d>(n, b, J, v.data);
        });
      },
      "bulk"_a, "inertia"_a.none(), "u"_a, "Kinetic energy of the particles per unit density.");
  define(
      m, "all_finite",
      [](Given x) {
        const auto v = x.view("x");
        nb::gil_scoped_release release;
        return all_finite(v.size, v.data);
      },
      "x"_a, "True if no number is infinite or NaN.");
  define(
      m, "max_speed",
      [](Given u, Given volume, Given bulk) {
        const auto v = u.view("u");
        return with_dimension(v, "u", [&](auto d, index n) {
          const double *V = entries(volume, n, "volume"), *b = entries(bulk, n, "bulk");
          nb::gil_scoped_release release;
          const auto speed = max_speed<d>(n, v.data, V, b);
          return std::vector<double>(speed.begin(), speed.end());
        });
      },
      "u"_a, "volume"_a, "bulk"_a, "Largest pore speed along each axis [m/s].");
  define(
      m, "total",
      [](Given value) {
        const auto v = value.view("value");
        nb::gil_scoped_release release;
        return total(v.size, v.data);
      },
      "value"_a, "Sum of all numbers, in blocks: the same bits for any number of threads.");
  define(
      m, "weighted_sum",
      [](Given weight, Given value, index column) {
        const auto v = value.view("value");
        if (v.dimensions != 2 || column < 0 || column >= static_cast<index>(v.shape[1]))
          refuse("value must have shape (N, d) with a column number " + std::to_string(column) + ", not " +
                 v.shape_text());
        const auto n = static_cast<index>(v.shape[0]), stride = static_cast<index>(v.shape[1]);
        const double* w = entries(weight, n, "weight");
        nb::gil_scoped_release release;
        return weighted_sum(n, w, v.data + column, stride);
      },
      "weight"_a, "value"_a, "column"_a,
      "Sum of weight times one column of value, in blocks: the same bits for any number of threads.");
}

template <int D>
static void bind_step(nb::module_& m) {
  bind_surface<D>(m);
  bind_forces<D>(m);
  bind_projection<D>(m);
  bind_motion<D>(m);
}

void bind_flow(nb::module_& m) {
  define(
      m, "wall_shear", [](double v, double y, double nu, double roughness) { return wall_shear(v, y, nu, roughness); },
      "speed"_a, "distance"_a, "nu"_a, "roughness"_a,
      "Shear stress of a wall per unit density, by the law of the wall [m2/s2].");
  bind_sums(m);
  bind_step<2>(m);
  bind_step<3>(m);
}

}  // namespace houle
