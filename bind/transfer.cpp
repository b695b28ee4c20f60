// Bindings of transfer.hpp: sorting, scatter, gather, by kernel name.
#include <houle/compiled/lists.hpp>
#include <houle/water/mass_matrix.hpp>

#include "places.hpp"

namespace houle {

// Calls f with the kernel of that name as a value, and the particles as it takes them.
template <int D, class F>
static void with_kernel(const std::string& name, Cloud<D> cloud, F f) {
  if (name == "linear") return f(LinearKernel{}, cloud);
  if (name == "quadratic") return f(QuadraticKernel{}, cloud);
  if (name == "m4prime") return f(M4PrimeKernel{}, cloud);
  if (name == "gaussian") cloud.side = nullptr;
  cloud.exact = name == "gaussian-cell";
  if (name == "gaussian" || name == "gaussian-taylor2" || cloud.exact) return f(GaussianKernel{}, cloud);
  refuse("unknown transfer kernel " + name);
}

// The particles of a transfer to the faces, which runs over slabs of columns.
template <int D>
static Cloud<D> sorted_cloud(const Grid<D>& g, const Given& x, const OptionalGiven& side, const Given& mass,
                             const Numbers& start, const OptionalInterfaces& media = {}) {
  const auto at = points<D>(x, "position");
  return {at.n,
          at.data,
          entries(side, at.n, "side"),
          entries(mass, at.n, "mass"),
          slabs_of(g, start, at.n),
          interfaces_of(g, media)};
}

// The particles, or points, of a transfer from the faces: it goes through them one by one, in any order.
template <int D>
static Cloud<D> cloud_of(const Grid<D>& g, const Given& x, const OptionalGiven& side, const Given& mass,
                         const Numbers& start, const OptionalInterfaces& media) {
  const auto at = points<D>(x, "position");
  return {at.n,
          at.data,
          entries(side, at.n, "side"),
          entries(mass, at.n, "mass"),
          entries(start, g.cells() + 1, "start"),
          interfaces_of(g, media)};
}

template <int D>
static void bind_cells(nb::module_& m) {
  using G = const Grid<D>&;
  using Order = Array<std::int32_t>;
  define(
      m, "cell_sort",
      [](G g, Given x, Order cell, Order order, Order start) {
        const auto at = points<D>(x, "position");
        std::int32_t *c = entries(cell, at.n, "cell"), *o = entries(order, at.n, "order"),
                     *s = entries(start, g.cells() + 1, "start");
        apart(c, at.n, "cell", o, at.n, "order");
        apart(c, at.n, "cell", s, g.cells() + 1, "start");
        apart(o, at.n, "order", s, g.cells() + 1, "start");
        index outside;
        {
          nb::gil_scoped_release release;
          outside = cell_sort<D>(g, at.n, at.data, c, o, s);
        }
        require_inside<D>(outside, at.data);
      },
      "grid"_a, "position"_a, "cell"_a, "order"_a, "start"_a,
      "Stable order of the particles by cell: order (N,), start (cells + 1,); cell (N,) is work space.");
  define(
      m, "sort_particles",
      [](G g, Field x, Field u, Field volume, Field spare, Order order, Order start) {
        const auto at = points<D>(x, "position");
        const index n = at.n;
        double *uu = entries(u, n * D, "velocity"), *v = entries(volume, n, "volume"),
               *rest = entries(spare, n * D, "spare");
        std::int32_t *o = entries(order, n, "order"), *s = entries(start, g.cells() + 1, "start");
        apart(rest, n * D, "spare", o, n, "order");
        apart(rest, n * D, "spare", s, g.cells() + 1, "start");
        apart(o, n, "order", s, g.cells() + 1, "start");
        for (const auto& [rows, size, name] :
             {std::tuple(at.data, n * D, "position"), std::tuple(uu, n * D, "velocity"), std::tuple(v, n, "volume")}) {
          apart(rows, size, name, rest, n * D, "spare");
          apart(rows, size, name, o, n, "order");
          apart(rows, size, name, s, g.cells() + 1, "start");
        }
        index outside;
        {
          nb::gil_scoped_release release;
          outside = sort_particles<D>(g, n, at.data, uu, v, rest, o, s);
        }
        require_inside<D>(outside, at.data);
      },
      "grid"_a, "position"_a, "velocity"_a, "volume"_a, "spare"_a, "order"_a, "start"_a,
      "Puts the particles into the order of their cells, in place: order and start as in cell_sort; spare (N, d) is"
      " work space.");
  define(
      m, "scatter_cells",
      [](G g, Numbers start, Given x, Given amount, Field out, OptionalGiven paddles, OptionalGiven factor,
         OptionalGiven gates) {
        const auto at = points<D>(x, "position");
        const double* v = entries(amount, at.n, "amount");
        const std::int32_t* s = slabs_of(g, start, at.n);
        double* sums = cells(g, out, "out");
        const double* times = cells(g, factor, "factor");
        const Paddles walls = paddles_of(paddles);
        const Gates shut = gates_of(g, gates);
        nb::gil_scoped_release release;
        scatter_cells<D>(g, s, at.data, v, walls, shut, times, sums);
      },
      "grid"_a, "start"_a, "position"_a, "amount"_a, "out"_a, "paddles"_a = nb::none(), "factor"_a = nb::none(),
      "gates"_a = nb::none(), "Tent-weighted sums of a particle amount at cell centres, times a factor of the cells.");
  define(
      m, "gather_cells",
      [](G g, Given x, Given field, Field out) {
        const auto at = points<D>(x, "position");
        const double* f = cells(g, field, "field");
        double* values = entries(out, at.n, "out");
        nb::gil_scoped_release release;
        gather_cells<D>(g, at.n, at.data, f, values);
      },
      "grid"_a, "position"_a, "field"_a, "out"_a, "Interpolates a cell field to the particles, linearly: out (N,).");
}

template <int D>
static void bind_faces(nb::module_& m) {
  using G = const Grid<D>&;
  using Name = const std::string&;
  define(
      m, "to_faces",
      [](G g, Name kernel, Given x, OptionalGiven side, Given mass, Numbers start, Given u, OptionalGiven affine,
         Fields velocity, Fields face_mass, OptionalInterfaces media) {
        const auto particles = sorted_cloud<D>(g, x, side, mass, start, media);
        const double *uu = entries(u, particles.n * D, "u"), *C = entries(affine, particles.n * D * D, "affine");
        const auto v = faces(g, velocity, "velocity"), fm = faces(g, face_mass, "face_mass");
        with_kernel(kernel, particles, [&](auto k, const Cloud<D>& cloud) {
          nb::gil_scoped_release release;
          to_faces<decltype(k), D>(g, cloud, uu, C, v, fm);
        });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "u"_a, "affine"_a.none(), "velocity"_a,
      "face_mass"_a, "interfaces"_a = nb::none(),
      "Mass-weighted mean of the particle velocities on the faces, and the face masses.");
  define(
      m, "add_residual",
      [](G g, Name kernel, Given x, OptionalGiven side, Given mass, Numbers start, Given u, Givens face_mass,
         Fields velocity, Fields work, OptionalInterfaces media) {
        const auto particles = sorted_cloud<D>(g, x, side, mass, start, media);
        const double* uu = entries(u, particles.n * D, "u");
        const auto fm = faces(g, face_mass, "face_mass");
        const auto v = faces(g, velocity, "velocity"), w = faces(g, work, "work");
        with_kernel(kernel, particles, [&](auto k, const Cloud<D>& cloud) {
          nb::gil_scoped_release release;
          add_residual<decltype(k), D>(g, cloud, uu, fm, v, w);
        });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "u"_a, "face_mass"_a, "velocity"_a,
      "work"_a, "interfaces"_a = nb::none(),
      "Adds one more term of the full-mass-matrix transfer FMPM(k) to the velocity of the faces.");
  define(
      m, "to_particles",
      [](G g, Name kernel, Given x, OptionalGiven side, Given mass, Numbers start, Givens now, Givens change,
         Givens drag, double flip, Field u, OptionalInterfaces media) {
        const auto particles = cloud_of<D>(g, x, side, mass, start, media);
        double* uu = entries(u, particles.n * D, "u");
        const auto v = faces(g, now, "now"), dv = faces(g, change, "change", !(flip > 0.0)),
                   dr = faces(g, drag, "drag", !(flip > 0.0));
        with_kernel(kernel, particles, [&](auto k, const Cloud<D>& cloud) {
          nb::gil_scoped_release release;
          to_particles<decltype(k), D>(g, cloud, v, dv, dr, flip, uu);
        });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "now"_a, "change"_a, "drag"_a, "flip"_a,
      "u"_a, "interfaces"_a = nb::none(), "Particle velocities from the faces: PIC (flip = 0) or a FLIP blend.");
  define(
      m, "affine_from",
      [](G g, Name kernel, Given x, OptionalGiven side, Given mass, Numbers start, Givens velocity, Field affine,
         OptionalInterfaces media) {
        const auto particles = cloud_of<D>(g, x, side, mass, start, media);
        double* C = entries(affine, particles.n * D * D, "affine");
        const auto v = faces(g, velocity, "velocity");
        with_kernel(kernel, particles, [&](auto k, const Cloud<D>& cloud) {
          nb::gil_scoped_release release;
          affine_from<decltype(k), D>(g, cloud, v, C);
        });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "velocity"_a, "affine"_a,
      "interfaces"_a = nb::none(), "APIC's velocity gradient at the particles.");
}

template <int D>
static void bind_mass_matrix(nb::module_& m, const char* name) {
  using Matrix = MassMatrix<D>;
  nb::class_<Matrix> matrix(m, name, "The full mass matrix of the linear kernel, for the transfer FMPM(k).");
  matrix.def(nb::init<const Grid<D>&>(), "grid"_a);
  define(
      matrix, "transfer",
      [](Matrix& s, Given x, Given mass, Numbers start, Given u, int order, Fields velocity, Fields face_mass,
         Fields work, Field lent, OptionalInterfaces interfaces, std::optional<Arrays<const std::uint8_t>> where,
         int more) {
        const auto& g = s.grid();
        const auto cloud = sorted_cloud<D>(g, x, std::nullopt, mass, start, interfaces);
        const double* uu = entries(u, cloud.n * D, "u");
        if (order < 1 || order > 1000) refuse("order is " + std::to_string(order) + ": 1 to 1000");
        if (more < 0 || more > 4000) refuse("more is " + std::to_string(more) + ": 0 to 4000");
        const auto v = faces(g, velocity, "velocity"), fm = faces(g, face_mass, "face_mass"),
                   w = faces(g, work, "work");
        const auto space = lent.view("lent");
        apart(space.data, space.size, "lent", cloud.start, g.cells() + 1, "start");
        ConstFaces<D, std::uint8_t> marked{};
        if (where) marked = faces(g, *where, "where");
        nb::gil_scoped_release release;
        s.transfer(cloud, uu, order, v, fm, w, {space.data, static_cast<std::size_t>(space.size)}, marked, more);
      },
      "position"_a, "mass"_a, "start"_a, "u"_a, "order"_a, "velocity"_a, "face_mass"_a, "work"_a, "lent"_a,
      "interfaces"_a = nb::none(), "where"_a = nb::none(), "more"_a = 0,
      "Velocities and masses of the faces: to_faces with the linear kernel, then order - 1 times add_residual, and on "
      "the faces where `where` is not 0 as often again as `more` says.");
}

void bind_transfer(nb::module_& m) {
  bind_cells<2>(m);
  bind_cells<3>(m);
  bind_faces<2>(m);
  bind_faces<3>(m);
  bind_mass_matrix<2>(m, "MassMatrix2");
  bind_mass_matrix<3>(m, "MassMatrix3");
}

}  // namespace houle
