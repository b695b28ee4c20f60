// The parts that the binding files share: functions that name the argument that does not fit, and checks of arrays and
// index tables. Only bindings see Python.
//
// Every call checks sizes and types, and the numbers of an index table wherever a wrong one would read or write
// elsewhere in memory. A large table that is built once is made read-only (houle.grid.fixed) and checked once.
#pragma once

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <stdexcept>

#include <houle/water/interfaces.hpp>

#include "array.hpp"

namespace houle {

using namespace nb::literals;

using Field = Array<double>;        // written
using Given = Array<const double>;  // read
using Numbers = Array<const std::int32_t>;
using LongNumbers = Array<const std::int64_t>;
using Fields = Arrays<double>;  // one per axis
using Givens = Arrays<const double>;
using OptionalGiven = std::optional<Given>;
using ListedField = std::pair<Numbers, Given>;  // number of each cell, values
using OptionalListed = std::optional<ListedField>;

// ---- functions ------------------------------------------------------------------------------------------------------

// Words for the argument that a C++ type asks for, as messages have them.
template <class A>
struct Wanted {
  static std::string words() {
    using T = std::remove_cvref_t<A>;
    if constexpr (std::is_same_v<T, Grid<2>>) return "a Grid2";
    if constexpr (std::is_same_v<T, Grid<3>>) return "a Grid2 or a Grid3";
    if constexpr (std::is_same_v<T, bool>) return "True or False";
    if constexpr (std::is_integral_v<T>) return "a whole number of " + std::to_string(8 * sizeof(T)) + " bits";
    if constexpr (std::is_floating_point_v<T>) return "a number";
    if constexpr (std::is_same_v<T, std::string>) return "a string";
    return "an instance of the class";
  }
};
template <class T>
struct Wanted<Array<T>> {
  static std::string words() { return std::string("an array of ") + number_name(number_of<T>()); }
};
template <class T>
struct Wanted<std::optional<T>> {
  static std::string words() { return Wanted<T>::words() + " or None"; }
};
template <class T>
struct Wanted<std::vector<T>> {
  static std::string words() { return "a list, each of it " + Wanted<T>::words(); }
};
template <class T>
struct Wanted<Arrays<T>> : Wanted<std::vector<Array<T>>> {};
template <class T, std::size_t n>
struct Wanted<std::array<T, n>> {
  static std::string words() { return std::to_string(n) + " values, each " + Wanted<T>::words(); }
};
template <class... T>
struct Wanted<std::tuple<T...>> {
  static std::string words() {
    std::string all;
    ((all += (all.empty() ? "" : ", ") + Wanted<T>::words()), ...);
    return "a tuple of " + all;
  }
};
template <class A, class B>
struct Wanted<std::pair<A, B>> : Wanted<std::tuple<A, B>> {};

// An argument's type, for the message about a call that fits no function.
struct Kind {
  bool (*fits)(nb::handle value);
  std::string (*words)();
  bool optional;
};

template <class T>
bool fits_type(nb::handle value) {
  nb::detail::make_caster<T> caster;
  return caster.from_python(value, static_cast<std::uint32_t>(nb::detail::cast_flags::convert), nullptr);
}

template <class A, class T = std::remove_cvref_t<A>>
constexpr Kind kind_of{&fits_type<T>, &Wanted<T>::words, nb::detail::has_arg_defaults_v<T>};

// Defines a second function of that name, which takes what the first did not and says which of its arguments does not
// fit. names: of the arguments, among null pointers. of_2d: only where the first argument is a Grid2.
void explain_misfits(nb::module_& m, const char* name, const Kind* kinds, std::initializer_list<const char*> names,
                     bool of_2d);

template <class Extra>
constexpr const char* name_of(const Extra& extra) {
  if constexpr (requires { extra.name_; })
    return extra.name_;
  else
    return nullptr;
}

// Defines a function of a module, or a method: the messages of what it refuses begin with its name, and an argument of
// a wrong type is named.
template <class Scope, class F, class R, class First, class... A, class... Extra>
inline void define(Scope& scope, const char* name, F f, R (F::*)(First, A...) const, const Extra&... extra) {
  scope.def(
      name,
      [f, name](First first, A... rest) -> R {
        const Call call(name);
        return f(first, rest...);
      },
      extra...);
  if constexpr (std::is_same_v<Scope, nb::module_>) {  // for a method nanobind itself lists all arguments
    static constexpr Kind kinds[] = {kind_of<First>, kind_of<A>...};
    explain_misfits(scope, name, kinds, {name_of(extra)...}, std::is_same_v<std::remove_cvref_t<First>, Grid<2>>);
  }
}

template <class Scope, class F, class... Extra>
inline void define(Scope& scope, const char* name, F f, const Extra&... extra) {
  define(scope, name, f, &F::operator(), extra...);
}

// ---- arrays ---------------------------------------------------------------------------------------------------------

[[noreturn]] void wrong_size(const Extent& v, const std::string& name, const std::string& wanted);

// The numbers of an array of n entries; of one of that shape, or that lists as many in one row. of: what it holds.
void* entries_of(const Extent& v, index n, const char* name);
void* shaped(const Extent& v, const index* shape, int d, index n, const char* of, const char* name);
// True if the array has that shape, or lists as many entries in one row.
bool has_shape(const Extent& v, const index* shape, int d, index size);

template <class T>
inline T* entries(const Array<T>& array, index n, const char* name) {
  return static_cast<T*>(entries_of(array.view(name), n, name));
}

template <class T>
inline T* entries(const std::optional<Array<T>>& array, index n, const char* name) {
  return array ? entries(*array, n, name) : nullptr;
}

template <int D, class T>
inline T* cells(const Grid<D>& g, const Array<T>& array, const char* name) {
  return static_cast<T*>(shaped(array.view(name), g.shape.data(), D, g.cells(), "cells", name));
}

template <int D, class T>
inline T* cells(const Grid<D>& g, const std::optional<Array<T>>& array, const char* name) {
  return array ? cells(g, *array, name) : nullptr;
}

template <int D, class T>
inline T* columns(const Grid<D>& g, const Array<T>& array, const char* name) {
  const index n = g.cells() / g.shape[D - 1];
  return static_cast<T*>(shaped(array.view(name), g.shape.data(), D - 1, n, "columns", name));
}

// One array per axis. none: there may be no arrays at all, which then are null.
void faces_of(const index* cells, int d, const Handles& arrays, Number number, bool writable, const char* name,
              bool none, void** data);

template <int D, class T>
inline std::array<T*, D> of_faces(const Grid<D>& g, const Arrays<T>& arrays, const char* name, bool none = false) {
  void* found[D] = {};
  faces_of(g.shape.data(), D, arrays, number_of<T>(), !std::is_const_v<T>, name, none, found);
  std::array<T*, D> data;
  for (int a = 0; a < D; ++a) data[a] = static_cast<T*>(found[a]);
  return data;
}

template <int D, class T>
inline Faces<D, T> faces(const Grid<D>& g, const Arrays<T>& arrays, const char* name, bool none = false) {
  Faces<D, T> f;
  f.data = of_faces(g, arrays, name, none);
  return f;
}

template <int D, class T>
inline ConstFaces<D, T> faces(const Grid<D>& g, const Arrays<const T>& arrays, const char* name, bool none = false) {
  ConstFaces<D, T> f;
  f.data = of_faces(g, arrays, name, none);
  return f;
}

// Points (N, D); no more than can be numbered with 32 bits.
template <int D, class T>
struct Points {
  T* data;
  index n;
};

void require_points(const Extent& v, int d, const char* name);

template <int D, class T>
inline Points<D, T> points(const Array<T>& x, const char* name) {
  const auto v = x.view(name);
  require_points(v, D, name);
  return {v.data, static_cast<index>(v.shape[0])};
}

void require_rows(const Extent& v, Py_ssize_t width, const char* name);

// A table of rows of `width` numbers each, as an array of structs.
template <class Row>
inline Points<2, const Row> rows(const Given& table, const char* name) {
  const auto v = table.view(name);
  require_rows(v, sizeof(Row) / sizeof(double), name);
  return {reinterpret_cast<const Row*>(v.data), static_cast<index>(v.shape[0])};
}

Paddles paddles_of(const OptionalGiven& table);
// The gates of a table with x and lower edge of each [m], which must stand in a tank of that length.
Gates gates_in(double length, const Given& table);

template <int D>
inline Gates gates_of(const Grid<D>& g, const Given& table) {
  return gates_in(g.h[0] * static_cast<double>(g.shape[0]), table);
}

template <int D>
inline Gates gates_of(const Grid<D>& g, const OptionalGiven& table) {
  return table ? gates_of(g, *table) : Gates{};
}

template <class A, class B>
inline void apart(const A* a, index n, const char* name, const B* b, index m, const char* other) {
  const auto from = reinterpret_cast<std::uintptr_t>(a), begin = reinterpret_cast<std::uintptr_t>(b);
  if (from < begin + m * sizeof(B) && begin < from + n * sizeof(A))
    refuse(std::string(name) + " and " + other + " share memory");
}

// ---- index tables ---------------------------------------------------------------------------------------------------

// Kinds of index tables, by their numbers: each in [0, limit); the same, or -1 for none; from 0 to limit, none below
// the one before (where lists begin), or each above it (where lists begin that are not empty).
enum class Table { numbers, some, starts, groups };

// True if this very table was found to be right before. Only tables that nobody can write to are remembered.
bool known_table(const nb::handle& owner, const void* data, Table kind, index limit);
void note_table(const nb::handle& owner, const void* data, Table kind, index limit);

template <class T>
void require_table(const View<T>& v, const char* name, Table kind, index limit);
extern template void require_table(const View<const std::int32_t>&, const char*, Table, index);
extern template void require_table(const View<const std::int64_t>&, const char*, Table, index);

// An index table of n numbers, each that of a row of a table of `limit` rows.
template <class T>
inline const T* numbers(const Array<const T>& array, index n, index limit, const char* name) {
  const auto v = array.view(name);
  if (v.size != n) wrong_size(v, name, std::to_string(n));
  require_table(v, name, Table::numbers, limit);
  return v.data;
}

template <int D>
inline Listed listed_of(const Grid<D>& g, const ListedField& field, const char* name) {
  const auto number = field.first.view(name), shaped = number;
  if (!has_shape(shaped, g.shape.data(), D, g.cells()))
    wrong_size(shaped, name,
               "the " + std::to_string(g.cells()) + " cells of the grid, " + shape_text(g.shape.data(), D));
  const auto value = field.second.view(name);
  require_table(number, name, Table::numbers, value.size);
  return {number.data, value.data};
}

template <int D>
inline Listed listed_of(const Grid<D>& g, const OptionalListed& field, const char* name) {
  return field ? listed_of(g, *field, name) : Listed{};
}

// The interfaces as Python passes them: number of each cell, the same for the linear kernel, list (K, D + 3), medium of
// the faces (houle.medium.interfaces.Interfaces).
using OptionalInterfaces = std::optional<std::tuple<Numbers, Numbers, Given, Arrays<const std::int8_t>>>;

template <int D>
inline Interfaces<D> interfaces_of(const Grid<D>& g, const OptionalInterfaces& interfaces) {
  static_assert(sizeof(Interface<D>) == (D + 3) * sizeof(double));
  if (!interfaces) return {};
  const auto& [number, close, list, medium] = *interfaces;
  const auto all = rows<Interface<D>>(list, "interfaces: list");
  const auto table = [&](const Numbers& rows, const char* name) {
    const auto v = rows.view(name);
    if (!has_shape(v, g.shape.data(), D, g.cells()))
      wrong_size(v, name, "the " + std::to_string(g.cells()) + " cells of the grid");
    require_table(v, name, Table::some, all.n);
    return v.data;
  };
  Interfaces<D> found{table(number, "interfaces: number"),   table(close, "interfaces: close"), all.data, {}, g.h[0],
                      faces(g, medium, "interfaces: medium")};
  for (int a = 0; a < D; ++a)
    found.slices[a] = static_cast<double>(g.face_shape(a)[0]) / static_cast<double>(g.faces(a));
  return found;
}

// The first particle of each cell, as cell_sort leaves it, for loops over slabs of columns: they read it at the ends of
// columns only.
template <int D>
inline const std::int32_t* slabs_of(const Grid<D>& g, const Numbers& start, index particles) {
  const std::int32_t* s = entries(start, g.cells() + 1, "start");
  const index plane = g.cells() / g.shape[0];
  bool wrong = s[0] != 0 || s[g.cells()] != particles;
  for (index i = 1; i <= g.shape[0]; ++i) wrong |= s[i * plane] < s[(i - 1) * plane];
  if (wrong)
    refuse("start does not fit the particles: it must grow from 0 to " + std::to_string(particles) + " and never fall");
  return s;
}

// The first particle of each cell for loops over the cells, which read all of it.
template <int D>
inline const std::int32_t* cell_start_of(const Grid<D>& g, const Numbers& cell_start, index particles) {
  entries(cell_start, g.cells() + 1, "cell_start");
  const auto v = cell_start.view("cell_start");
  require_table(v, "cell_start", Table::starts, particles);
  return v.data;
}

// Calls f with the dimension of an (N, d) array.
template <class T, class F>
inline auto with_dimension(const View<T>& v, const char* name, F f) {
  if (v.dimensions != 2 || (v.shape[1] != 2 && v.shape[1] != 3))
    refuse(std::string(name) + " must have shape (N, 2) or (N, 3), not " + v.shape_text());
  const auto n = static_cast<index>(v.shape[0]);
  return v.shape[1] == 2 ? f(std::integral_constant<int, 2>{}, n) : f(std::integral_constant<int, 3>{}, n);
}

// each .cpp file here fills the module for D = 2 and D = 3 (overloads told apart by Grid2 / Grid3)
void bind_poisson(nb::module_& m);
void bind_transfer(nb::module_& m);
void bind_flow(nb::module_& m);
void bind_crossing(nb::module_& m);
void bind_remesh(nb::module_& m);
void bind_sph(nb::module_& m);

}  // namespace houle
