// Messages of the bindings about particles that have left the tank.
#pragma once

#include <cstdio>
#include <string>

#include "arguments.hpp"

namespace houle {

// FloatingPointError: the flow blew up.
[[noreturn]] inline void raise_blown_up(const std::string& text) {
  PyErr_SetString(PyExc_FloatingPointError, text.c_str());
  throw nb::python_error();
}

// Raises FloatingPointError if `outside` is the number of a particle, as cell_sort tells; -1: none is outside.
template <int D>
inline void require_inside(index outside, const double* x) {
  if (outside < 0) return;
  std::string at;
  for (int a = 0; a < D; ++a) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.4g", a ? ", " : "", x[outside * D + a]);
    at += number;
  }
  raise_blown_up("particle " + std::to_string(outside) + " is at (" + at + ") m, outside the tank");
}

}  // namespace houle
