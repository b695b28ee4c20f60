// Places of the new particles: each at the centre of the water that its node was given, as far as it may lie there.
#pragma once

#include <houle/water/nodes.hpp>
#include <houle/water/solids.hpp>

namespace houle {

// The space where particles may be: in the tank, between the walls, in the pores, outside of the solids.
template <int D>
struct Space {
  Grid<D> grid;
  Lattice<D> l;
  Pores<D> pores;
  Solids<D> solids;

  bool in_pores(const double* x) const {
    for (int a = 0; a < D; ++a)
      if (!(x[a] >= 0 && x[a] <= l.h[a] * static_cast<double>(l.shape[a]))) return false;
    return !pores.closed(l, l.half_cell(x));
  }
  bool holds(const double* x) const { return in_pores(x) && !in_solid(grid, solids, x); }
  void move(double* x, double step, const double* way) const {  // x += step * way, around periodic axes
    for (int a = 0; a < D; ++a) {
      x[a] += step * way[a];
      wrap(a, x[a]);
    }
  }
  void wrap(int a, double& x) const {
    const double size = l.h[a] * static_cast<double>(l.shape[a]);
    if (l.periodic[a] && !(x >= 0 && x < size)) x -= size * std::floor(x / size);
  }
};

// Finds the position x of the particle of a node: where its water came from on average, at most a spacing off, never in
// a solid nor beyond a gate. On return its moment is what this takes from V x: zero unless the particle is held back.
template <int D>
inline void place(const Space<D>& space, index node, Gathered<D>& g, double* x) {
  const Lattice<D>& l = space.l;
  const auto at = Grid<D>::unflat(node, l.shape);
  double centre[D], right[D], lies[D];
  for (int a = 0; a < D; ++a) {
    const double offset = g.moment[a] / g.volume;
    centre[a] = (static_cast<double>(at[a]) + 0.5) * l.h[a];
    right[a] = centre[a] + offset;
    x[a] = lies[a] = centre[a] + std::clamp(offset, -l.h[a], l.h[a]);
    space.wrap(a, x[a]);
  }
  if (!space.in_pores(x) || l.parted(centre, lies)) {  // back into the half cell of the node
    constexpr double half = 0.5 - 1e-9;
    for (int a = 0; a < D; ++a)
      x[a] = lies[a] = centre[a] + std::clamp(lies[a] - centre[a], -half * l.h[a], half * l.h[a]);
  }
  double before[D];
  for (int a = 0; a < D; ++a) before[a] = x[a];
  if (in_solid(space.grid, space.solids, x)) {  // round a corner, or in a half cell that the outline cuts
    leave_solids(space.grid, space.solids, l.gates, centre, x);
    bring_into_tank(space.grid, x);
  }
  for (int a = 0; a < D; ++a) g.moment[a] = g.volume * (right[a] - lies[a] + (before[a] - x[a]));
}

// Hands the moment that a held back particle takes to particles around it, which all move by the same fraction of a
// spacing: the nearest that may all go there and are enough.
template <int D>
class MomentTakers {
 public:
  MomentTakers(const Space<D>& space, const Receivers& receivers, const std::vector<std::int32_t>& kept,
               ParticleArrays<D>& particles)
      : space_(space), receivers_(receivers), place_(receivers.count, -1), p_(particles) {
    for (std::size_t i = 0; i < kept.size() && kept[i] < receivers.count; ++i)
      place_[kept[i]] = static_cast<std::int32_t>(i);
  }

  bool take(index r, const double* moment) {
    double size = 0, way[D], least = space_.l.h[0];
    for (int a = 0; a < D; ++a) {
      size += moment[a] * moment[a];
      least = std::min(least, space_.l.h[a]);
    }
    size = std::sqrt(size);
    for (int a = 0; a < D; ++a) way[a] = moment[a] / size;
    for (double most : {0.25, 1.0, 4.0})
      for (index radius = 1; radius <= remesh::far; radius *= 2) {
        find(receivers_.node[r], radius, most * least, way);
        if (shift(size, most * least, way)) return true;
      }
    return false;
  }

 private:
  const Space<D>& space_;
  Receivers receivers_;
  std::vector<std::int32_t> place_, found_;  // number of the particle of each receiver, -1: none; those that may move
  ParticleArrays<D>& p_;

  bool can_go(index i, double step, const double* way) const {
    const double* from = p_.x.data() + i * D;
    double x[D];
    for (int a = 0; a < D; ++a) x[a] = from[a] + step * way[a];
    if (space_.l.parted(from, x)) return false;
    for (int a = 0; a < D; ++a) space_.wrap(a, x[a]);
    return space_.holds(x);
  }
  void find(index node, index radius, double step, const double* way) {
    found_.clear();
    each_near(space_.l, node, radius, [&](index other) {
      const index r = receivers_.number[other], i = r < 0 ? -1 : place_[r];
      if (i >= 0 && in_sight(space_.l, space_.pores, node, other) && can_go(i, step, way))
        found_.push_back(static_cast<std::int32_t>(i));
    });
  }
  bool shift(double size, double most, const double* way) {
    for (;;) {
      double volume = 0;
      for (index i : found_) volume += p_.volume[i];
      if (!(size <= most * volume)) return false;
      const double step = size / volume;
      const auto end = std::remove_if(found_.begin(), found_.end(), [&](index i) { return !can_go(i, step, way); });
      if (end == found_.end()) {
        for (index i : found_) space_.move(p_.x.data() + i * D, step, way);
        return true;
      }
      found_.erase(end, found_.end());
    }
  }
};

}  // namespace houle
