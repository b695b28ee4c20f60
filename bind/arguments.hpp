// What the binding files share: functions that name the argument that does not fit, and checks of arrays and index
// tables. Only bindings see Python.
//
// Every call checks sizes and types, and the numbers of an index table wherever a wrong one would read or write
// elsewhere in memory. A large table that is built once is made read-only (houle.grid.fixed) and checked once.
#pragma once

#include <nanobind/ndarray.h>
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
using Fields = std::vector<Field>;  // one per axis
using Givens = std::vector<Given>;
using OptionalGiven = std::optional<Given>;
using ListedField = std::pair<Numbers, Given>;  // number of each cell, values
using OptionalListed = std::optional<ListedField>;

// ---- functions ------------------------------------------------------------------------------------------------------

[[noreturn]] inline void refuse(const std::string& text) { throw Unfit{text}; }

[[noreturn]] inline void raise(const std::string& function, const Unfit& unfit) {
  const std::string text = function + "(): " + unfit.text;
  if (unfit.of_type) throw nb::type_error(text.c_str());
  throw nb::value_error(text.c_str());
}

// What an argument of that C++ type must be, in words.
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
  static std::string words() { return std::string("an array of ") + number_name<T>(); }
};
template <class T>
struct Wanted<std::optional<T>> {
  static std::string words() { return Wanted<T>::words() + " or None"; }
};
template <class T>
struct Wanted<std::vector<T>> {
  static std::string words() { return "a list, each of it " + Wanted<T>::words(); }
};
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

// The first argument of a call that no function took, in the second of nanobind's two passes over the overloads: the
// first one converts no numbers, and must be over. First: what it must be, void: anything.
template <class First>
struct Untaken {
  nb::handle first;
};

// Says which argument of a call does not fit the function of that name with arguments A.
template <class... A>
struct Diagnosis {
  std::string function;
  std::vector<std::string> names;

  [[noreturn]] void operator()(nb::handle first, const nb::args& more, const nb::kwargs& named) const {
    const std::size_t given = 1 + more.size();
    if (given + named.size() > names.size())
      raise(function, {"takes at most " + std::to_string(names.size()) + " arguments, not " +
                           std::to_string(given + named.size()),
                       true});
    for (auto [key, value] : named)
      if (std::find(names.begin(), names.end(), nb::cast<std::string>(key)) == names.end())
        raise(function, {"has no argument " + nb::cast<std::string>(key), true});
    std::size_t k = 0;
    (check<A>(k++, first, more, named), ...);
    raise(function, {"the arguments do not fit", true});
  }

 private:
  template <class Argument>
  void check(std::size_t k, nb::handle first, const nb::args& more, const nb::kwargs& named) const {
    using T = std::remove_cvref_t<Argument>;
    constexpr bool optional = nb::detail::has_arg_defaults_v<T>;
    nb::handle value = k == 0 ? first : nb::handle();
    if (k > 0 && k <= more.size()) value = more[k - 1].ptr();
    nb::object by_name;
    if (!value && named.contains(names[k].c_str())) value = by_name = named[names[k].c_str()];
    if (!value) return;  // left out: it has a default, or nanobind says so
    nb::detail::make_caster<T> caster;
    const bool none = value.is_none() && !optional;
    if (!none && caster.from_python(value, static_cast<std::uint32_t>(nb::detail::cast_flags::convert), nullptr))
      return;
    PyErr_Clear();
    raise(function, {names[k] + " must be " + Wanted<T>::words() + ", not " + described(value), true});
  }
};

template <class Argument>
inline void add_name(std::vector<std::string>& names, const Argument& extra) {
  if constexpr (requires { extra.name_; }) names.emplace_back(extra.name_);
}

// Defines a function of a module, or a method: the messages of what it refuses begin with its name, and an argument of
// a wrong type is named.
template <class Scope, class F, class R, class First, class... A, class... Extra>
inline void define(Scope& scope, const char* name, F f, R (F::*)(First, A...) const, const Extra&... extra) {
  scope.def(
      name,
      [f, name](First first, A... rest) -> R {
        try {
          return f(std::forward<First>(first), std::forward<A>(rest)...);
        } catch (const Unfit& unfit) {
          raise(name, unfit);
        }
      },
      extra...);
  if constexpr (std::is_same_v<Scope, nb::module_>) {  // of a method's arguments nanobind lists all
    std::vector<std::string> names;
    (add_name(names, extra), ...);
    const Diagnosis<First, A...> diagnosis{name, names};
    using Kind = std::remove_cvref_t<First>;
    scope.def(name,
              [diagnosis](Untaken<Kind> of, nb::args more, nb::kwargs named) { diagnosis(of.first, more, named); });
  }
}

