// Nodes that hold hardly anything, or less than nothing, are merged with others in sight.
#pragma once

#include <houle/exec/scan.hpp>
#include <houle/water/nodes.hpp>

namespace houle {

// The fullest node but `node` itself, within `radius` nodes and in its sight, for which may(what it holds) is true; -1:
// none.
template <int D, class May>
inline index fullest_neighbour(const Lattice<D>& l, const Pores<D>& pores, index node, index radius,
                               const std::int32_t* number, const Gathered<D>* nodes, May may) {
  index best = -1;
  double most = 0;
  each_near(l, node, radius, [&](index other) {
    if (number[other] < 0 || other == node) return;
    const Gathered<D>& g = nodes[number[other]];
    if (!(g.bulk > most && may(g)) || !in_sight(l, pores, node, other)) return;
    most = g.bulk;
    best = other;
  });
  return best;
}

// Hands all that `given` at node `from` has to `taken` at node `onto`: its water stays centred where it was.
template <int D>
inline void hand_over(const Lattice<D>& l, index from, index onto, Gathered<D>& given, Gathered<D>& taken) {
  const auto way = l.way(onto, from);
  for (int a = 0; a < D; ++a) given.moment[a] += given.volume * static_cast<double>(way[a]) * l.h[a];
  taken.take(1, given);
  given = {};  // so that nobody hands anything to it any more
}

// Lets the fullest node in sight that has more than four times the debt of node r pay it off, however far it is.
// Returns false if there is none. Rare, so one node after the other. The volume can be in debt where the bulk is not,
// if the porosity changes.
template <int D>
inline bool repay(const Lattice<D>& l, const Pores<D>& pores, const Receivers& receivers, index r, Gathered<D>* nodes) {
  const std::int32_t* number = receivers.number;
  const double debt = 4 * std::max(std::abs(nodes[r].bulk), std::abs(nodes[r].volume));
  const auto rich = [=](const Gathered<D>& g) { return g.bulk > debt && g.volume > debt; };
  for (index radius = 2; radius <= remesh::far; radius *= 2) {
    const index to = fullest_neighbour(l, pores, receivers.node[r], radius, number, nodes, rich);
    if (to < 0) continue;
    hand_over(l, receivers.node[r], to, nodes[r], nodes[number[to]]);
    return true;
  }
  return false;
}

// Pays off a debt that no single node can: the nearest nodes give the debtor all they have, until it owns three times
// what it owed. The water of a drop or a tip then ends in one particle, if need be.
template <int D>
inline void collect(const Lattice<D>& l, const Pores<D>& pores, const Receivers& receivers, index r,
                    Gathered<D>* nodes) {
  const std::int32_t *number = receivers.number, *node = receivers.node;
  const double volume = std::max(0.0, -3 * nodes[r].volume), bulk = std::max(0.0, -3 * nodes[r].bulk);
  for (index radius = 1; radius <= remesh::far;) {
    if (nodes[r].sound() && nodes[r].volume >= volume && nodes[r].bulk >= bulk) return;
    const index from =
        fullest_neighbour(l, pores, node[r], radius, number, nodes, [](const Gathered<D>&) { return true; });
    if (from >= 0)
      hand_over(l, from, node[r], nodes[number[from]], nodes[r]);
    else
      radius *= 2;
  }
}

// Nodes that hold less than `keep` of a half cell, or less than nothing, give it all away to a neighbour that holds
// more; a little water with no neighbour to go to stays. A node that has given has nothing, and is given nothing.
template <int D>
inline void merge_small(const Lattice<D>& l, const Pores<D>& pores, const Receivers& receivers, Gathered<D>* nodes) {
  const index count = receivers.count;
  const std::int32_t *number = receivers.number, *node = receivers.node;
  const double enough = remesh::keep * l.volume;
  const auto holds = [=](const Gathered<D>& g) { return g.bulk > enough; };
  std::vector<std::int32_t> target(count);
  std::int32_t* to = target.data();
  for (bool all = false; !all;) {  // a debt can leave the node that pays it with little
    parallel_for(count, [=](index r) {
      to[r] = -1;
      if (nodes[r].bulk >= enough || nodes[r].nothing()) return;
      for (int radius = 1; radius <= 3 && to[r] < 0; ++radius)
        to[r] = static_cast<std::int32_t>(fullest_neighbour(l, pores, node[r], radius, number, nodes, holds));
    });
    const auto small = parallel_where(count, [=](index r) { return to[r] >= 0; });
    for (index r : small) hand_over(l, node[r], to[r], nodes[r], nodes[number[to[r]]]);
    all = small.empty();
  }
  for (index r : parallel_where(count, [=](index r) { return !nodes[r].sound() && !nodes[r].nothing(); }))
    if (!nodes[r].sound() && !nodes[r].nothing() && !repay(l, pores, receivers, r, nodes))
      collect(l, pores, receivers, r, nodes);
}

}  // namespace houle
