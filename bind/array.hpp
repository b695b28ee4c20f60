// Arrays as the core takes them from Python: as they are, or not at all.
//
// Nothing is converted: an output of another type or layout would be written into a copy that nobody sees. What an
// array lacks is said by the one who asks for its numbers, who knows the name of the argument.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include <houle/grid/grid.hpp>

namespace houle {

namespace nb = nanobind;

// An argument that does not fit. Whoever binds the function puts its name before the text.
struct Unfit {
  std::string text;
  bool of_type = false;  // TypeError, else ValueError
};

template <class T>
constexpr const char* number_name() {
  using Number = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Number, double>) return "float64";
  if constexpr (std::is_same_v<Number, float>) return "float32";
  if constexpr (std::is_same_v<Number, std::int8_t>) return "int8";
  if constexpr (std::is_same_v<Number, std::uint8_t>) return "uint8";
  if constexpr (std::is_same_v<Number, std::int32_t>) return "int32";
  if constexpr (std::is_same_v<Number, std::int64_t>) return "int64";
}

// Whether the buffer protocol's name of a type means T: native, aligned.
template <class T>
inline bool is_number(const char* format, Py_ssize_t size) {
  if (size != sizeof(T) || !format) return false;
  if (*format == '@' || *format == '=') ++format;
  if (!format[0] || format[1]) return false;
  if constexpr (std::is_floating_point_v<T>) return std::strchr("fd", format[0]);
  return std::strchr(std::is_signed_v<T> ? "bhilq" : "BHILQ", format[0]);
}

inline std::string text_of(nb::handle object) { return nb::str(object).c_str(); }

// "a read-only float32 array of shape (3, 4), not C-contiguous", or the type of what is no array.
inline std::string described(nb::handle given) {
  try {
    if (nb::hasattr(given, "dtype") && nb::hasattr(given, "shape") && nb::hasattr(given, "flags")) {
      const nb::object flags = given.attr("flags");
      const bool writable = nb::cast<bool>(flags.attr("writeable")), c = nb::cast<bool>(flags.attr("c_contiguous")),
                 aligned = nb::cast<bool>(flags.attr("aligned"));
      return std::string(writable ? "" : "read-only ") + text_of(given.attr("dtype")) + " array of shape " +
             text_of(given.attr("shape")) + (c ? "" : ", not C-contiguous") + (aligned ? "" : ", not aligned");
    }
  } catch (const std::exception&) {  // whatever it is, it is no array
  }
  return given.is_none() ? "None" : text_of(given.type().attr("__name__"));
}

// The numbers of an array while a function of the core works with them. T const: read only.
template <class T>
struct View {
  T* data = nullptr;
  index size = 0;
  int dimensions = 0;
  const Py_ssize_t* shape = nullptr;
  nb::handle owner;
  bool read_only = false;

  std::string shape_text() const {
    std::string text = "(";
    for (int a = 0; a < dimensions; ++a) text += (a ? ", " : "") + std::to_string(shape[a]);
    return text + (dimensions == 1 ? ",)" : ")");
  }
};

template <class T>
class Array {
 public:
  using Number = std::remove_const_t<T>;

  Array() = default;
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array() { give_back(); }

  void take(nb::handle given) noexcept {
    give_back();
    unfit_ = nb::object();
    constexpr int flags = PyBUF_FORMAT | PyBUF_C_CONTIGUOUS | (std::is_const_v<T> ? 0 : PyBUF_WRITABLE);
    if (PyObject_CheckBuffer(given.ptr()) && PyObject_GetBuffer(given.ptr(), &buffer_, flags) == 0) {
      held_ = true;
      const auto address = reinterpret_cast<std::uintptr_t>(buffer_.buf);
      if (is_number<Number>(buffer_.format, buffer_.itemsize) && address % alignof(Number) == 0) return;
      give_back();
    }
    PyErr_Clear();
    unfit_ = nb::borrow(given);
  }

  View<T> view(const char* name) const {
    if (!held_) {
      const std::string writable = std::is_const_v<T> ? "" : ", writable";
      throw Unfit{std::string(name) + " must be a C-contiguous array of " + number_name<T>() + writable + ", not " +
                      (unfit_ ? described(unfit_) : std::string("nothing")),
                  true};
    }
    return {static_cast<T*>(buffer_.buf),
            static_cast<index>(buffer_.len / buffer_.itemsize),
            buffer_.ndim,
            buffer_.shape,
            nb::handle(buffer_.obj),
            buffer_.readonly != 0};
  }

 private:
  Py_buffer buffer_{};
  bool held_ = false;
  nb::object unfit_;  // what was given instead

  void give_back() noexcept {
    if (held_) PyBuffer_Release(&buffer_);
    held_ = false;
  }
  void swap(Array& other) noexcept {
    std::swap(buffer_, other.buffer_);
    std::swap(held_, other.held_);
    std::swap(unfit_, other.unfit_);
  }
};

}  // namespace houle

namespace nanobind::detail {

// number_name for the type stub.
template <class Number>
constexpr auto number_in_stub() {
  if constexpr (std::is_same_v<Number, double>) return const_name("float64");
  if constexpr (std::is_same_v<Number, float>) return const_name("float32");
  if constexpr (std::is_same_v<Number, std::int8_t>) return const_name("int8");
  if constexpr (std::is_same_v<Number, std::uint8_t>) return const_name("uint8");
  if constexpr (std::is_same_v<Number, std::int32_t>) return const_name("int32");
  if constexpr (std::is_same_v<Number, std::int64_t>) return const_name("int64");
}

template <class T>
struct type_caster<houle::Array<T>> {
  using Taken = houle::Array<T>;
  NB_TYPE_CASTER(Taken,
                 const_name("numpy.typing.NDArray[numpy.") + number_in_stub<typename Taken::Number>() + const_name("]"))

  bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept {
    value.take(given);
    return true;
  }
};

}  // namespace nanobind::detail
