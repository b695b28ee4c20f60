// Columns of varying porosity or with solids: the level at which their water fills their pores.
#pragma once

#include <algorithm>
#include <cmath>

#include <houle/exec/loop.hpp>
#include <houle/grid/grid.hpp>

namespace houle {

// One piece of a column's capacity, which is the water that its pores hold below each height. Below z there are `below`
// cells of water; from there to the next piece, s in [0, 1], the section open to water is a + b s + c s^2 of the plan
// area.
struct CapacityPiece {
  double z;      // [cells]
  double below;  // [cells]
  double a, b, c;
};

// Level [cells] to which `water` [cells] fills the pieces [first, last]; the last one is the end of the column. Never
// outside the column; in a stretch without pores its upper end.
inline double level_of(const CapacityPiece* first, const CapacityPiece* last, double water) {
  const auto* next =
      std::upper_bound(first, last + 1, water, [](double w, const CapacityPiece& p) { return w < p.below; });
  if (next == first) return first->z;
  if (next == last + 1) return last->z;
  const CapacityPiece& p = next[-1];
  const double length = next->z - p.z, target = (water - p.below) / length;
  double low = 0.0, high = 1.0, s = (water - p.below) / (next->below - p.below);
  for (int k = 0; k < 60; ++k) {  // Newton's method, halving the interval where it leaves it
    const double excess = s * (p.a + s * (0.5 * p.b + s * p.c / 3.0)) - target, slope = p.a + s * (p.b + s * p.c);
    (excess > 0.0 ? high : low) = s;
    double better = s - excess / slope;
    if (!(better >= low && better <= high)) better = 0.5 * (low + high);
    const double change = std::abs(better - s);
    s = better;
    if (change <= 1e-15) break;
  }
  return p.z + s * length;
}

// Finds the level of the water in all columns of cells, level (columns) [m].
//
// A uniform column is filled to height / porosity: height (columns) [m] from column_heights(), porosity (columns) [-].
//
// A listed column is filled to the level up to which its pieces hold its water. The water is summed over its cells:
// fill (cells), the share of its capacity that a cell holds, over inverse_capacity (cells), 1 / the water in its tent
// when all pores are full [1/m^D], 0 in solids. The sum is the water in the column's horizontal tent. Cells more than
// two below the surface count as full: where the porosity changes, particles crowd there by a few percent, which is no
// rise of the level. column (count,): numbers of the listed columns; column[i] has the pieces start[i] to
// start[i + 1] - 1.
template <int D>
void column_levels(const Grid<D>& g, const double* height, const double* porosity, const double* fill,
                   const double* inverse_capacity, index count, const std::int64_t* column, const std::int64_t* start,
                   const CapacityPiece* pieces, double* level) {
  const index nz = g.shape[D - 1];
  const double hz = g.h[D - 1], cell = g.cell_volume();
  parallel_for(g.cells() / nz, [=](index c) { level[c] = height[c] / porosity[c]; });
  parallel_for(
      count,
      [=](index i) {
        const double *F = fill + column[i] * nz, *inverse = inverse_capacity + column[i] * nz;
        index top = 0;  // first cell less than half full
        while (top < nz && (inverse[top] <= 0.0 || F[top] >= 0.5)) ++top;
        double water = 0.0;
        for (index k = 0; k < nz; ++k)
          if (inverse[k] > 0.0) water += (k + 2 < top ? 1.0 : F[k]) / inverse[k];
        level[column[i]] = hz * level_of(pieces + start[i], pieces + start[i + 1] - 1, water / cell);
      },
      16);
}

}  // namespace houle
