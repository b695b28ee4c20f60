// How much water columns of cells hold, as the surface shows it.
#pragma once

#include "surface.hpp"

namespace houle {

// Water [m^D] in the tents of the cells of the listed columns.
//
// A cell without air all around it is full, however the particles lie in it. One beside air holds what its fill says:
// less than all of it is the surface there, of which the fill is exact where it is flat, whatever its slope. So do
// cells outside of the surface: sheets and drops too thin to have a surface are water. And so are bubbles too small to
// have one air: without air, but without the place of a particle, 2^-D of the fill, or more. The cells that touch such
// a one share it in their fills.
template <int D>
inline void water_held(const Grid<D>& g, const std::uint8_t* active, const Listed& open, const double* fill,
                       const double* inverse_capacity, index count, const std::int64_t* column, double* held) {
  constexpr double least = 1.0 - 1.0 / (1 << D);
  const index nz = g.shape[D - 1];
  parallel_for(
      count,
      [=](index n) {
        held[n] = 0.0;
        for (index c = column[n] * nz; c < (column[n] + 1) * nz; ++c) {
          if (inverse_capacity[c] <= 0.0) continue;
          const bool full = active[c] && without_air(g, active, open, c) && all_around(g, c, [=](index b) {
                              return fill[b] >= least || open[b] <= 0.0 || !without_air(g, active, open, b);
                            });
          held[n] += (full ? 1.0 : std::min(fill[c], 1.0)) / inverse_capacity[c];
        }
      },
      16);
}

}  // namespace houle
