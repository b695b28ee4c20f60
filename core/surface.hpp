// Where the water is: fill fraction of the cells, the free surface cutting the grid, cells the pressure lives in.
#pragma once

#include <limits>

#include "transfer.hpp"

namespace houle {

// Signed distance, in cells, from a cell's centre up to a flat surface whose tent-smoothed fill is F: the exact inverse
// of F(d) = 1 - (1-d)^2/2 (0 <= d <= 1), (1+d)^2/2 (-1 <= d < 0). Positive: the centre is under water.
inline double depth_from_fill(double F) {
  if (F >= 1.0) return 1.0;
  if (F >= 0.5) return 1.0 - std::sqrt(2.0 * (1.0 - F));
  if (F > 0.0) return -1.0 + std::sqrt(2.0 * F);
  return -1.0;
}

// Height of water standing in each column of cells, sum_p (V/n)_p B(x_p - x_c) / (plan area of a cell) [m], with the
// quadratic B-spline B in the horizontal: its derivative, with which the flux between columns is taken, is the tent that
// the position correction keeps full, so that the count of particles in a column adds no noise. Walls fold.
template <int D>
inline void column_heights(const Grid<D>& g, const std::int64_t* start, const double* x, const double* bulk,
                           double* height) {
  const index nz = g.shape[D - 1], columns = g.cells() / nz;
  const double area = g.cell_volume() / g.h[D - 1];
  std::array<index, D> shape = g.shape;
  shape[D - 1] = 1;
  const auto stride = Grid<D>::strides(shape);
  parallel_for(columns, [=](index c) { height[c] = 0.0; });
  each_slab(g, start, [=](index begin, index end) {
    for (index p = begin; p < end; ++p) {
      Stencil<QuadraticKernel, D> st;
      st.set(g, -1, x + D * p, 0.0);
      const double v = bulk[p] / area;
      if constexpr (D == 2) {
        for (int i = 0; i < 3; ++i) height[st.node[0][i]] += st.weight[0][i] * v;
      } else {
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            height[st.node[0][i] * stride[0] + st.node[1][j]] += st.weight[0][i] * st.weight[1][j] * v;
      }
    }
  });
}

// From the fill fraction of every cell: depth (cells), active (cells) and the free surface of every column.
//
// Where a column is single-valued (full below, empty above) and no steeper than 45 degrees, its surface lies where the
// water of the whole column fills it: exact for the volume, and it answers a rise of any size, however small beside the
// cell, which the fill of single cells does not (docs/decisions/0001). Elsewhere the depth comes from each cell's fill.
// height: of column_heights; it counts only where porosity and openness are the same all around (`uniform`, columns).
// Other columns add up their fill, which is exact at rest across any interface.
// open (cells): 0 marks cells closed by solids. column, eta (grid.shape[:-1]): work space; level of the surface above
// z = 0 [m], NaN where dry.
template <int D>
inline void find_surface(const Grid<D>& g, const double* fill, const double* open, const double* height,
                         const std::uint8_t* uniform, bool use_columns, double* depth, std::uint8_t* active, double* column, double* eta) {
  const index nz = g.shape[D - 1], columns = g.cells() / nz;
  const double hz = g.h[D - 1];
  // height of the water in a single-valued column, in cells; NaN where there is no such thing
  parallel_for(
      columns,
      [=](index c) {
        const double *F = fill + c * nz, *o = open + c * nz;
        index bed = 0, k = 0;
        double floor = 0.0;  // height of the solid ground, in cells
        while (bed < nz && o[bed] < 1.0 && (bed == 0 || o[bed] >= o[bed - 1])) floor += 1.0 - o[bed], ++bed;
        while (k < nz && (o[k] <= 0.0 || F[k] >= 0.5)) ++k;
        const index top = k;  // first cell less than half full
        bool single = top > 0 || (F[0] > 0.0 && (nz < 3 || F[2] < 1e-3));
        for (index j = bed; j < nz && single; ++j)
          single = o[j] >= 1.0 && (j + 2 < top ? F[j] > 0.8 : (j > top + 1 ? F[j] < 1e-3 : true));
        double water = height[c] / hz;
        if (!uniform[c]) {
          water = 0.0;
          for (index j = 0; j < nz; ++j) water += o[j] * F[j];
        }
        column[c] = single && use_columns ? floor + water : std::numeric_limits<double>::quiet_NaN();
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
            if (!(std::abs(other - column[c]) * hz <= g.h[a])) gentle = false;
          }
        const double *F = fill + c * nz, *o = open + c * nz;
        index top = -1, holes = 0;
        for (index k = 0; k < nz; ++k) {
          const double d = gentle ? column[c] - (k + 0.5) : depth_from_fill(F[k]);
          depth[c * nz + k] = d;
          const bool wet = d >= 0.0 && o[k] > 0.0;
          active[c * nz + k] = wet;
          if (wet && holes <= 2) top = k, holes = 0;
          if (!wet && o[k] > 0.0 && top >= 0) ++holes;  // trapped air of two cells at most is looked through
        }
        if (gentle) {
          eta[c] = column[c] > 1e-6 ? column[c] * hz : std::numeric_limits<double>::quiet_NaN();
        } else if (top >= 0) {
          const double d = depth[c * nz + top], above = top + 1 < nz ? depth[c * nz + top + 1] : -1.0;
          eta[c] = (top + 0.5 + d / (d - std::min(above, 0.0) + 1e-300)) * hz;
        } else {  // a film thinner than half a cell, or nothing
          double height = 0.0;
          for (index k = 0; k < std::min<index>(nz, 2); ++k) height += F[k];
          eta[c] = height > 1e-6 ? height * hz : std::numeric_limits<double>::quiet_NaN();
        }
      },
      64);
}

