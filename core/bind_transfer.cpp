// Bindings of transfer.hpp: sorting, scatter, gather, by kernel name.
#include "bind.hpp"
#include "mass_matrix.hpp"

namespace houle {

// Calls f with the kernel of that name as a value.
template <class F>
static void with_kernel(const std::string& name, F f) {
  if (name == "linear") return f(LinearKernel{});
  if (name == "quadratic") return f(QuadraticKernel{});
  if (name == "m4prime") return f(M4PrimeKernel{});
  if (name == "gaussian") return f(GaussianKernel{});
  if (name == "gaussian-taylor2") return f(GaussianTaylorKernel{});
  if (name == "gaussian-cell") return f(GaussianCellKernel{});
  throw std::invalid_argument("unknown transfer kernel " + name);
}

template <int D>
static Cloud<D> cloud_of(const Grid<D>& g, const Field& x, const OptionalField& side, const Field& mass,
                         const Array<std::int32_t>& start) {
  const index n = points_of<D>(x, "position");
  require_size(mass.size(), n, "mass");
  require_size(start.size(), g.cells() + 1, "start");
  if (side) require_size(side->size(), n, "side");
  return {n, x.data(), pointer(side), mass.data(), start.data()};
}

template <int D>
static void bind(nb::module_& m) {
  using G = const Grid<D>&;
  m.def(
      "cell_sort",
      [](G g, Field x, Array<std::int32_t> cell, Array<std::int32_t> order, Array<std::int32_t> start) {
        const index n = points_of<D>(x, "position");
        require_size(cell.size(), n, "cell");
        require_size(order.size(), n, "order");
        require_size(start.size(), g.cells() + 1, "start");
        nb::gil_scoped_release release;
        cell_sort<D>(g, n, x.data(), cell.data(), order.data(), start.data());
      },
      "grid"_a, "position"_a, "cell"_a, "order"_a, "start"_a,
      "Stable order of the particles by cell: order (N,), start (cells + 1,); cell (N,) is work space.");
  m.def(
      "sort_particles",
      [](G g, Field x, Field u, Field volume, Field spare, Array<std::int32_t> order, Array<std::int32_t> start) {
        const index n = points_of<D>(x, "position");
        for (const Field* rows : {&u, &spare}) require_size(rows->size(), n * D, "particle array");
        require_size(volume.size(), n, "volume");
        require_size(order.size(), n, "order");
        require_size(start.size(), g.cells() + 1, "start");
        nb::gil_scoped_release release;
        sort_particles<D>(g, n, x.data(), u.data(), volume.data(), spare.data(), order.data(), start.data());
      },
      "grid"_a, "position"_a, "velocity"_a, "volume"_a, "spare"_a, "order"_a, "start"_a,
      "Particles in the order of their cells, which cell_sort finds; spare (N, d) is work space.");
  m.def(
      "scatter_cells",
      [](G g, Array<std::int32_t> start, Field x, Field amount, Field out, OptionalField paddles,
         OptionalField factor) {
        const index n = points_of<D>(x, "position");
        require_size(amount.size(), n, "amount");
        require_start(g, start, n);
        require_cells(g, out.size(), "out");
        if (factor) require_cells(g, factor->size(), "factor");
        nb::gil_scoped_release release;
        scatter_cells<D>(g, start.data(), x.data(), amount.data(), paddles_of(paddles), pointer(factor), out.data());
      },
      "grid"_a, "start"_a, "position"_a, "amount"_a, "out"_a, "paddles"_a = nb::none(), "factor"_a = nb::none(),
      "Tent-weighted sums of a particle amount at cell centres, times a factor of the cells.");
  m.def(
      "gather_cells",
      [](G g, Field x, Field field, Field out) {
        const index n = points_of<D>(x, "position");
        require_cells(g, field.size(), "field");
        require_size(out.size(), n, "out");
        nb::gil_scoped_release release;
        gather_cells<D>(g, n, x.data(), field.data(), out.data());
      },
      "grid"_a, "position"_a, "field"_a, "out"_a, "A cell field at the particles, linear.");
  m.def(
      "to_faces",
      [](G g, const std::string& kernel, Field x, OptionalField side, Field mass, Array<std::int32_t> start, Field u,
         OptionalField affine, std::vector<Field> velocity, std::vector<Field> face_mass) {
        const auto cloud = cloud_of<D>(g, x, side, mass, start);
        require_size(u.size(), cloud.n * D, "velocity");
        if (affine) require_size(affine->size(), cloud.n * D * D, "affine");
        const auto v = faces_of(g, velocity, "velocity"), fm = faces_of(g, face_mass, "face mass");
        nb::gil_scoped_release release;
        with_kernel(kernel, [&](auto k) { to_faces<decltype(k), D>(g, cloud, u.data(), pointer(affine), v, fm); });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "u"_a, "affine"_a.none(), "velocity"_a,
      "face_mass"_a, "Mass-weighted mean of the particle velocities on the faces, and the face masses.");
  m.def(
      "add_residual",
      [](G g, const std::string& kernel, Field x, OptionalField side, Field mass, Array<std::int32_t> start, Field u,
         std::vector<Field> face_mass, std::vector<Field> velocity, std::vector<Field> work) {
        const auto cloud = cloud_of<D>(g, x, side, mass, start);
        require_size(u.size(), cloud.n * D, "velocity");
        const auto fm = faces_of(g, face_mass, "face mass"), v = faces_of(g, velocity, "velocity"),
                   w = faces_of(g, work, "work");
        nb::gil_scoped_release release;
        with_kernel(kernel, [&](auto k) { add_residual<decltype(k), D>(g, cloud, u.data(), ConstFaces<D>(fm), v, w); });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "u"_a, "face_mass"_a, "velocity"_a,
      "work"_a, "One more term of the full-mass-matrix transfer FMPM(k).");
  m.def(
      "to_particles",
      [](G g, const std::string& kernel, Field x, OptionalField side, Field mass, Array<std::int32_t> start,
         std::vector<Field> now, std::vector<Field> change, std::vector<Field> drag, double flip, Field u) {
        const auto cloud = cloud_of<D>(g, x, side, mass, start);
        require_size(u.size(), cloud.n * D, "velocity");
        const auto v = faces_of(g, now, "velocity");
        Faces<D> dv, dr;
        if (flip > 0.0) {
          dv = faces_of(g, change, "change");
          dr = faces_of(g, drag, "drag");
        }
        nb::gil_scoped_release release;
        with_kernel(kernel, [&](auto k) {
          to_particles<decltype(k), D>(g, cloud, ConstFaces<D>(v), ConstFaces<D>(dv), ConstFaces<D>(dr), flip,
                                       u.data());
        });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "now"_a, "change"_a, "drag"_a, "flip"_a,
      "u"_a, "Particle velocities from the faces: PIC (flip = 0) or a FLIP blend.");
  m.def(
      "affine_from",
      [](G g, const std::string& kernel, Field x, OptionalField side, Field mass, Array<std::int32_t> start,
         std::vector<Field> velocity, Field affine) {
        const auto cloud = cloud_of<D>(g, x, side, mass, start);
        require_size(affine.size(), cloud.n * D * D, "affine");
        const auto v = faces_of(g, velocity, "velocity");
        nb::gil_scoped_release release;
        with_kernel(kernel, [&](auto k) { affine_from<decltype(k), D>(g, cloud, ConstFaces<D>(v), affine.data()); });
      },
      "grid"_a, "kernel"_a, "position"_a, "side"_a.none(), "mass"_a, "start"_a, "velocity"_a, "affine"_a,
      "APIC's velocity gradient at the particles.");
}

template <int D>
static void bind_mass_matrix(nb::module_& m, const char* name) {
  using Matrix = MassMatrix<D>;
  nb::class_<Matrix>(m, name, "The full mass matrix of the linear kernel, for the transfer FMPM(k).")
      .def(nb::init<const Grid<D>&>(), "grid"_a)
      .def(
          "transfer",
          [](Matrix& s, Field x, Field mass, Array<std::int32_t> start, Field u, int order, std::vector<Field> velocity,
             std::vector<Field> face_mass, std::vector<Field> work, Field lent) {
            const auto& g = s.grid();
            const auto cloud = cloud_of<D>(g, x, std::nullopt, mass, start);
            require_size(u.size(), cloud.n * D, "velocity");
            const auto v = faces_of(g, velocity, "velocity"), fm = faces_of(g, face_mass, "face mass"),
                       w = faces_of(g, work, "work");
            nb::gil_scoped_release release;
            s.transfer(cloud, u.data(), order, v, fm, w, {lent.data(), lent.size()});
          },
          "position"_a, "mass"_a, "start"_a, "u"_a, "order"_a, "velocity"_a, "face_mass"_a, "work"_a, "lent"_a,
          "Velocities and masses of the faces: to_faces with the linear kernel, then order - 1 times add_residual.");
}

void bind_transfer(nb::module_& m) {
  bind<2>(m);
  bind<3>(m);
  bind_mass_matrix<2>(m, "MassMatrix2");
  bind_mass_matrix<3>(m, "MassMatrix3");
}

}  // namespace houle
