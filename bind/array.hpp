// Arrays as the core takes them from Python: as they are, or not at all.
//
// Nothing is converted: an output of another type or layout would be written into a copy that nobody sees. What an
// array lacks is said by the one who asks for its numbers, who knows the name of the argument.
//
// An argument is no more than a handle, and what looks into it is compiled once, in array.cpp: each function that is
// bound takes a dozen arrays, and what it did with each by itself was half of the module and of the time to build it.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <string>
#include <type_traits>

#include <houle/grid/grid.hpp>

namespace houle {

namespace nb = nanobind;

// One call of a bound function, from its first line to its last: its name stands before every message, and the buffers
// of its arrays are given back when it ends.
class Call {
 public:
  explicit Call(const char* name) : outer_(current()), name_(name) { current() = this; }
  ~Call() {
    while (count_ > 0) PyBuffer_Release(&buffer_[--count_]);
    current() = outer_;
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  static Call*& current();  // the call under way in this thread
  const char* name() const { return name_; }
  // The buffer of an object, null with a Python error if it has none like that.
  Py_buffer* hold(nb::handle object, int flags);

 private:
  static constexpr int most = 64;  // buffers
  Call* outer_;
  const char* name_;
  int count_ = 0;
  Py_buffer buffer_[most];
};

// Raises ValueError, or TypeError, in the name of the function that is called.
[[noreturn]] void refuse(const std::string& text);
[[noreturn]] void refuse_type(const std::string& text);

std::string text_of(nb::handle object);
// "a read-only float32 array of shape (3, 4), not C-contiguous", or the type of what is no array.
std::string described(nb::handle given);
std::string shape_text(const index* shape, int d);

enum class Number { float64, float32, int8, uint8, int32, int64 };

template <class T>
constexpr Number number_of() {
  using N = std::remove_const_t<T>;
  if constexpr (std::is_same_v<N, double>) return Number::float64;
  if constexpr (std::is_same_v<N, float>) return Number::float32;
  if constexpr (std::is_same_v<N, std::int8_t>) return Number::int8;
  if constexpr (std::is_same_v<N, std::uint8_t>) return Number::uint8;
  if constexpr (std::is_same_v<N, std::int32_t>) return Number::int32;
  if constexpr (std::is_same_v<N, std::int64_t>) return Number::int64;
}

const char* number_name(Number number);

// An array without the type of its numbers: place, shape, and the object that owns it.
struct Extent {
  void* at = nullptr;
  index size = 0;
  int dimensions = 0;
  const Py_ssize_t* shape = nullptr;
  nb::handle owner;
  bool read_only = false;

  std::string shape_text() const { return houle::shape_text(shape, dimensions); }
};

// Holds the buffer of an array until the call ends; refuses what is no C-contiguous array of those numbers.
Extent extent_of(nb::handle given, Number number, bool writable, const char* name);

// The numbers of an array while a function of the core works with them. T const: read only.
template <class T>
struct View : Extent {
  T* data = nullptr;
};

template <class T>
struct Array {
  nb::handle given;

  View<T> view(const char* name) const {
    const Extent extent = extent_of(given, number_of<T>(), !std::is_const_v<T>, name);
    return {extent, static_cast<T*>(extent.at)};
  }
};

// A list or tuple of arrays, one per axis; size: how many there are, of which three are kept.
struct Handles {
  nb::handle item[3];
  std::size_t size = 0;

  bool take(nb::handle given) noexcept;
};

template <class T>
struct Arrays : Handles {
  Array<T> operator[](std::size_t k) const { return {item[k]}; }
};

// The names of types in the stub.
template <class T>
constexpr auto array_in_stub() {
  using nb::detail::const_name;
  constexpr auto named = [](const auto& number) {
    return const_name("numpy.typing.NDArray[numpy.") + number + const_name("]");
  };
  constexpr Number number = number_of<T>();
  if constexpr (number == Number::float64) return named(const_name("float64"));
  if constexpr (number == Number::float32) return named(const_name("float32"));
  if constexpr (number == Number::int8) return named(const_name("int8"));
  if constexpr (number == Number::uint8) return named(const_name("uint8"));
  if constexpr (number == Number::int32) return named(const_name("int32"));
  if constexpr (number == Number::int64) return named(const_name("int64"));
}

}  // namespace houle

namespace nanobind::detail {

template <class T>
struct type_caster<houle::Array<T>> {
  NB_TYPE_CASTER(houle::Array<T>, houle::array_in_stub<T>())

  bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept {
    value.given = given;
    return true;
  }
};

template <class T>
struct type_caster<houle::Arrays<T>> {
  NB_TYPE_CASTER(houle::Arrays<T>,
                 const_name("collections.abc.Sequence[") + houle::array_in_stub<T>() + const_name("]"))

  bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept { return value.take(given); }
};

}  // namespace nanobind::detail
