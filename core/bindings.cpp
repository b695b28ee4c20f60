// The Python module houle._core: the grid, threads, and the functions of the bind_*.cpp files.
#include "bind.hpp"

namespace houle {

template <int D>
static void bind_grid(nb::module_& m, const char* name) {
  nb::class_<Grid<D>>(m, name)
      .def(
          "__init__",
          [](Grid<D>* g, std::array<index, D> shape, std::array<double, D> spacing, std::array<bool, D> periodic) {
            for (int a = 0; a < D; ++a)
              if (shape[a] < 1 || !(spacing[a] > 0)) throw std::invalid_argument("grid needs cells of positive size");
            new (g) Grid<D>{shape, spacing, periodic};
          },
          "shape"_a, "spacing"_a, "periodic"_a)
      .def_ro("shape", &Grid<D>::shape)
      .def_ro("spacing", &Grid<D>::h)
      .def_ro("periodic", &Grid<D>::periodic);
}

}  // namespace houle

NB_MODULE(_core, m) {
  using namespace houle;
  m.doc() = "houle's numerical kernels: free functions over NumPy arrays, in 2 and 3 dimensions";
  bind_grid<2>(m, "Grid2");
  bind_grid<3>(m, "Grid3");
  m.def("set_threads", &set_threads, "threads"_a);
  m.def("get_threads", &get_threads);
  bind_poisson(m);
  bind_transfer(m);
  bind_flow(m);
  bind_remesh(m);
  bind_sph(m);
}
