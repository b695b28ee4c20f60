// The part of the bindings that treats arguments, the same for all bound functions: compiled once.
#include "arguments.hpp"

#include <houle/exec/tables.hpp>

namespace houle {

// The first argument of a call that no function took, in the second of nanobind's two passes over the overloads: the
// first one converts no numbers, and must be over.
template <bool of_2d>
struct Untaken {
  nb::handle first;
};

}  // namespace houle

namespace nanobind::detail {

template <bool of_2d>
struct has_arg_defaults<houle::Untaken<of_2d>> : std::true_type {};  // None, too

template <bool of_2d>
struct type_caster<houle::Untaken<of_2d>> {
  NB_TYPE_CASTER(houle::Untaken<of_2d>, const_name("object"))

  bool from_python(handle given, std::uint32_t flags, cleanup_list*) noexcept {
    if (!(flags & static_cast<std::uint32_t>(cast_flags::convert))) return false;
    value.first = given;
    return !of_2d || isinstance<houle::Grid<2>>(given);
  }
};

}  // namespace nanobind::detail

namespace houle {

// ---- functions ------------------------------------------------------------------------------------------------------

// Says which argument of a call does not fit.
struct Diagnosis {
  const Kind* kinds;
  std::vector<const char*> names;

  [[noreturn]] void operator()(nb::handle first, const nb::args& more, const nb::kwargs& named) const {
    const std::size_t given = 1 + more.size();
    if (given + named.size() > names.size())
      refuse_type("takes at most " + std::to_string(names.size()) + " arguments, not " +
                  std::to_string(given + named.size()));
    for (auto [key, value] : named) require_name(nb::cast<std::string>(key));
    for (std::size_t k = 0; k < names.size(); ++k) check(k, first, more, named);
    refuse_type("the arguments do not fit");
  }

 private:
  void require_name(const std::string& key) const {
    for (const char* name : names)
      if (key == name) return;
    refuse_type("has no argument " + key);
  }

