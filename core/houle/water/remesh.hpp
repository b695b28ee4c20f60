// Remeshing: particles give their water to the nodes of a regular lattice (lattice.hpp), two per cell and axis.
//
// The weights are the tensor product of Monaghan's M4' (the paper's eq. (7)): they sum to 1 and their first and second
// moments are exact, so in full water the new particles sit on the nodes and volume, momentum V u_d, first and second
// moments of volume are those of the old ones. A particle that does not see all its nodes (free surface,
// solid) gives to those it sees, one beside a porous interface more to where there is more room; in front of a wall, to
// the mirror images of those behind. There the centre of what it gives is not where it was: it hands on the difference
// with its volume, and this moves the receiving particles off their nodes by a fraction of the spacing. Nodes left
// nearly empty, or in debt by the negative lobes of M4', are merged with a neighbour. What a solid or a wall holds
// back, those around give back. So volume, momentum and centre of volume are conserved everywhere, and with them the
// potential energy.
#pragma once

#include <houle/exec/scan.hpp>
#include <houle/water/merging.hpp>
#include <houle/water/placing.hpp>

namespace houle {

// The nodes to which a particle beside an interface gives its momentum along the interface: those of its own side.
template <int D>
struct Aside {
  const Interface<D>* at = nullptr;  // null: far from any
  bool parallel = false;             // to the grid: the nodes across are replaced by their mirror images
  LatticeStencil<D> nodes;

  Aside(const Lattice<D>& l, const Pores<D>& pores, const LatticeStencil<D>& s, const double* x)
      : at(pores.near(l, x)), nodes(s) {
    if (at) parallel = nodes.mirror(l, *at, x);
  }
  bool has(const double* x, const int* k) const {  // true if node k, one place per axis, lies on the side of x
    double node[D];
    for (int a = 0; a < D; ++a) node[a] = x[a] + nodes.reach[a][k[a]];
    return parallel || at->beyond(node) == at->beyond(x);
  }
};

// The nodes that a particle can give to: those around it that a chain of open half cells, all of them among these
// nodes, joins with its own. So nothing is given through a plate, nor past the corner of one. The nodes are a set of
// bits, one for each place on the axes, the last axis first.
template <int D>
struct Joined {
  static constexpr std::uint64_t everywhere = ~std::uint64_t{0} >> (64 - (1 << 2 * D));
  std::uint64_t places = 0;

