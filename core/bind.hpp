// What the binding files share: array types and shape checks. Only bindings see Python.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <string>

#include "grid.hpp"

namespace houle {

namespace nb = nanobind;
using namespace nb::literals;

template <class T>
using Array = nb::ndarray<T, nb::c_contig, nb::device::cpu>;  // any shape; checked by the helpers below
using Field = Array<double>;
using OptionalField = std::optional<Field>;

using ListedField = std::pair<Array<std::int32_t>, Field>;  // number of each cell, values
using OptionalListed = std::optional<ListedField>;

inline const double* pointer(const OptionalField& a) { return a ? a->data() : nullptr; }

inline Paddles paddles_of(const OptionalField& rows) {
  static_assert(sizeof(Paddle) == 2 * sizeof(double));
  if (!rows) return {};
  return {reinterpret_cast<const Paddle*>(rows->data()), static_cast<int>(rows->size() / 2)};
}

template <int D>
inline void require_cells(const Grid<D>& g, std::size_t size, const char* name) {
  if (static_cast<index>(size) != g.cells())
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(size) + " entries, the grid " +
                                std::to_string(g.cells()) + " cells");
}

template <int D>
inline Listed listed_of(const Grid<D>& g, const OptionalListed& field, const char* name) {
  if (!field) return {};
  require_cells(g, field->first.size(), name);
  return {field->first.data(), field->second.data()};
}

template <int D, class Real>
inline Faces<D, Real> faces_of(const Grid<D>& g, std::vector<Array<Real>>& arrays, const char* name) {
  if (arrays.size() != D) throw std::invalid_argument(std::string(name) + " needs one array per axis");
  Faces<D, Real> f;
  for (int a = 0; a < D; ++a) {
    if (static_cast<index>(arrays[a].size()) != g.faces(a))
      throw std::invalid_argument(std::string(name) + " does not fit the faces of axis " + std::to_string(a));
    f.data[a] = arrays[a].data();
  }
  return f;
}

template <int D>
inline index points_of(const Array<double>& x, const char* name) {  // (N, D) -> N
  if (x.ndim() != 2 || x.shape(1) != D)
    throw std::invalid_argument(std::string(name) + " must have shape (N, " + std::to_string(D) + ")");
  return static_cast<index>(x.shape(0));
}

inline void require_size(std::size_t size, index n, const char* name) {
  if (static_cast<index>(size) != n)
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(size) + " entries, expected " +
                                std::to_string(n));
}

template <int D>
inline void require_columns(const Grid<D>& g, std::size_t size, const char* name) {
  require_size(size, g.cells() / g.shape[D - 1], name);
}

// Where the particles of each cell begin, as cell_sort leaves it.
template <int D>
inline void require_start(const Grid<D>& g, const Array<std::int32_t>& start, index particles) {
  require_size(start.size(), g.cells() + 1, "start");
  if (start.data()[g.cells()] != particles) throw std::invalid_argument("start does not fit the particles");
}

// each bind_*.cpp fills the module for D = 2 and D = 3 (overloads told apart by Grid2 / Grid3)
void bind_poisson(nb::module_& m);
void bind_transfer(nb::module_& m);
void bind_flow(nb::module_& m);
void bind_remesh(nb::module_& m);
void bind_sph(nb::module_& m);

}  // namespace houle
