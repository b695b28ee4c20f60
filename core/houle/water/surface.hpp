// The water on the grid: fill fraction of the cells, the free surface that cuts them, the active cells, which have a
// pressure.
#pragma once

#include <limits>

#include <houle/exec/reduce.hpp>
#include <houle/water/columns.hpp>
#include <houle/water/transfer.hpp>

namespace houle {

// Signed distance, in cells, from a cell's centre up to a flat surface whose tent-smoothed fill is F: the exact inverse
// of F(d) = 1 - (1-d)^2/2 (0 <= d <= 1), (1+d)^2/2 (-1 <= d < 0). Positive: the centre is under water.
inline double depth_from_fill(double F) {
  if (F >= 1.0) return 1.0;
  if (F >= 0.5) return 1.0 - std::sqrt(2.0 * (1.0 - F));
  if (F > 0.0) return -1.0 + std::sqrt(2.0 * F);
  return -1.0;
}

// Height of water standing in each column of cells, sum_p V_p B(x_p - x_c) / (plan area of a cell) [m], with the
// quadratic B-spline B in the horizontal: its derivative, with which the flux between columns is taken, is the tent
// that the position correction keeps full, so that the count of particles in a column adds no noise. Walls and gates
// fold, paddles between the faces mirror.
template <int D>
void column_heights(const Grid<D>& g, const std::int32_t* start, const double* x, const double* volume,
                    const Paddles& paddles, const Gates& gates, double* height) {
  const index nz = g.shape[D - 1], columns = g.cells() / nz;
  const double area = g.cell_volume() / g.h[D - 1];
  const index across = D == 3 ? g.shape[1] : 1;
  parallel_for(columns, [=](index c) { height[c] = 0.0; });
  between_gates(g, gates, [=](auto keep) {
    each_slab(g, start, [=](index begin, index end) {
      for (index p = begin; p < end; ++p) {
        const double v = volume[p] / area;
        const auto add = [=](const double* at) {
          Reach<QuadraticKernel> reach[D - 1];
          each_of<D - 1>([&](auto a) { reach[a].set(at[a] / g.h[a] - 0.5, {}, false, g.shape[a], g.periodic[a]); });
          keep(reach[0], at);
          each_of<3>([&](auto i) {
            const index row = reach[0].node[i] * across;
            const double w = reach[0].weight[i] * v;
            if constexpr (D == 2)
              height[row] += w;
            else
              each_of<3>([&](auto j) { height[row + reach[1].node[j]] += w * reach[1].weight[j]; });
          });
        };
        add(x + D * p);
        each_image(g, paddles, x + D * p, add);
      }
    });
  });
}

// True if a gate stands on the face of the first axis at x [m] and reaches below at least one of two water levels [m].
// It reaches below a level that is NaN, too.
inline bool gate_between(const Gates& gates, double x, double spacing, double level, double other) {
  for (int k = 0; k < gates.count; ++k) {
    const Gate& gate = gates.gate[k];
    if (std::abs(gate.x - x) < 0.5 * spacing && !(level <= gate.bottom && other <= gate.bottom)) return true;
  }
  return false;
}

// Finds the free surface from the fill fraction of every cell: depth (cells), the depth of the cell centres below it
// [cells], active (cells), 1 where a centre is under water, and the level of each column.
//
// Where a column is single-valued (full below, empty above) and no steeper than 45 degrees (gates apart), its surface
// lies where the water of the whole column fills it. That is exact for the volume, and it answers a rise of any size,
// however small beside the cell, which the fill of single cells does not (docs/decisions/0001). Elsewhere the depth
// comes from each cell's fill.
//
// open (cells): share of each cell that solids leave open. level (columns) [m]: the level to which its water fills each
// column, from column_heights() where porosity and openness are the same all around, else from column_levels(). Out:
// column (columns), level of single-valued columns [cells], NaN in others; eta (columns), level of the surface above z
// = 0 [m], NaN where dry.
template <int D>
void find_surface(const Grid<D>& g, const double* fill, const Listed& open, const double* level, const Gates& gates,
                  double* depth, std::uint8_t* active, double* column, double* eta) {
  const index nz = g.shape[D - 1], columns = g.cells() / nz;
  const double hz = g.h[D - 1];
  // ground: closed cells at the bottom of a column
  const auto ground = [=](index c) {
    index k = 0;
    while (k < nz && open[c * nz + k] <= 0.0) ++k;
    return k;
  };
  // level of the water in a single-valued column, in cells; NaN in any other
  parallel_for(
      columns,
      [=](index c) {
        const double* F = fill + c * nz;
        const Listed o = open + c * nz;
        index bed = 0, k = 0;
        while (bed < nz && o[bed] < 1.0 && (bed == 0 || o[bed] >= o[bed - 1])) ++bed;
        while (k < nz && (o[k] <= 0.0 || F[k] >= 0.5)) ++k;
        const index top = k;  // first cell less than half full
        bool single = top > 0 || (F[0] > 0.0 && (nz < 3 || F[2] < 1e-3));
        for (index j = bed; j < nz && single; ++j)
          single = o[j] >= 1.0 && (j + 2 < top ? F[j] > 0.8 : (j > top + 1 ? F[j] < 1e-3 : true));
        column[c] =
            single ? std::max(level[c] / hz, static_cast<double>(ground(c))) : std::numeric_limits<double>::quiet_NaN();
      },
      64);
  std::array<index, D> shape = g.shape;
  shape[D - 1] = 1;
  const auto stride = Grid<D>::strides(shape);
  parallel_for(
      columns,
      [=](index c) {
        const auto i = Grid<D>::unflat(c, shape);
        bool gentle = !std::isnan(column[c]);
        for (int a = 0; a < D - 1 && gentle; ++a)
          for (int side = -1; side <= 1; side += 2) {
            index j = i[a] + side;
            if (g.periodic[a]) j = (j + shape[a]) % shape[a];
            if (j < 0 || j >= shape[a]) continue;
            const double other = column[c + (j - i[a]) * stride[a]];
            const double face = static_cast<double>(std::max(i[a], i[a] + side)) * g.h[a];
            if (a == 0 && gate_between(gates, face, g.h[a], column[c] * hz, other * hz)) continue;
            if (!(std::abs(other - column[c]) * hz <= g.h[a])) gentle = false;
          }
        const double* F = fill + c * nz;
        const Listed o = open + c * nz;
        index top = -1, holes = 0;
        for (index k = 0; k < nz; ++k) {
          const double d = gentle ? column[c] - (k + 0.5) : depth_from_fill(F[k]);
          depth[c * nz + k] = d;
          const bool wet = d >= 0.0 && o[k] > 0.0;
          active[c * nz + k] = wet;
          if (wet && holes <= 2) top = k, holes = 0;
          if (!wet && o[k] > 0.0 && top >= 0) ++holes;  // trapped air of two cells at most is looked through
        }
        const index bed = ground(c);
        if (gentle) {
          const bool dry = column[c] <= bed + 1e-6 || (o[bed] < 1.0 && F[bed] <= 1e-6);
          eta[c] = dry ? std::numeric_limits<double>::quiet_NaN() : column[c] * hz;
        } else if (top >= 0) {
          const double d = depth[c * nz + top], above = top + 1 < nz ? depth[c * nz + top + 1] : -1.0;
          eta[c] = (top + 0.5 + d / (d - std::min(above, 0.0) + 1e-300)) * hz;
        } else {  // a film thinner than half a cell, or nothing
          double height = 0.0;
          for (index k = bed; k < std::min<index>(nz, bed + 2); ++k) height += o[k] * std::min(F[k], 1.0);
          eta[c] = height > 1e-6 ? (bed + 1.0 - o[bed] + height) * hz : std::numeric_limits<double>::quiet_NaN();
        }
      },
      64);
}

// True if there is water in row `row` of the cells, counted upwards, or above.
template <int D>
bool water_above(const Grid<D>& g, const double* fill, index row) {
  const index nz = g.shape[D - 1];
  return parallel_max(g.cells() / nz, [=](index c) {
           const double *first = fill + c * nz + std::clamp<index>(row, 0, nz), *last = fill + (c + 1) * nz;
           return std::all_of(first, last, [](double F) { return F == 0.0; }) ? 0.0 : 1.0;
         }) > 0.0;
}

// Place of the surface: its distance from an active centre towards its neighbour in air, in cells, at most 1 (ghost
// fluid, Gibou 2002). d_water, d_air: depths of the two centres [cells]. The depth of the active centre counts as
// `least` at least, which bounds the coefficient on all faces of the cell alike: its pressure is that of this depth,
// and pushes to the side no more than the slope of the surface.
inline double surface_fraction(double d_water, double d_air, double least) {
  const double depth = d_water < least ? least : d_water, theta = depth / (depth - d_air);
  return theta > 1.0 ? 1.0 : theta;
}

// Calls f(cell) for a cell and all that touch it, be it at a corner, inside the domain; stops at the first that is
// false.
template <int D, class F>
inline bool all_around(const Grid<D>& g, index c, F&& f) {
  const auto stride = Grid<D>::strides(g.shape);
  const auto i = Grid<D>::unflat(c, g.shape);
  constexpr int neighbours = D == 2 ? 9 : 27;
  for (int q = 0; q < neighbours; ++q) {
    index n = 0;
    bool outside = false;
    for (int a = 0, code = q; a < D; ++a, code /= 3) {
      index j = i[a] + code % 3 - 1;
      if (g.periodic[a]) j = (j + g.shape[a]) % g.shape[a];
      outside = outside || j < 0 || j >= g.shape[a];
      n += j * stride[a];
    }
    if (!outside && !f(n)) return false;
  }
  return true;
}

// True if there is no air in a cell nor in any that touches it, be it at a corner. A closed cell has none.
template <int D>
inline bool without_air(const Grid<D>& g, const std::uint8_t* active, const Listed& open, index c) {
  return all_around(g, c, [=](index n) { return active[n] || open[n] <= 0.0; });
}

// Share of a cell that is the place of one particle: 2^D fill it. A cell that lacks so much has a hole.
template <int D>
constexpr double particle_place = 1.0 / (1 << D);

// True if there is air across a face of a cell.
template <int D>
inline bool air_beside(const Grid<D>& g, const std::uint8_t* active, const Listed& open, index c) {
  const auto stride = Grid<D>::strides(g.shape);
  const auto i = Grid<D>::unflat(c, g.shape);
  for (int a = 0; a < D; ++a)
    for (int side = -1; side <= 1; side += 2) {
      const index j = inside(i[a] + side, g.shape[a], g.periodic[a]), n = c + (j - i[a]) * stride[a];
      if (!active[n] && open[n] > 0.0) return true;
    }
  return false;
}

// ---- rows: the lines of a field along the last axis, its columns of cells or faces ----------------------------------

// First entries of the rows beside row i of a field of that shape: [2b] the one before along axis b, [2b+1] the one
// after; -1 behind a wall.
template <int D>
inline std::array<index, 2 * D - 2> rows_beside(const Grid<D>& g, const std::array<index, D>& i,
                                                const std::array<index, D>& shape) {
  const auto stride = Grid<D>::strides(shape);
  const index here = Grid<D>::flat(i, stride);
  std::array<index, 2 * D - 2> rows;
  for (int b = 0; b < D - 1; ++b)
    for (int s = 0; s < 2; ++s) {
      index j = i[b] + (s ? 1 : -1);
      if (g.periodic[b]) j = (j + g.shape[b]) % g.shape[b];
      rows[2 * b + s] = j < 0 || j >= shape[b] ? -1 : here + (j - i[b]) * stride[b];
    }
  return rows;
}

// One more than the last entry of a row that is not 0: above, there is nothing to do.
inline index top_of(const std::uint8_t* mask, index n) {
  while (n > 0 && !mask[n - 1]) --n;
  return n;
}

}  // namespace houle