  Joined(const Lattice<D>& l, const Pores<D>& pores, const LatticeStencil<D>& s, index home) {
    if (!pores.solid) {
      places = everywhere;
      return;
    }
    std::uint64_t open = 0, ends[2][D] = {};  // ends: the first and the last place on each axis
    s.each([&](index node, double, const int* k) {
      if (!pores.closed(l, node)) open |= bit(k);
      if (node == home) places |= bit(k);  // its mirror images, and what repeats it, too
      for (int a = 0; a < D; ++a)
        if (k[a] == 0 || k[a] == 3) ends[k[a] / 3][a] |= bit(k);
    });
    if (open == everywhere) {
      places = open;
      return;
    }
    for (std::uint64_t before = 0; before != places;) {
      before = places;
      for (int a = 0; a < D; ++a) {
        const int step = 1 << 2 * (D - 1 - a);
        places |= open & ((before & ~ends[1][a]) << step | (before & ~ends[0][a]) >> step);
      }
    }
  }
  bool has(const int* k) const { return (places & bit(k)) != 0; }
  static std::uint64_t bit(const int* k) {
    int place = 0;
    for (int a = 0; a < D; ++a) place = 4 * place + k[a];
    return std::uint64_t{1} << place;
  }
};

// Takes the momentum along the interface out of what a particle at x has to give, and gives it to the nodes of its own
// side. If hardly any of those receive, it stays with the rest. joined: the nodes of `aside` that the particle can give
// to. capacity(node): the weight with which a node receives, its porosity.
template <int D, class Capacity>
inline void give_along(const Receivers& receivers, const Aside<D>& aside, const Joined<D>& joined, const double* x,
                       Gathered<D>& g, Capacity capacity, Gathered<D>* nodes) {
  const std::int32_t* number = receivers.number;
  const auto sees = [&](index node, const int* k) { return number[node] >= 0 && joined.has(k); };
  double sum = 0, all = 0;
  aside.nodes.each([&](index node, double w, const int* k) {
    if (!sees(node, k)) return;
    all += std::abs(w) * capacity(node);
    if (aside.has(x, k)) sum += w * capacity(node);
  });
  if (!(sum > remesh::weigh * all)) return;
  double along[D];
  for (int a = 0; a < D; ++a) {
    along[a] = aside.at->across(a) ? 0.0 : g.momentum[a];
    g.momentum[a] -= along[a];
  }
  aside.nodes.each([&](index node, double w, const int* k) {
    if (!sees(node, k) || !aside.has(x, k)) return;
    for (int a = 0; a < D; ++a) nodes[number[node]].momentum[a] += w * capacity(node) / sum * along[a];
  });
}

// Gives particle i to the receivers around it; false where none is near (spray): the particle then stays as it is. If
// the porosity varies among them, they receive in proportion to it, M4'_i n_i / sum_j M4'_j n_j: full pores stay full.
// If porosities differ so much that the negative lobes of M4' outweigh the rest, the nearest node gets all.
template <int D>
inline bool give(const Lattice<D>& l, const Pores<D>& pores, const Receivers& receivers, const ParticleView<D>& p,
                 index i, Gathered<D>* nodes) {
  const double* x = p.x + i * D;
  const index home = l.half_cell(x);
  if (pores.closed(l, home)) return false;
  const LatticeStencil<D> s(l, x);
  Gathered<D> g(p, i);

  const std::int32_t* number = receivers.number;
  const double* porosity = receivers.porosity;
  const auto receives = [=](index node) { return number[node] >= 0; };
  const auto capacity = [=](index node) { return porosity ? porosity[number[node]] : 1.0; };
  const double own = receives(home) ? capacity(home) : pores.porosity(l, home);
  bool all = true;
  const Aside<D> aside(l, pores, s, x);
  s.each([&](index node, double, const int*) { all = all && receives(node) && capacity(node) == own; });
  if (all && !aside.at) {
    for (int a = 0; a < D; ++a)
      for (int k = 0; k < 4; ++k) g.moment[a] -= g.volume * s.w[a][k] * s.reach[a][k];
    s.each([=](index node, double w, const int*) { nodes[number[node]].take(w, g); });
    return true;
  }

  const Joined<D> joined(l, pores, s, home);
  const auto sees = [=](index node, const int* k) { return receives(node) && joined.has(k); };
  double sum = 0, seen = 0, centre[D] = {}, nearest = 1;
  index nearest_node = -1;
  int nearest_k[D];
  s.each([&](index node, double w, const int* k) {
    if (!sees(node, k)) return;
    seen += w;
    w *= capacity(node);
    sum += w;
    double distance = 0;  // squared, in lattice spacings
    for (int a = 0; a < D; ++a) {
      const double r = s.reach[a][k[a]];
      centre[a] += w * r;
      distance += r * r / (l.h[a] * l.h[a]);
    }
    if (distance >= nearest) return;
    nearest = distance;
    nearest_node = node;
    for (int a = 0; a < D; ++a) nearest_k[a] = k[a];
  });
  if (seen > remesh::see && sum > remesh::weigh * seen * own) {
    for (int a = 0; a < D; ++a) g.moment[a] = -g.volume * centre[a] / sum;
    if (aside.at && pores.along) {
      const Joined<D> own_side(l, pores, aside.nodes, home);
      give_along(receivers, aside, own_side, x, g, capacity, nodes);
    }
    s.each([=](index node, double w, const int* k) {
      if (sees(node, k)) nodes[number[node]].take(w * capacity(node) / sum, g);
    });
    return true;
  }
  if (nearest_node < 0) return false;
  for (int a = 0; a < D; ++a) g.moment[a] = -g.volume * s.reach[a][nearest_k[a]];
  nodes[number[nearest_node]].take(1, g);
  return true;
}

// The water after it was shared out: what the nodes were given, and which old particles gave nothing.
template <int D>
struct Shared {
  ReceiverTables tables;
  std::vector<Gathered<D>> gathered;  // by each receiver
  std::vector<std::int32_t> from;     // source of each new particle: its receiver, or count + the number of an old one
};

// Shares the water out to the nodes. stayed (n,): on entry 1 for particles that must give nothing; on return 1 for all
// that gave nothing.
template <int D>
inline Shared<D> share_out(const Lattice<D>& l, const Pores<D>& pores, const ParticleView<D>& p,
                           std::vector<unsigned char>& stayed) {
  const Slabs<D> slabs(l, p.n, p.x);
  unsigned char* stays = stayed.data();
  Shared<D> shared{ReceiverTables(l, node_fill(l, slabs, p, stays), &pores, remesh::receive), {}, {}};
  const Receivers receivers = shared.tables.all();
  const index count = receivers.count;
  shared.gathered.resize(count);
  Gathered<D>* nodes = shared.gathered.data();
  slabs.scatter([=](index i) { stays[i] = stays[i] || !give(l, pores, receivers, p, i, nodes); });
  merge_small(l, pores, receivers, nodes);
  shared.from = parallel_where(count, [=](index r) { return !nodes[r].nothing(); });
  for (index i : parallel_where(p.n, [=](index i) { return stays[i] != 0; }))
    shared.from.push_back(static_cast<std::int32_t>(count + i));
  return shared;
}

// The new particles: those of the nodes, each where it may lie, then the old ones that gave nothing.
template <int D>
inline ParticleArrays<D> placed(const Space<D>& space, Shared<D>& shared, const ParticleView<D>& p) {
  const Receivers receivers = shared.tables.all();
  const index size = static_cast<index>(shared.from.size()), count = receivers.count;
  ParticleArrays<D> out(size);
  const std::int32_t *source = shared.from.data(), *node = receivers.node;
  Gathered<D>* nodes = shared.gathered.data();
  double *x = out.x.data(), *u = out.u.data(), *volume = out.volume.data();
  parallel_for(size, [=](index i) {
    const index r = source[i], old = r - count;
    volume[i] = r < count ? nodes[r].volume : p.volume[old];
    if (r < count) place(space, node[r], nodes[r], x + i * D);
    for (int a = 0; a < D; ++a) {
      if (r >= count) x[i * D + a] = p.x[old * D + a];
      u[i * D + a] = r < count ? nodes[r].momentum[a] / nodes[r].volume : p.u[old * D + a];
    }
  });
  return out;
}

// Gives the moments that held back particles take to the particles around them. Returns the nodes whose particle is in
// debt, or has a moment that nobody can take.
template <int D>
inline std::vector<index> give_back(const Space<D>& space, const Shared<D>& shared, ParticleArrays<D>& out) {
  const Receivers receivers = shared.tables.all();
  const index size = static_cast<index>(shared.from.size()), count = receivers.count;
  const std::int32_t* source = shared.from.data();
  const Gathered<D>* nodes = shared.gathered.data();
  const auto held_back = parallel_where(size, [=](index i) {
    if (source[i] >= count) return false;
    const Gathered<D>& g = nodes[source[i]];
    double sum = 0;
    for (int a = 0; a < D; ++a) sum += std::abs(g.moment[a]);
    return !(g.sound() && sum == 0);
  });
  std::vector<index> open;
  if (held_back.empty()) return open;
  MomentTakers<D> takers(space, receivers, shared.from, out);
  for (index i : held_back) {
    const Gathered<D>& g = nodes[source[i]];
    if (!(g.sound() && takers.take(source[i], g.moment))) open.push_back(receivers.node[source[i]]);
  }
  return open;
}

// Marks the particles within `radius` nodes of one of the nodes: they are to stay as they are.
template <int D>
inline void leave_as_they_are(const Lattice<D>& l, const std::vector<index>& nodes, index radius,
                              const ParticleView<D>& p, std::vector<unsigned char>& stayed) {
  std::vector<unsigned char> near(static_cast<std::size_t>(l.nodes()), 0);
  for (index node : nodes) each_near(l, node, radius, [&](index other) { near[other] = 1; });
  const unsigned char* marked = near.data();
  unsigned char* stays = stayed.data();
  parallel_for(p.n, [=](index i) { stays[i] = stays[i] || marked[l.half_cell(p.x + i * D)]; });
}

// The remeshed particles: those of the nodes in memory order, then the old ones that gave nothing, in their order.
// Conserves sum V, sum V u_d and sum V x to round-off: water of which no particles can be made so, a drop around the
// corner of a solid, is left as it is. No water, and no moment, is handed across a gate. first, last: nodes along the
// first axis between which the water is; walls stand at both ends.
template <int D>
ParticleArrays<D> remesh_conservative(const Grid<D>& grid, const Pores<D>& pores, const Solids<D>& solids,
                                      const Gates& gates, const ParticleView<D>& p, index first, index last) {
  const Lattice<D> l(grid, gates, first, last);
  const Space<D> space{grid, l, pores, solids};
  const index all = *std::max_element(l.shape.begin(), l.shape.end());
  std::vector<unsigned char> stayed(p.n, 0);
  for (index radius = 4;; radius *= 2) {
    Shared<D> shared = share_out(l, pores, p, stayed);
    ParticleArrays<D> out = placed(space, shared, p);
    const std::vector<index> open = give_back(space, shared, out);
    if (open.empty() || radius > 2 * all) return out;
    leave_as_they_are(l, open, radius, p, stayed);
  }
}

// The paper's remeshing, eqs (6)-(7) with V_j inside the sum and tensor weights: a full particle, V = n h^D, on every
// node whose fill exceeds the threshold, at the velocity sum V u M4' / sum V M4'. It heeds gates but no solids. Water
// is not conserved: each time, the surface rises to the outermost node that any particle reaches.
template <int D>
ParticleArrays<D> remesh_paper(const Grid<D>& grid, const Gates& gates, const ParticleView<D>& p, double threshold) {
  const Lattice<D> l(grid, gates);
  const Slabs<D> slabs(l, p.n, p.x);
  const Pores<D>* none = nullptr;
  const ReceiverTables tables(l, node_fill(l, slabs, p), none, threshold);
  const Receivers receivers = tables.all();
  std::vector<Gathered<D>> gathered(receivers.count);
  const std::int32_t* number = receivers.number;
  Gathered<D>* nodes = gathered.data();
  slabs.scatter([=](index i) {
    const Gathered<D> g(p, i);
    LatticeStencil<D>(l, p.x + i * D).each([=](index node, double w, const int*) {
      if (number[node] >= 0) nodes[number[node]].take(w, g);
    });
  });
  double least = 1.0;  // porosity: a mean with weights of both signs is clamped to the values there are
  for (index i = 0; p.porosity && i < p.n; ++i) least = std::min(least, p.porosity[i]);
  ParticleArrays<D> out(receivers.count);
  const std::int32_t* node = receivers.node;
  double *x = out.x.data(), *u = out.u.data(), *volume = out.volume.data();
  parallel_for(receivers.count, [=](index r) {
    const auto at = Grid<D>::unflat(node[r], l.shape);
    volume[r] = std::clamp(nodes[r].volume / nodes[r].bulk, least, 1.0) * l.volume;
    for (int a = 0; a < D; ++a) {
      x[r * D + a] = (static_cast<double>(at[a]) + 0.5) * l.h[a];
      u[r * D + a] = nodes[r].momentum[a] / nodes[r].volume;
    }
  });
  return out;
}

}  // namespace houle