// The place of the surface between an active cell and its air neighbour, in cells from the active centre. Below
// `least` the pressure of the cell is as good as zero; the limit bounds the coefficient (ghost fluid, Gibou 2002).
inline double surface_fraction(double d_water, double d_air, double least) {
  const double theta = d_water / (d_water - d_air);
  return theta < least ? least : (theta > 1.0 ? 1.0 : theta);
}

// Calls visit(face, low cell or -1, high cell or -1) for every face of axis a; a periodic axis gives each face twice.
template <int D, class Visit>
inline void each_face(const Grid<D>& g, int a, Visit visit) {
  const auto face_shape = g.face_shape(a);
  const auto stride = Grid<D>::strides(g.shape);
  const index rows = g.faces(a) / face_shape[D - 1], line = face_shape[D - 1];
  const bool periodic = g.periodic[a];
  std::array<index, D> row_shape = face_shape;
  row_shape[D - 1] = 1;
  parallel_for(
      rows,
      [=](index r) {
        auto i = Grid<D>::unflat(r, row_shape);
        const index n = g.shape[a];
        if (a == D - 1) {
          const index base = Grid<D>::flat(i, stride);
          for (index k = 0; k < line; ++k) {
            index low = k - 1, high = k;
            if (periodic) low = (low + n) % n, high = high % n;
            visit(r * line + k, low >= 0 ? base + low : -1, high < n ? base + high : -1);
          }
        } else {
          index low = i[a] - 1, high = i[a];
          if (periodic) low = (low + n) % n, high = high % n;
          auto j = i;
          j[a] = low;
          const index low_base = low >= 0 ? Grid<D>::flat(j, stride) : -1;
          j[a] = high;
          const index high_base = high < n ? Grid<D>::flat(j, stride) : -1;
          for (index k = 0; k < line; ++k)
            visit(r * line + k, low_base >= 0 ? low_base + k : -1, high_base >= 0 ? high_base + k : -1);
        }
      },
      16);
}

}  // namespace houle
