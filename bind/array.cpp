// The part of the bindings that looks into the arrays which Python passes, and the messages about those that do not
// fit.
#include "array.hpp"

#include <cstring>
#include <stdexcept>

namespace houle {

Call*& Call::current() {
  static thread_local Call* now = nullptr;
  return now;
}

Py_buffer* Call::hold(nb::handle object, int flags) {
  if (count_ == most) refuse("takes no more than " + std::to_string(most) + " arrays");
  Py_buffer* buffer = buffer_ + count_;
  if (!PyObject_CheckBuffer(object.ptr()) || PyObject_GetBuffer(object.ptr(), buffer, flags) != 0) return nullptr;
  ++count_;
  return buffer;
}

static std::string in_the_name_of_the_call(const std::string& text) {
  const Call* call = Call::current();
  return call ? std::string(call->name()) + "(): " + text : text;
}

void refuse(const std::string& text) { throw nb::value_error(in_the_name_of_the_call(text).c_str()); }

void refuse_type(const std::string& text) { throw nb::type_error(in_the_name_of_the_call(text).c_str()); }

std::string text_of(nb::handle object) { return nb::str(object).c_str(); }

std::string described(nb::handle given) {
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

std::string shape_text(const index* shape, int d) {
  std::string text = "(";
  for (int a = 0; a < d; ++a) text += (a ? ", " : "") + std::to_string(shape[a]);
  return text + (d == 1 ? ",)" : ")");
}

struct NumberType {
  const char* name;
  Py_ssize_t size;
  const char* codes;  // letters of the buffer protocol for it
};

static constexpr NumberType number_types[] = {{"float64", 8, "fd"},  {"float32", 4, "fd"},  {"int8", 1, "bhilq"},
                                              {"uint8", 1, "BHILQ"}, {"int32", 4, "bhilq"}, {"int64", 8, "bhilq"}};

static const NumberType& type_of(Number number) { return number_types[static_cast<int>(number)]; }

const char* number_name(Number number) { return type_of(number).name; }

// True if these are numbers of that type: native, aligned.
static bool is_of(const NumberType& type, const Py_buffer& buffer) {
  const char* format = buffer.format;
  if (buffer.itemsize != type.size || !format) return false;
  if (*format == '@' || *format == '=') ++format;
  return format[0] && !format[1] && std::strchr(type.codes, format[0]) &&
         reinterpret_cast<std::uintptr_t>(buffer.buf) % static_cast<std::uintptr_t>(type.size) == 0;
}

Extent extent_of(nb::handle given, Number number, bool writable, const char* name) {
  constexpr int flags = PyBUF_FORMAT | PyBUF_C_CONTIGUOUS;
  const NumberType& type = type_of(number);
  const Py_buffer* buffer = Call::current()->hold(given, flags | (writable ? PyBUF_WRITABLE : 0));
  if (!buffer || !is_of(type, *buffer)) {
    PyErr_Clear();
    refuse_type(std::string(name) + " must be a C-contiguous array of " + type.name + (writable ? ", writable" : "") +
                ", not " + described(given));
  }
  return {buffer->buf,  static_cast<index>(buffer->len / buffer->itemsize),
          buffer->ndim, buffer->shape,
          buffer->obj,  buffer->readonly != 0};
}

bool Handles::take(nb::handle given) noexcept {
  PyObject* list = given.ptr();
  const bool tuple = PyTuple_Check(list);
  if (!tuple && !PyList_Check(list)) return false;
  size = static_cast<std::size_t>(tuple ? PyTuple_Size(list) : PyList_Size(list));
  for (std::size_t k = 0; k < size && k < 3; ++k)
    item[k] =
        tuple ? PyTuple_GetItem(list, static_cast<Py_ssize_t>(k)) : PyList_GetItem(list, static_cast<Py_ssize_t>(k));
  return true;
}

}  // namespace houle
