// The contents of houle._core: the grid, threads, and the functions of the other files here.
#include <string>

#include <houle/compiled/lists.hpp>
#include <houle/exec/build.hpp>

#include "arguments.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace houle {

// The tables that were found to be right, the last of them. Each is known by a weak reference, as another object may
// come to lie where one was.
struct KnownTable {
  nb::object owner;
  const void* data;
  Table kind;
  index limit;
};

static std::array<KnownTable, 64>& known_tables() {
  static auto* all = new std::array<KnownTable, 64>();  // never destroyed: Python is gone by then
  return *all;
}

bool known_table(const nb::handle& owner, const void* data, Table kind, index limit) {
  for (const KnownTable& t : known_tables())
    if (t.data == data && t.limit == limit && t.kind == kind && t.owner &&
        PyWeakref_GetObject(t.owner.ptr()) == owner.ptr())
      return true;
  return false;
}

void note_table(const nb::handle& owner, const void* data, Table kind, index limit) {
  static std::size_t next = 0;
  if (!nb::hasattr(owner, "base") || !owner.attr("base").is_none()) return;  // a view: its base may be written to
  PyObject* reference = PyWeakref_NewRef(owner.ptr(), nullptr);
  if (!reference) return PyErr_Clear();
  known_tables()[next++ % known_tables().size()] = {nb::steal(reference), data, kind, limit};
}

// Cells are numbered with 32 bits, and counted before memory is asked for.
template <int D>
static void require_grid(const std::array<index, D>& shape, const std::array<double, D>& spacing) {
  constexpr index most = std::numeric_limits<std::int32_t>::max() - 1;
  const std::string text = shape_text(shape.data(), D);
  index cells = 1;
  for (int a = 0; a < D; ++a) {
    if (shape[a] < 1) throw nb::value_error(("shape must have cells along every axis, not " + text).c_str());
    if (!(spacing[a] > 0 && spacing[a] <= std::numeric_limits<double>::max()))
      throw nb::value_error("spacing must be positive and finite");
    if (shape[a] > most / cells)
      throw nb::value_error(("shape " + text + " makes more than 2^31 - 2 cells: they cannot be numbered").c_str());
    cells *= shape[a];
  }
}

template <int D>
static void bind_grid(nb::module_& m, const char* name) {
  nb::class_<Grid<D>>(m, name)
      .def(
          "__init__",
          [](Grid<D>* g, std::array<index, D> shape, std::array<double, D> spacing, std::array<bool, D> periodic) {
            require_grid<D>(shape, spacing);
            new (g) Grid<D>{shape, spacing, periodic};
          },
          "shape"_a, "spacing"_a, "periodic"_a)
      .def_ro("shape", &Grid<D>::shape)
      .def_ro("spacing", &Grid<D>::h)
      .def_ro("periodic", &Grid<D>::periodic);
}

// Large arrays in pages of their own, which go back to the system as soon as they are freed. By itself the C library
// puts the later ones of a run on its heap, where they leave holes: up to 24 bytes per particle. The heap of the small
// ones is kept: to hand it back and get it again took 2 % of the time of a small flow.
static void keep_arrays_off_the_heap() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 32 << 20);
#endif
}

// Hands memory that was freed back to the system, where the C library keeps it otherwise.
static void return_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

// Compiler and flags of the core, and threads in use, for the manifest of a run.
static nb::dict build_info() {
  const Build build = build_of_core();
  nb::dict info;
  info["compiler"] = build.compiler;
  info["flags"] = build.flags;
  info["variant"] = build.variant;
  info["threads"] = get_threads();
  return info;
}

void bind_all(nb::module_& m) {
  nb::set_leak_warnings(false);  // a process that ends gives nothing back, see houle.cli
  m.doc() = "houle's numerical kernels: free functions over NumPy arrays, in 2 and 3 dimensions";
  keep_arrays_off_the_heap();
  bind_grid<2>(m, "Grid2");
  bind_grid<3>(m, "Grid3");
  m.def("set_threads", &set_threads, "threads"_a);
  m.def("get_threads", &get_threads);
  m.def("return_memory", &return_memory, "Hands freed memory back to the operating system.");
  m.def("build_info", &build_info, "Compiler, its flags, variant of the core, threads in use.");
  bind_poisson(m);
  bind_transfer(m);
  bind_flow(m);
  bind_crossing(m);
  bind_remesh(m);
  bind_sph(m);
}

}  // namespace houle