template <class Scope, class F, class... Extra>
inline void define(Scope& scope, const char* name, F f, const Extra&... extra) {
  define(scope, name, f, &F::operator(), extra...);
}

// ---- arrays ---------------------------------------------------------------------------------------------------------

template <class T>
[[noreturn]] inline void wrong_size(const View<T>& v, const std::string& name, const std::string& wanted) {
  refuse(name + " has " + std::to_string(v.size) + " entries, shape " + v.shape_text() + ", wanted " + wanted);
}

inline std::string shape_text(const index* shape, int d) {
  std::string text = "(";
  for (int a = 0; a < d; ++a) text += (a ? ", " : "") + std::to_string(shape[a]);
  return text + (d == 1 ? ",)" : ")");
}

// Whether the array has that shape, or lists as many entries in one row.
template <class T>
inline bool has_shape(const View<T>& v, const index* shape, int d, index size) {
  if (v.size != size) return false;
  if (v.dimensions == 1) return true;
  bool same = v.dimensions == d;
  for (int a = 0; same && a < d; ++a) same = v.shape[a] == shape[a];
  return same;
}

template <class T>
inline T* entries(const Array<T>& array, index n, const char* name) {
  const auto v = array.view(name);
  if (v.size != n) wrong_size(v, name, std::to_string(n));
  return v.data;
}

template <class T>
inline T* entries(const std::optional<Array<T>>& array, index n, const char* name) {
  return array ? entries(*array, n, name) : nullptr;
}

template <int D, class T>
inline T* cells(const Grid<D>& g, const Array<T>& array, const char* name) {
  const auto v = array.view(name);
  if (!has_shape(v, g.shape.data(), D, g.cells()))
    wrong_size(v, name, "the " + std::to_string(g.cells()) + " cells of the grid, " + shape_text(g.shape.data(), D));
  return v.data;
}

template <int D, class T>
inline T* cells(const Grid<D>& g, const std::optional<Array<T>>& array, const char* name) {
  return array ? cells(g, *array, name) : nullptr;
}

template <int D, class T>
inline T* columns(const Grid<D>& g, const Array<T>& array, const char* name) {
  const auto v = array.view(name);
  const index n = g.cells() / g.shape[D - 1];
  if (!has_shape(v, g.shape.data(), D - 1, n))
    wrong_size(v, name, "the " + std::to_string(n) + " columns of the grid, " + shape_text(g.shape.data(), D - 1));
  return v.data;
}

// One array per axis. none: there may be no arrays at all, which then are null.
template <int D, class T>
inline std::array<T*, D> of_faces(const Grid<D>& g, const std::vector<Array<T>>& arrays, const char* name,
                                  bool none = false) {
  std::array<T*, D> data{};
  if (none && arrays.empty()) return data;
  if (arrays.size() != D)
    refuse(std::string(name) + " needs one array per axis, " + std::to_string(D) + ", not " +
           std::to_string(arrays.size()));
  for (int a = 0; a < D; ++a) {
    const auto v = arrays[a].view(name);
    const auto shape = g.face_shape(a);
    if (!has_shape(v, shape.data(), D, g.faces(a)))
      refuse(std::string(name) + " does not fit the faces of axis " + std::to_string(a) + ": shape " + v.shape_text() +
             ", wanted " + shape_text(shape.data(), D));
    data[a] = v.data;
  }
  return data;
}

template <int D, class T>
inline Faces<D, T> faces(const Grid<D>& g, const std::vector<Array<T>>& arrays, const char* name, bool none = false) {
  Faces<D, T> f;
  f.data = of_faces(g, arrays, name, none);
  return f;
}