  void check(std::size_t k, nb::handle first, const nb::args& more, const nb::kwargs& named) const {
    nb::handle value = k == 0 ? first : nb::handle();
    if (k > 0 && k <= more.size()) value = more[k - 1].ptr();
    nb::object by_name;
    if (!value && named.contains(names[k])) value = by_name = named[names[k]];
    if (!value) return;  // left out: it has a default, or nanobind says so
    if ((!value.is_none() || kinds[k].optional) && kinds[k].fits(value)) return;
    PyErr_Clear();
    refuse_type(std::string(names[k]) + " must be " + kinds[k].words() + ", not " + described(value));
  }
};

template <bool of_2d>
static void explain(nb::module_& m, const char* name, const Diagnosis& diagnosis) {
  const auto* kept = new Diagnosis(diagnosis);  // as long as the function: for ever
  m.def(name, [kept, name](Untaken<of_2d> of, nb::args more, nb::kwargs named) {
    const Call call(name);
    (*kept)(of.first, more, named);
  });
}

void explain_misfits(nb::module_& m, const char* name, const Kind* kinds, std::initializer_list<const char*> names,
                     bool of_2d) {
  Diagnosis diagnosis{kinds, {}};
  for (const char* one : names)
    if (one) diagnosis.names.push_back(one);
  of_2d ? explain<true>(m, name, diagnosis) : explain<false>(m, name, diagnosis);
}

// ---- arrays ---------------------------------------------------------------------------------------------------------

void wrong_size(const Extent& v, const std::string& name, const std::string& wanted) {
  refuse(name + " has " + std::to_string(v.size) + " entries, shape " + v.shape_text() + ", wanted " + wanted);
}

bool has_shape(const Extent& v, const index* shape, int d, index size) {
  if (v.size != size) return false;
  if (v.dimensions == 1) return true;
  bool same = v.dimensions == d;
  for (int a = 0; same && a < d; ++a) same = v.shape[a] == shape[a];
  return same;
}

void* entries_of(const Extent& v, index n, const char* name) {
  if (v.size != n) wrong_size(v, name, std::to_string(n));
  return v.at;
}

void* shaped(const Extent& v, const index* shape, int d, index n, const char* of, const char* name) {
  if (!has_shape(v, shape, d, n))
    wrong_size(v, name, "the " + std::to_string(n) + " " + of + " of the grid, " + shape_text(shape, d));
  return v.at;
}

void faces_of(const index* cells, int d, const Handles& arrays, Number number, bool writable, const char* name,
              bool none, void** data) {
  if (none && arrays.size == 0) return;
  if (arrays.size != static_cast<std::size_t>(d))
    refuse(std::string(name) + " needs one array per axis, " + std::to_string(d) + ", not " +
           std::to_string(arrays.size));
  for (int a = 0; a < d; ++a) {
    const Extent v = extent_of(arrays.item[a], number, writable, name);
    index shape[3], n = 1;
    for (int b = 0; b < d; ++b) n *= shape[b] = cells[b] + (a == b ? 1 : 0);
    if (!has_shape(v, shape, d, n))
      refuse(std::string(name) + " does not fit the faces of axis " + std::to_string(a) + ": shape " + v.shape_text() +
             ", wanted " + shape_text(shape, d));
    data[a] = v.at;
  }
}

void require_points(const Extent& v, int d, const char* name) {
  if (v.dimensions != 2 || v.shape[1] != d)
    refuse(std::string(name) + " must have shape (N, " + std::to_string(d) + "), not " + v.shape_text());
  if (v.shape[0] > std::numeric_limits<std::int32_t>::max())
    refuse(std::string(name) + " has " + std::to_string(v.shape[0]) + " points: at most 2^31 - 1 can be numbered");
}

void require_rows(const Extent& v, Py_ssize_t width, const char* name) {
  if (v.dimensions != 2 || v.shape[1] != width)
    refuse(std::string(name) + " must have shape (K, " + std::to_string(width) + "), not " + v.shape_text());
}

Paddles paddles_of(const OptionalGiven& table) {
  static_assert(sizeof(Paddle) == 2 * sizeof(double));
  if (!table) return {};
  const auto all = rows<Paddle>(*table, "paddles");
  return {all.data, static_cast<int>(all.n)};
}

Gates gates_in(double length, const Given& table) {
  static_assert(sizeof(Gate) == 2 * sizeof(double));
  const auto all = rows<Gate>(table, "gates");
  for (index k = 0; k < all.n; ++k)
    if (!(all.data[k].x >= 0.0 && all.data[k].x <= length && all.data[k].bottom >= 0))
      refuse("gates: one stands outside the tank, or its lower edge is below the floor");
  return {all.data, static_cast<int>(all.n)};
}

// ---- index tables ---------------------------------------------------------------------------------------------------

template <class T>
void require_table(const View<T>& v, const char* name, Table kind, index limit) {
  if (v.read_only && known_table(v.owner, v.data, kind, limit)) return;
  bool wrong = false;
  if (kind == Table::numbers || kind == Table::some) {
    const std::remove_const_t<T> none = kind == Table::some ? -1 : 0;
    if (v.size > 0) {
      const auto ends = ends_of(v.data, v.size);
      wrong = ends.least < none || ends.most >= limit;
    }
    if (wrong)
      refuse(std::string(name) + " has numbers outside " + std::to_string(none) + " to " + std::to_string(limit - 1));
  } else {
    const bool strictly = kind == Table::groups;
    wrong = v.size < 1 || v.data[0] != 0 || v.data[v.size - 1] != limit || !grows(v.data, v.size, strictly);
    if (wrong)
      refuse(std::string(name) + " does not fit: it must grow from 0 to " + std::to_string(limit) +
             (strictly ? " by one at least" : " and never fall"));
  }
  if (v.read_only) note_table(v.owner, v.data, kind, limit);
}

template void require_table(const View<const std::int32_t>&, const char*, Table, index);
template void require_table(const View<const std::int64_t>&, const char*, Table, index);

}  // namespace houle
