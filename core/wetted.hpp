// How much of the cells lies on the wet side of the free surface, whatever way the surface runs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "surface.hpp"

namespace houle {

// Share of a box where the plane through the values at its 2^D corners (their mean, their mean slope) is above 0:
// the plane cuts a simplex off each corner above 0, of volume v^D / (D! prod slope), those of alternate corners with
// alternate signs. A slope below a thousandth of the steepest counts as this.
template <int D>
inline double share_above(const std::array<double, (1 << D)>& value) {
  constexpr int corners = 1 << D;
  double mean = 0.0, steepest = 0.0, reach = 0.0, scale = 1.0;
  std::array<double, D> slope{};
  for (int c = 0; c < corners; ++c) {
    mean += value[c] / corners;
    for (int a = 0; a < D; ++a) slope[a] += ((c >> a & 1) ? 2.0 : -2.0) * value[c] / corners;
  }
  for (double& s : slope) s = std::abs(s), steepest = std::max(steepest, s);
  for (int a = 0; a < D; ++a) {
    slope[a] = std::max(slope[a], 1e-3 * steepest);
    reach += 0.5 * slope[a], scale *= (a + 1) * slope[a];
  }
  if (std::abs(mean) >= reach) return mean > 0.0 ? 1.0 : 0.0;
  double total = 0.0;
  for (int c = 0; c < corners; ++c) {
    double v = mean, sign = 1.0;
    for (int a = 0; a < D; ++a)
      if (c >> a & 1)
        v += 0.5 * slope[a];
      else
        v -= 0.5 * slope[a], sign = -sign;
    if (v > 0.0) total += sign * (D == 2 ? v * v : v * v * v);
  }
  return total / scale;
}

// Share of a cell with depth > 0, from the depth of its centre and of those all around, the last axis fastest. In each
// half (quarter, eighth) of the cell between centre and corner the depth is (multi)linear; its plane counts.
template <int D>
inline double share_of(const std::array<double, (D == 2 ? 9 : 27)>& depth) {
  constexpr int corners = 1 << D;
  double total = 0.0;
  for (int part = 0; part < corners; ++part) {
    std::array<double, (1 << D)> value{};
    for (int c = 0; c < corners; ++c)
      for (int e = 0; e < corners; ++e) {  // mean of the centres around this corner of the part
        int at = 0;
        for (int a = 0; a < D; ++a) {
          const bool up = part >> a & 1, far = (c >> a & 1) == up, other = far && (e >> a & 1);
          at = 3 * at + (other ? (up ? 2 : 0) : 1);
        }
        value[c] += depth[at] / corners;
      }
    total += share_above<D>(value);
  }
  return total / corners;
}

// Share of each cell of the listed columns that is under water, share (count, nz).
//
// The surface is where the depth of the cell centres (in cells), linear between them, is 0: the place where the
// projection has p = 0, so that an upright surface is as exact as a level one. Cells all around which the centres are
// under water are full, however the particles lie in them. Outside the domain the depth is as inside; below the floor,
// and in cells closed by solids (open 0), it goes on as above: under a film it grows, beside an upright front it stays.
template <int D>
inline void wetted(const Grid<D>& g, const double* depth, const double* open, index count, const std::int64_t* column,
                   double* share) {
  const index nz = g.shape[D - 1];
  const auto stride = Grid<D>::strides(g.shape);
  const auto depth_at = [=](index row, index k) {
    if (k >= 0 && open[row + k] > 0.0) return depth[row + k];
    if (k + 1 >= nz) return 0.0;
    const double above = depth[row + k + 1], more = above - (k + 2 < nz ? depth[row + k + 2] : -1.0);
    return above + std::clamp(more, 0.0, 1.0);
  };
  parallel_for(
      count,
      [=](index n) {
        constexpr int rows = D == 2 ? 3 : 9;
        const auto i = Grid<D>::unflat(column[n] * nz, g.shape);
        index row[rows] = {};  // where the columns around begin
        for (int r = 0; r < rows; ++r)
          for (int a = D - 2, q = r; a >= 0; --a, q /= 3)
            row[r] += inside(i[a] + q % 3 - 1, g.shape[a], g.periodic[a]) * stride[a];
        for (index k = 0; k < nz; ++k) {
          std::array<double, (D == 2 ? 9 : 27)> around;
          bool wet = true, dry = true;
          for (int r = 0; r < rows; ++r)
            for (int s = 0; s < 3; ++s) {
              const double d = depth_at(row[r], std::min(k + s - 1, nz - 1));
              around[3 * r + s] = d;
              (d >= 0.0 ? dry : wet) = false;
            }
          share[n * nz + k] = wet ? 1.0 : (dry ? 0.0 : share_of<D>(around));
        }
      },
      16);
}

// Marks, in place, the cells beside marked ones too: all up to one away along any axis.
template <int D>
inline void spread(const Grid<D>& g, std::vector<std::uint8_t>& cells, std::vector<std::uint8_t>& work) {
  constexpr int up = D - 1;
  const index nz = g.shape[up];
  for (int a = 0; a < D; ++a) {
    work = cells;
    const std::uint8_t* from = work.data();
    std::uint8_t* to = cells.data();
    parallel_for_grid(
        g.cells() / nz,
        [=](index r) {
          const index row = r * nz;
          if (a == up) {
            for (index k = 1; k < nz; ++k) to[row + k] |= from[row + k - 1];
            for (index k = 1; k < nz; ++k) to[row + k - 1] |= from[row + k];
            if (g.periodic[up]) to[row] |= from[row + nz - 1], to[row + nz - 1] |= from[row];
            return;
          }
          const auto beside = rows_beside<D>(g, Grid<D>::unflat(r, rows_of<D>(g.shape)), g.shape);
          for (int s = 0; s < 2; ++s)
            for (index k = 0, n = beside[2 * a + s]; n >= 0 && k < nz; ++k) to[row + k] |= from[n + k];
        },
        64);
  }
}

// What the surface says of each cell: 2 full, 1 what wetted() says, 0 nothing, since it is away from the surface, or
// water or air near it is too thin for the grid to show a surface.
//
// Full is a cell all around which is water. Water (air) is thick enough where it reaches all around a cell, too thin
// where it does so around no cell next to it. The fill knows of water in the next cell: near is two cells. A full cell
// which lacks the place of a particle, 2^-D of its fill, or more, is at a bubble: it and those beside it are near it.
template <int D>
inline void shown(const Grid<D>& g, const std::uint8_t* active, const double* open, const double* fill,
                  std::uint8_t* kind) {
  using Cells = std::vector<std::uint8_t>;
  const auto count = static_cast<std::size_t>(g.cells());
  Cells beside_air(count), beside_water(count), in_water(count), in_air(count), thin(count), work;
  for (std::size_t c = 0; c < count; ++c) beside_water[c] = active[c], beside_air[c] = !active[c] && open[c] > 0.0;
  spread(g, beside_water, work), spread(g, beside_air, work);
  for (std::size_t c = 0; c < count; ++c) {
    in_water[c] = !beside_air[c], in_air[c] = !beside_water[c];
    thin[c] = in_water[c] && open[c] > 0.0 && fill[c] < 1.0 - 1.0 / (1 << D);
  }
  spread(g, in_water, work), spread(g, in_air, work), spread(g, thin, work);
  for (std::size_t c = 0; c < count; ++c) {
    kind[c] = !beside_air[c] && !thin[c] ? 2 : 0;
    thin[c] |= active[c] ? !in_water[c] : open[c] > 0.0 && !in_air[c];
  }
  spread(g, thin, work), spread(g, thin, work);
  for (std::size_t c = 0; c < count; ++c)
    if (kind[c] == 0) kind[c] = beside_water[c] && !thin[c];
}

}  // namespace houle
