// The pressure system at the true surface, projection, and what lies beyond the water: extrapolation.
#pragma once

#include <cstring>
#include <vector>

#include <houle/exec/turn.hpp>
#include <houle/water/surface.hpp>

namespace houle {

// Coefficients of the pressure system (15) at the true sub-cell surface:
//   sum_f k_f (p_c - p_nb) + e_c p_c = -(1/h) sum of the net outflux of `star`   [1/s], p = pressure / density.
// k = open mobility / h^2 on every face; e (cells): faces from an active cell to air, k / theta. Where mobility is null
// it is `step` everywhere; where star is null there is no right-hand side (the position correction). least: the depth
// [cells] that an active centre has at least (surface_fraction()).
template <int D>
void pressure_system(const Grid<D>& g, const std::uint8_t* active, const double* depth, ConstFaces<D, float> open,
                     ConstFaces<D> mobility, double step, ConstFaces<D> star, double least, Faces<D> k, double* e,
                     double* rhs) {
  parallel_for_face_slices(g, [=](int a, index first, index end) {
    const float* o = open[a];
    const double* mo = mobility[a];
    double* ka = k[a];
    const double h2 = 1.0 / (g.h[a] * g.h[a]);
    HOULE_INDEPENDENT
    for (index f = first; f < end; ++f) ka[f] = o[f] * (mo ? mo[f] : step) * h2;
  });
  constexpr int up = D - 1;
  const index nz = g.shape[up];
  parallel_for(
      g.cells() / nz,
      [=](index r) {
        const index row = r * nz, top = top_of(active + row, nz);
        std::fill(e + row, e + row + nz, 0.0);
        if (star[0]) std::fill(rhs + row, rhs + row + nz, 0.0);
        if (top == 0) return;
        const auto i = Grid<D>::unflat(r, rows_of<D>(g.shape));
        const auto beside = rows_beside<D>(g, i, g.shape);
        index first[D], next[D];  // face before the cell k = 0, and from there to the face after it
        for (int a = 0; a < D; ++a) {
          const auto stride = Grid<D>::strides(g.face_shape(a));
          first[a] = Grid<D>::flat(i, stride);
          next[a] = stride[a];
        }
        for (index j = 0; j < top; ++j) {
          const index c = row + j;
          if (!active[c]) continue;
          double air = 0.0, flux = 0.0;
          each_of<D>([&](auto axis) {
            constexpr int a = decltype(axis)::value;
            for (int s = 0; s < 2; ++s) {
              index nb;
              if constexpr (a == up) {
                nb = s ? (j + 1 < nz ? c + 1 : (g.periodic[up] ? row : -1))
                       : (j > 0 ? c - 1 : (g.periodic[up] ? row + nz - 1 : -1));
              } else {
                nb = beside[2 * a + s] < 0 ? -1 : beside[2 * a + s] + j;
              }
              if (nb < 0) continue;
              const index f = first[a] + j + (s ? next[a] : 0);
              if (star[0]) flux += (s ? 1.0 : -1.0) * open[a][f] * star[a][f] / g.h[a];
              if (!active[nb] && k[a][f] > 0.0) air += k[a][f] / surface_fraction(depth[c], depth[nb], least);
            }
          });
          e[c] = air;
          if (star[0]) rhs[c] = -flux;
        }
      },
      16);
}

// Takes the pressure gradient off the faces that touch an active cell (16), and stops the water at walls. u: on entry
// u*, taken as 0 if `still`; on return the projected velocity. valid (faces): 1 where the velocity is now known (the
// face touches an active cell, or is a wall), else 0. mobility null: `step`.
template <int D>
void project(const Grid<D>& g, const std::uint8_t* active, const double* depth, ConstFaces<D, float> open,
             ConstFaces<D> mobility, double step, const double* p, double least, Faces<D> u,
             const std::array<std::uint8_t*, D>& valid, bool still) {
  constexpr int up = D - 1;
  const index nz = g.shape[up];
  for (int a = 0; a < D; ++a) {
    const float* o = open[a];
    const double* mo = mobility[a];
    double* ua = u[a];
    std::uint8_t* known = valid[a];
    const double h = g.h[a];
    const auto shape = g.face_shape(a);
    const index line = shape[up];
    const auto wall = [=](index f) {
      ua[f] = 0.0;
      known[f] = 1;
    };
    const auto face = [=](index f, index low, index high) {
      const bool wet_low = active[low], wet_high = active[high];
      known[f] = (wet_low || wet_high) && o[f] > 0.0;
      if (!known[f]) return;
      const double factor = (mo ? mo[f] : step) / h;
      if (wet_low && wet_high) {
        ua[f] -= factor * (p[high] - p[low]);
      } else if (wet_low) {
        ua[f] += factor * p[low] / surface_fraction(depth[low], depth[high], least);
      } else {
        ua[f] -= factor * p[high] / surface_fraction(depth[high], depth[low], least);
      }
    };
    parallel_for(
        g.faces(a) / line,
        [=](index r) {
          const auto i = Grid<D>::unflat(r, rows_of<D>(shape));
          const index first = r * line;
          std::fill(known + first, known + first + line, std::uint8_t{0});
          if (still) std::fill(ua + first, ua + first + line, 0.0);
          if (a == up) {
            const index row = r * nz, top = top_of(active + row, nz);
            for (index k = 1; k <= std::min(top, nz - 1); ++k) face(first + k, row + k - 1, row + k);
            for (index k : {index{0}, nz}) {
              if (g.periodic[up])
                face(first + k, row + nz - 1, row);
              else if (k == 0 || active[row + nz - 1])
                wall(first + k);
              else  // spray may leave a dry lid; a wall there would hold it
                ua[first + k] = std::min(ua[first + k], 0.0);
            }
          } else if (!g.periodic[a] && (i[a] == 0 || i[a] == g.shape[a])) {
            for (index k = 0; k < line; ++k) wall(first + k);
          } else {
            const auto stride = Grid<D>::strides(g.shape);
            auto j = i;
            j[a] = inside(i[a] - 1, g.shape[a], true);
            const index low = Grid<D>::flat(j, stride);
            j[a] = inside(i[a], g.shape[a], true);
            const index high = Grid<D>::flat(j, stride),
                        top = std::max(top_of(active + low, nz), top_of(active + high, nz));
            for (index k = 0; k < top; ++k) face(first + k, low + k, high + k);
          }
        },
        16);
  }
}

// Eight flags as one number, and a test for one of them being 0.
constexpr index word = 8;
inline std::uint64_t word_at(const std::uint8_t* flags) {
  std::uint64_t w;
  std::memcpy(&w, flags, sizeof w);
  return w;
}
inline bool has_zero(std::uint64_t w) { return ((w - 0x0101010101010101u) & ~w & 0x8080808080808080u) != 0; }

// Carries known face values outwards, `layers` faces deep, each the mean of its known neighbours. known (faces): on
// entry 1 where known, else 0; on return the number of the layer + 1. After `near` layers, faces with mass > keep_mass
// count as known as they are: spray too far from the water for its pressure flies on. mass null: no such faces.
//
// A layer reads what is known from one copy of `known` and writes to the other, which the next layer reads. So, in
// parallel_in_turn, a layer finds only what the one before has left, even where a thread is a layer ahead beside it.
template <int D>
void extrapolate(const Grid<D>& g, int layers, int near, ConstFaces<D> mass, double keep_mass, Faces<D> u,
                 const std::array<std::uint8_t*, D>& known) {
  constexpr int up = D - 1;
  std::array<index, D + 1> first{};  // first face of each axis in the second copy
  for (int a = 0; a < D; ++a) first[a + 1] = first[a] + g.faces(a);
  std::vector<std::uint8_t> other(static_cast<std::size_t>(first[D]));
  std::array<std::array<std::uint8_t*, D>, 2> copies;
  for (int a = 0; a < D; ++a) copies[0][a] = known[a], copies[1][a] = other.data() + first[a];
  const auto add_layer = [=](int a, index r, int layer) {  // one more layer on a row of the faces of an axis
    const auto shape = g.face_shape(a);
    const index line = shape[up], period = g.periodic[up] ? g.shape[up] : 0, row = r * line;
    const std::uint8_t mark = static_cast<std::uint8_t>(layer + 1);
    double* ua = u[a];
    const std::uint8_t* before = copies[(layer + 1) % 2][a];
    std::uint8_t* now = copies[layer % 2][a];
    std::copy(before + row, before + row + line, now + row);
    if (mass[a] && layer == near + 1)
      for (index f = row; f < row + line; ++f) now[f] = !now[f] && mass[a][f] > keep_mass ? mark : now[f];
    auto beside = rows_beside<D>(g, Grid<D>::unflat(r, rows_of<D>(shape)), shape);
    for (index& n : beside) n = n < 0 ? row : n;  // behind a wall an entry sees itself: not known, not counted
    const auto fill = [=](index j) {
      if (now[row + j]) return;
      double sum = 0.0;
      int count = 0;
      const auto add = [&](index f) {
        if (before[f] && before[f] < mark) sum += ua[f], ++count;
      };
      for (index n : beside) add(n + j);
      add(row + (period ? (j - 1 + period) % period : std::max<index>(j - 1, 0)));
      add(row + (period ? (j + 1) % period : std::min(j + 1, line - 1)));
      if (!count) return;
      ua[row + j] = sum / count;
      now[row + j] = mark;
    };
    fill(0);
    index j = 1;
    for (; j + word <= line - 1; j += word) {  // entries that are not known but touch one that is, if any
      const std::uint8_t* here = before + row + j;
      std::uint64_t around = word_at(here - 1) | word_at(here + 1);
      for (index side : beside) around |= word_at(before + side + j);
      if (around == 0 || !has_zero(word_at(here))) continue;
      for (index i = j; i < j + word; ++i) fill(i);
    }
    for (; j < line - 1; ++j) fill(j);
    fill(line - 1);
  };
  const auto operation = [=](int k, index from, index to) {  // a layer more; after the last, what is left is 0
    for (int a = 0; a < D; ++a) {
      const auto shape = g.face_shape(a);
      const index line = shape[up], rows = g.faces(a) / line / shape[0];  // in a slice
      const index begin = from * rows, end = std::min(to, shape[0]) * rows;
      if (k < layers)
        for (index r = begin; r < end; ++r) add_layer(a, r, k + 1);
      else
        for (index f = begin * line; f < end * line; ++f) {
          known[a][f] = copies[layers % 2][a][f];
          u[a][f] = known[a][f] ? u[a][f] : 0.0;
        }
    }
  };
  const index slices = g.shape[0] + 1;
  const auto bound = [=](int s, int shares) { return slices * s / shares; };
  if (g.periodic[0])
    for (int k = 0; k <= layers; ++k) parallel_for(slices, [=](index i) { operation(k, i, i + 1); }, 16);
  else
    parallel_in_turn(slices, layers + 1, D * (layers + 1) * g.cells(), bound, operation);
  close_periodic(g, u);
}

// Continues the flow above the surface of single-valued columns (`column` not NaN): the vertical velocity that keeps
// div u = 0 with the horizontal velocities carried there, as the water between the last pressure cell and the surface
// must not be squeezed (18). Overwrites `layers` faces above the topmost active cell of each column.
template <int D>
void continue_upwards(const Grid<D>& g, int layers, const std::uint8_t* active, const double* column, Faces<D> u) {
  constexpr int up = D - 1;
  const index nz = g.shape[up], columns = g.cells() / nz;
  const auto shape = rows_of<D>(g.shape);
  parallel_for(
      columns,
      [=](index c) {
        if (std::isnan(column[c])) return;
        index top = nz - 1;
        while (top >= 0 && !active[c * nz + top]) --top;
        if (top < 0) return;
        auto i = Grid<D>::unflat(c, shape);
        for (index k = top + 1; k < std::min(top + 1 + layers, nz - 1); ++k) {
          i[up] = k;
          double squeeze = 0.0;
          for (int a = 0; a < up; ++a) {
            const auto stride = Grid<D>::strides(g.face_shape(a));
            const index f = Grid<D>::flat(i, stride);
            squeeze += (u[a][f + stride[a]] - u[a][f]) / g.h[a];
          }
          const index f = c * (nz + 1) + k;
          u[up][f + 1] = u[up][f] - g.h[up] * squeeze;
        }
      },
      64);
}

}  // namespace houle
