// The Cartesian staggered (MAC) grid: shape, spacing and which axes repeat. No data: arrays are passed beside it.
//
// Arrays are C-ordered, the last axis (up) fastest. A cell field has the grid's shape; a face field of axis a has one
// more entry along a: face i lies at x_a = i h_a, between cells i-1 and i. On a periodic axis face 0 and face n are the
// same face; both entries are kept equal. Every cell field of n cells and every face field is dense, without ghosts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <houle/exec/loop.hpp>

namespace houle {

// A grid of D = 2 or 3 axes. shape: cells along each axis; h: size of a cell along each axis [m]; periodic: whether the
// two ends of an axis are the same place.
template <int D>
struct Grid {
  static_assert(D == 2 || D == 3);
  std::array<index, D> shape{};
  std::array<double, D> h{};  // spacing per axis [m]
  std::array<bool, D> periodic{};

  // Number of cells.
  index cells() const {
    index n = 1;
    for (index s : shape) n *= s;
    return n;
  }
  // Volume of a cell [m^D].
  double cell_volume() const {
    double v = 1;
    for (double s : h) v *= s;
    return v;
  }
  // Shape of a field on the faces across an axis.
  std::array<index, D> face_shape(int axis) const {
    auto s = shape;
    s[axis] += 1;
    return s;
  }
  // Number of faces across an axis.
  index faces(int axis) const {
    index n = 1;
    for (index s : face_shape(axis)) n *= s;
    return n;
  }
  // Strides of a field of that shape: along each axis, the distance in memory from an entry to the next one.
  static std::array<index, D> strides(const std::array<index, D>& shape) {
    std::array<index, D> s{};
    s[D - 1] = 1;
    for (int a = D - 2; a >= 0; --a) s[a] = s[a + 1] * shape[a + 1];
    return s;
  }
  // The place in memory of the entry at i, in a field of those strides.
  static index flat(const std::array<index, D>& i, const std::array<index, D>& stride) {
    index f = 0;
    for (int a = 0; a < D; ++a) f += i[a] * stride[a];
    return f;
  }
  // The inverse of flat(): the numbers along the axes of the entry at place f in memory, in a field of that shape.
  static std::array<index, D> unflat(index f, const std::array<index, D>& shape) {
    std::array<index, D> i{};
    for (int a = D - 1; a >= 0; --a) {
      i[a] = f % shape[a];
      f /= shape[a];
    }
    return i;
  }
};

// The shape of the rows of a field, its lines along the last axis.
template <int D>
inline std::array<index, D> rows_of(std::array<index, D> shape) {
  shape[D - 1] = 1;
  return shape;
}

// Index i of an axis with n entries, brought inside: around a periodic axis, however short, else onto the nearer end.
inline index inside(index i, index n, bool periodic) {
  if (i < 0) return periodic ? n - 1 - (-1 - i) % n : 0;
  if (i >= n) return periodic ? i % n : n - 1;
  return i;
}

// floor(s) as an index. A position far beyond any grid, or NaN, becomes an index outside the grid: none wraps around.
inline index floor_index(double s) {
  constexpr double far = 1e9;  // cells; an axis has fewer than 2^31
  s = s > -far ? s : -far;     // NaN goes here
  return static_cast<std::int32_t>(std::floor(s < far ? s : far));
}

// Calls body(axis, first, end) with the faces of every axis, slice by slice across the first: those numbered first to
// end - 1 are in one slice.
template <int D, class Body>
inline void parallel_for_face_slices(const Grid<D>& g, Body body) {
  parallel_for(
      g.shape[0] + 1,
      [=](index i) {
        for (int a = 0; a < D; ++a) {
          if (a > 0 && i == g.shape[0]) continue;
          const index slice = g.faces(a) / g.face_shape(a)[0];
          body(a, i * slice, (i + 1) * slice);
        }
      },
      std::max<index>(1, 2048 * g.shape[0] / g.cells()));
}

// One quantity on the faces of all axes: an array for each axis, in the shape face_shape(axis).
template <int D, class Real = double>
struct Faces {
  std::array<Real*, D> data{};
  Real* operator[](int a) const { return data[a]; }
};

// The same, to be read only. Null: there is no such quantity.
template <int D, class Real = double>
struct ConstFaces {
  std::array<const Real*, D> data{};
  ConstFaces() = default;
  ConstFaces(const Faces<D, Real>& f) {
    for (int a = 0; a < D; ++a) data[a] = f[a];
  }
  const Real* operator[](int a) const { return data[a]; }
};

// A property of the cells that takes few different values: `value` is a table of them, `number` has for each cell its
// row of the table. Null: there is no such property.
struct Listed {
  const std::int32_t* number = nullptr;
  const double* value = nullptr;
  double operator[](index cell) const { return value[number[cell]]; }
  Listed operator+(index cell) const { return {number + cell, value}; }
  explicit operator bool() const { return number != nullptr; }
};

// A vertical wall across the first axis that may stand anywhere between the faces, such as a piston. It stands
// `mirrored` cells (water/transfer.hpp) or more from the sides of the tank.
struct Paddle {
  double x;     // [m]
  double side;  // > 0: the water is on its far side, at larger x; else on its near side
};

// All paddles of a tank; none: count 0.
struct Paddles {
  const Paddle* paddle = nullptr;
  int count = 0;
};

}  // namespace houle