template <int D, class T>
inline ConstFaces<D, T> faces(const Grid<D>& g, const std::vector<Array<const T>>& arrays, const char* name,
                              bool none = false) {
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

template <int D, class T>
inline Points<D, T> points(const Array<T>& x, const char* name) {
  const auto v = x.view(name);
  if (v.dimensions != 2 || v.shape[1] != D)
    refuse(std::string(name) + " must have shape (N, " + std::to_string(D) + "), not " + v.shape_text());
  if (v.shape[0] > std::numeric_limits<std::int32_t>::max())
    refuse(std::string(name) + " has " + std::to_string(v.shape[0]) + " points: at most 2^31 - 1 can be numbered");
  return {v.data, static_cast<index>(v.shape[0])};
}

// A table of rows of `width` numbers each, as an array of structs.
template <class Row>
inline Points<2, const Row> rows(const Given& table, const char* name) {
  constexpr Py_ssize_t width = sizeof(Row) / sizeof(double);
  const auto v = table.view(name);
  if (v.dimensions != 2 || v.shape[1] != width)
    refuse(std::string(name) + " must have shape (K, " + std::to_string(width) + "), not " + v.shape_text());
  return {reinterpret_cast<const Row*>(v.data), static_cast<index>(v.shape[0])};
}

inline Paddles paddles_of(const OptionalGiven& table) {
  static_assert(sizeof(Paddle) == 2 * sizeof(double));
  if (!table) return {};
  const auto all = rows<Paddle>(*table, "paddles");
  return {all.data, static_cast<int>(all.n)};
}

// x and lower edge of each, in the tank.
template <int D>
inline Gates gates_of(const Grid<D>& g, const Given& table) {
  static_assert(sizeof(Gate) == 2 * sizeof(double));
  const auto all = rows<Gate>(table, "gates");
  for (index k = 0; k < all.n; ++k)
    if (!(all.data[k].x >= 0.0 && all.data[k].x <= g.h[0] * static_cast<double>(g.shape[0]) && all.data[k].bottom >= 0))
      refuse("gates: one stands outside the tank, or its lower edge is below the floor");
  return {all.data, static_cast<int>(all.n)};
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

// What the numbers of a table must be: each in [0, limit); the same, or -1 for none; from 0 to limit, none below the
// one before (where lists begin), or each above it (where lists begin that are not empty).
enum class Table { numbers, some, starts, groups };

// Whether this very table was found to be right before: true only for one that nobody can write to.
bool known_table(const nb::handle& owner, const void* data, Table kind, index limit);
void note_table(const nb::handle& owner, const void* data, Table kind, index limit);

template <class T>
inline void require_table(const View<T>& v, const char* name, Table kind, index limit) {
  if (v.read_only && known_table(v.owner, v.data, kind, limit)) return;
  bool wrong = false;
  if (kind == Table::numbers || kind == Table::some) {
    const std::remove_const_t<T> none = kind == Table::some ? -1 : 0;
    std::remove_const_t<T> least = v.size > 0 ? v.data[0] : 0, most = least;
    for (index i = 1; i < v.size; ++i) least = std::min(least, v.data[i]), most = std::max(most, v.data[i]);
    wrong = v.size > 0 && (least < none || most >= limit);
    if (wrong)
      refuse(std::string(name) + " has numbers outside " + std::to_string(none) + " to " + std::to_string(limit - 1));
  } else {
    wrong = v.size < 1 || v.data[0] != 0 || v.data[v.size - 1] != limit;
    const std::int64_t least = kind == Table::groups ? 1 : 0;
    for (index i = 1; i < v.size; ++i) wrong |= v.data[i] < v.data[i - 1] + least;
    if (wrong)
      refuse(std::string(name) + " does not fit: it must grow from 0 to " + std::to_string(limit) +
             (least ? " by one at least" : " and never fall"));
  }
  if (v.read_only) note_table(v.owner, v.data, kind, limit);
}

// Numbers of rows of a table of `limit` rows.
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

// number of each cell, and for the linear kernel, list (K, D + 3), medium of the faces:
// houle.medium.interfaces.Interfaces
using OptionalInterfaces = std::optional<std::tuple<Numbers, Numbers, Given, std::vector<Array<const std::int8_t>>>>;

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

// Where the particles of each cell begin, as cell_sort leaves it, for loops over slabs of columns: they read it at the
// ends of columns only.
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

// The same for loops over the cells.
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

namespace nanobind::detail {

template <class First>
struct has_arg_defaults<houle::Untaken<First>> : std::true_type {};  // None, too

template <class First>
struct type_caster<houle::Untaken<First>> {
  NB_TYPE_CASTER(houle::Untaken<First>, const_name("object"))

  bool from_python(handle given, std::uint32_t flags, cleanup_list*) noexcept {
    if (!(flags & static_cast<std::uint32_t>(cast_flags::convert))) return false;
    value.first = given;
    if constexpr (std::is_same_v<First, houle::Grid<2>>) return isinstance<First>(given);
    return true;
  }
};

}  // namespace nanobind::detail
