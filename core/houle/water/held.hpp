// Water that columns of cells hold, as the surface shows it.
#pragma once

#include <houle/water/surface.hpp>

namespace houle {

// True at a bubble too small to have a surface: under the surface, with no air around, cell c and all around it
// together lack the place of a particle or more, and so does c alone. Disorder, which thins one cell and crowds the
// next, cancels in this sum, and the tents of all cells that touch make up for what a bubble takes from one of them.
template <int D>
inline bool is_bubble(const Grid<D>& g, const std::uint8_t* active, const Listed& open, const double* fill,
                      const double* inverse_capacity, index c) {
  if (open[c] <= 0.0 || fill[c] >= 1.0 - particle_place<D> || !without_air(g, active, open, c)) return false;
  double missing = 0.0;
  all_around(g, c, [&](index b) {
    if (inverse_capacity[b] > 0.0) missing += (1.0 - fill[b]) / inverse_capacity[b];
    return true;
  });
  return missing * inverse_capacity[c] >= particle_place<D>;
}

// Water [m^D] in the listed columns of cells: what stands in them by `height` (columns) [m] of column_heights, so that
// each particle counts once beside the columns whose level this is, and what their cells show more or less of than they
// hold.
//
// A cell without air around it, and at no bubble, is full, however the particles lie in it: one closed by a solid as
// well, whose tent reaches into the water. All others show what their fill says: it is exact where the surface is flat,
// whatever its slope; sheets and drops too thin to have a surface are water; and the cells that touch a bubble share it
// in their fills. Where air is across a face the surface shows no more than a full cell. Where it is only at an edge or
// a corner a flat surface leaves next to nothing empty, and the fill is above and below one for the disorder of the
// particles: both count.
template <int D>
void water_held(const Grid<D>& g, const std::uint8_t* active, const Listed& open, const double* fill,
                const double* inverse_capacity, const double* height, index count, const std::int64_t* column,
                double* held) {
  const index nz = g.shape[D - 1];
  const double area = g.cell_volume() / g.h[D - 1];
  const auto shown = [=](index c) {
    if (!active[c] && open[c] > 0.0) return fill[c];
    if (without_air(g, active, open, c)) {
      const auto whole = [=](index b) { return !is_bubble(g, active, open, fill, inverse_capacity, b); };
      return all_around(g, c, whole) ? 1.0 : fill[c];
    }
    return active[c] && air_beside(g, active, open, c) ? std::min(fill[c], 1.0) : fill[c];
  };
  parallel_for(
      count,
      [=](index n) {
        held[n] = area * height[column[n]];
        for (index c = column[n] * nz; c < (column[n] + 1) * nz; ++c)
          if (inverse_capacity[c] > 0.0) held[n] += (shown(c) - fill[c]) / inverse_capacity[c];
      },
      16);
}

}  // namespace houle
