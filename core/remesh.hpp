// Remeshing: particles give their water to the nodes of a regular lattice (lattice.hpp), two per cell and axis.
//
// The weights are the tensor product of Monaghan's M4' (the paper's eq. (7)): they sum to 1 and their first and second
// moments are exact, so in full water the new particles sit on the nodes and volume, momentum V u_d, first and second
// moments of volume are those of the old ones. A particle that does not see all its nodes (free surface,
// solid) gives to those it sees, one beside a porous interface more to where there is more room; in front of a wall, to
// the mirror images of those behind. There the centre of what it gives is not where it was: it hands on the difference
// with its volume, and this moves the receiving particles off their nodes by a fraction of the spacing. So volume,
// momentum and centre of volume are conserved everywhere, and with them the potential energy. Nodes left nearly empty
// are merged with a neighbour.
#pragma once

#include "lattice.hpp"

namespace houle {

template <int D>
struct ParticleView {
  index n;
  const double *x, *u, *volume, *porosity;  // (n, D), (n, D), (n,), (n,) or null: 1
  double bulk(index i) const { return porosity ? volume[i] / porosity[i] : volume[i]; }
};

template <int D>
struct Pores {              // of the half cells
  Listed cells;             // porosity at the cell centres, between which it is linear; null: 1
  const std::int8_t* body;  // of each half cell: negative in solids

  bool closed(const Lattice<D>& l, index node) const {  // in a solid, or not between the walls
    return body[node] < 0 || node < l.begin * l.stride[0] || node >= l.end * l.stride[0];
  }
  double porosity(const Lattice<D>& l, index node) const {
    if (!cells) return 1.0;
    const auto at = Grid<D>::unflat(node, l.shape);
    std::array<index, D> near[2], n;  // cells along each axis: the one around the node, the next one on its side
    for (int a = 0; a < D; ++a) {
      n[a] = l.shape[a] / 2;
      near[0][a] = at[a] / 2;
      near[1][a] = inside(near[0][a] + (at[a] % 2 ? 1 : -1), n[a], l.periodic[a]);
    }
    const auto stride = Grid<D>::strides(n);
    double value[1 << D];
    for (int corner = 0; corner < (1 << D); ++corner) {
      index c = 0;
      for (int a = 0; a < D; ++a) c += near[corner >> a & 1][a] * stride[a];
      value[corner] = cells[c];
    }
    for (int width = (1 << D) / 2; width > 0; width /= 2)  // exact where all are equal
      for (int i = 0; i < width; ++i) value[i] += 0.25 * (value[i + width] - value[i]);
    return value[0];
  }
};

template <int D>
struct ParticleArrays {
  std::vector<double> x, u, volume;
  explicit ParticleArrays(index n) : x(n * D), u(n * D), volume(n) {}
};

// Bulk volume that reaches each node, as a fraction of its half cell: sum_p (V/n) M4' / h^D
template <int D>
inline std::vector<double> node_fill(const Lattice<D>& l, const Slabs<D>& slabs, const ParticleView<D>& p) {
  std::vector<double> fill(static_cast<std::size_t>(l.nodes()), 0.0);
  double* f = fill.data();
  slabs.scatter([=, &l](index i) {
    const double bulk = p.bulk(i) / l.volume;
    LatticeStencil<D>(l, p.x + i * D).each([=](index node, double w, const int*) { f[node] += w * bulk; });
  });
  return fill;
}

template <int D>
struct Receivers {  // the nodes that may hold a particle, in memory order; number[node] is -1 for the others
  std::vector<std::int32_t> number, node;
  std::vector<double> porosity;  // of their half cells; empty: 1

  Receivers(const Lattice<D>& l, const std::vector<double>& fill, const Pores<D>* pores, double threshold)
      : number(fill.size()) {
    const double* f = fill.data();
    node = parallel_where(l.nodes(), [=, &l](index i) { return f[i] >= threshold && !(pores && pores->closed(l, i)); });
    if (pores && pores->cells) porosity.resize(node.size());
    std::int32_t* numbers = number.data();
    const std::int32_t* nodes = node.data();
    double* room = porosity.empty() ? nullptr : porosity.data();
    parallel_for(l.nodes(), [=](index i) { numbers[i] = -1; });
    parallel_for(count(), [=, &l](index r) {
      numbers[nodes[r]] = static_cast<std::int32_t>(r);
      if (room) room[r] = pores->porosity(l, nodes[r]);
    });
  }
  index count() const { return static_cast<index>(node.size()); }
};

template <int D>
struct Gathered {               // what a node was given
  double volume = 0, bulk = 0;  // V, V/n
  double momentum[D] = {};      // V u_d
  double moment[D] = {};        // V times (where the water was - where the node is)

  Gathered() = default;
  Gathered(const ParticleView<D>& p, index i) : volume(p.volume[i]), bulk(p.bulk(i)) {
    for (int a = 0; a < D; ++a) momentum[a] = p.volume[i] * p.u[i * D + a];
  }

  void take(double w, const Gathered& g) {
    volume += w * g.volume;
    bulk += w * g.bulk;
    for (int a = 0; a < D; ++a) momentum[a] += w * g.momentum[a];
    for (int a = 0; a < D; ++a) moment[a] += w * g.moment[a];
  }
};

// Thresholds, in half cells of bulk volume. Low ones disturb the surface least: with receive = 0.2 or 0.35 a standing
// wave grew through the position correction that follows (amplitude 1.03 and 1.06 of the first after 10 periods at
// Courant 1/8, dx = a = 20 mm), with 0.1 or 0.05 it did not (0.99); the price is 3 % more particles there.
namespace remesh {
constexpr double receive = 0.1;  // a node with less does not take part
constexpr double keep = 0.05;    // a node that got less gives it to its fullest neighbour
constexpr double weigh = 0.3;    // weights with the porosity, over those without and the particle's own
constexpr double see = 0.5;      // weights a particle must see, else all goes to the nearest node within h
}  // namespace remesh

// Gives particle i to the receivers around it; false where none is near (spray): the particle then stays as it is.
// Where the porosity varies among them they receive in proportion to it, M4'_i n_i / sum_j M4'_j n_j: full pores stay
// full. A particle among nodes that differ so much that the negative lobes of M4' outweigh the rest gives to one.
template <int D>
inline bool give(const Lattice<D>& l, const Pores<D>& pores, const Receivers<D>& receivers, const ParticleView<D>& p,
                 index i, Gathered<D>* nodes) {
  const double* x = p.x + i * D;
  const index home = l.half_cell(x);
  if (pores.closed(l, home)) return false;
  const LatticeStencil<D> s(l, x);
  Gathered<D> g(p, i);

  const std::int32_t* number = receivers.number.data();
  const double* porosity = receivers.porosity.empty() ? nullptr : receivers.porosity.data();
  const auto sees = [=](index node) { return number[node] >= 0; };
  const auto room = [=](index node) { return porosity ? porosity[number[node]] : 1.0; };
  const double own = sees(home) ? room(home) : pores.porosity(l, home);
  bool all = true;
  s.each([&](index node, double, const int*) { all = all && sees(node) && room(node) == own; });
  if (all) {
    for (int a = 0; a < D; ++a)
      for (int k = 0; k < 4; ++k) g.moment[a] -= g.volume * s.w[a][k] * s.reach[a][k];
    s.each([=](index node, double w, const int*) { nodes[number[node]].take(w, g); });
    return true;
  }

  double sum = 0, seen = 0, centre[D] = {}, nearest = 1;
  index nearest_node = -1;
  int nearest_k[D];
  s.each([&](index node, double w, const int* k) {
    if (!sees(node)) return;
    seen += w;
    w *= room(node);
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
    s.each([=](index node, double w, const int*) {
      if (sees(node)) nodes[number[node]].take(w * room(node) / sum, g);
    });
    return true;
  }
  if (nearest_node < 0) return false;
  for (int a = 0; a < D; ++a) g.moment[a] = -g.volume * s.reach[a][nearest_k[a]];
  nodes[number[nearest_node]].take(1, g);
  return true;
}

// The open node within `radius` nodes that holds most, if it holds more than `least`; -1: none
template <int D>
inline index fullest_neighbour(const Lattice<D>& l, index node, int radius, double least, const std::int32_t* number,
                               const Gathered<D>* nodes) {
  const auto centre = Grid<D>::unflat(node, l.shape);
  const index width = 2 * radius + 1, candidates = D == 2 ? width * width : width * width * width;
  index best = -1;
  for (index c = 0; c < candidates; ++c) {
    index rest = c, other = 0;
    bool inside = true;
    for (int a = D - 1; a >= 0; --a, rest /= width) {
      index i = centre[a] + rest % width - radius;
      if (l.periodic[a]) i = (i + l.shape[a]) % l.shape[a];
      inside = inside && i >= 0 && i < l.shape[a];
      other += i * l.stride[a];
    }
    if (!inside || number[other] < 0) continue;
    if (nodes[number[other]].bulk > least) {
      least = nodes[number[other]].bulk;
      best = other;
    }
  }
  return best;
}

// All that `given` at node `from` has goes to `taken` at node `onto`, with its centre where it was.
template <int D>
inline void hand_over(const Lattice<D>& l, index from, index onto, Gathered<D> given, Gathered<D>& taken) {
  const auto i = Grid<D>::unflat(from, l.shape), j = Grid<D>::unflat(onto, l.shape);
  for (int a = 0; a < D; ++a) {
    index step = i[a] - j[a];
    if (l.periodic[a] && 2 * std::abs(step) > l.shape[a]) step += step > 0 ? -l.shape[a] : l.shape[a];
    given.moment[a] += given.volume * static_cast<double>(step) * l.h[a];
  }
  taken.take(1, given);
}

// A node still in debt (the negative lobes of M4' in thin water) is paid off by the fullest node around that
// has amply more than the debt, however far: rare, so one by one. Its volume can be in debt and its bulk not,
// where the porosity changes.
template <int D>
inline void repay(const Lattice<D>& l, const Receivers<D>& receivers, Gathered<D>* nodes,
                  std::vector<unsigned char>& gone) {
  const std::int32_t* number = receivers.number.data();
  const unsigned char* left = gone.data();
  for (index r : parallel_where(receivers.count(),
                                [=](index r) { return !left[r] && !(nodes[r].bulk > 0 && nodes[r].volume > 0); })) {
    const double debt = 4 * std::max(std::abs(nodes[r].bulk), std::abs(nodes[r].volume));
    for (int radius = 2; radius <= 32 && !gone[r]; radius *= 2) {
      const index to = fullest_neighbour(l, receivers.node[r], radius, debt, number, nodes);
      if (to < 0) continue;
      hand_over(l, receivers.node[r], to, nodes[r], nodes[number[to]]);
      gone[r] = 1;
    }
  }
}

// Nodes that hold less than `keep` of a half cell (or less than nothing: M4' has negative lobes) give it all away. On
// return gone[r] tells which; a little water with no neighbour to go to stays (but none below nothing).
template <int D>
inline std::vector<unsigned char> merge_small(const Lattice<D>& l, const Receivers<D>& receivers, Gathered<D>* nodes) {
  const index count = receivers.count();
  std::vector<std::int32_t> target(count, -1);
  std::vector<unsigned char> gone(count, 0);
  const std::int32_t* number = receivers.number.data();
  const std::int32_t* node = receivers.node.data();
  std::int32_t* to = target.data();
  const double enough = remesh::keep * l.volume;
  unsigned char* given = gone.data();
  parallel_for(count, [=, &l](index r) {
    given[r] = nodes[r].volume == 0;
    if (given[r] || nodes[r].bulk >= enough) return;
    for (int radius = 1; radius <= 3 && to[r] < 0; ++radius)
      to[r] = static_cast<std::int32_t>(fullest_neighbour(l, node[r], radius, enough, number, nodes));
  });
  for (index r : parallel_where(count, [=](index r) { return to[r] >= 0; })) {
    hand_over(l, node[r], to[r], nodes[r], nodes[number[to[r]]]);
    gone[r] = 1;
  }
  repay(l, receivers, nodes, gone);
  return gone;
}

// Position of the particle of a node: where its water came from on average, never in a solid half cell.
template <int D>
inline void place(const Lattice<D>& l, const Pores<D>& pores, index node, const Gathered<D>& g, double* x) {
  const auto at = Grid<D>::unflat(node, l.shape);
  double offset[D];
  bool inside = true;
  for (int a = 0; a < D; ++a) {
    const double size = l.h[a] * static_cast<double>(l.shape[a]);
    offset[a] = std::clamp(g.moment[a] / g.volume, -l.h[a], l.h[a]);
    x[a] = (static_cast<double>(at[a]) + 0.5) * l.h[a] + offset[a];
    if (l.periodic[a]) x[a] -= size * std::floor(x[a] / size);
    inside = inside && x[a] >= 0 && x[a] <= size;
  }
  if (inside && !pores.closed(l, l.half_cell(x))) return;
  constexpr double half = 0.5 - 1e-9;
  for (int a = 0; a < D; ++a)
    x[a] = (static_cast<double>(at[a]) + 0.5) * l.h[a] + std::clamp(offset[a], -half * l.h[a], half * l.h[a]);
}

// What the nodes were given, and what of the old particles gave nothing: all that remeshing needs when it has done.
template <int D>
struct Shared {
  std::vector<std::int32_t> node;     // of each receiver
  std::vector<Gathered<D>> gathered;  // by each receiver
  std::vector<std::int32_t> from;  // of the new particles: number of the receiver, then count + number of the old one
};

template <int D>
inline Shared<D> share_out(const Lattice<D>& l, const Pores<D>& pores, const ParticleView<D>& p) {
  const Slabs<D> slabs(l, p.n, p.x);
  Receivers<D> receivers(l, node_fill(l, slabs, p), &pores, remesh::receive);
  const index count = receivers.count();
  Shared<D> shared;
  shared.gathered.resize(count);
  std::vector<unsigned char> stayed(p.n);
  Gathered<D>* nodes = shared.gathered.data();
  unsigned char* stays = stayed.data();
  slabs.scatter([=, &l, &pores, &receivers](index i) { stays[i] = !give(l, pores, receivers, p, i, nodes); });
  const auto gone = merge_small(l, receivers, nodes);
  const unsigned char* left = gone.data();
  shared.from = parallel_where(count, [=](index r) { return !left[r]; });
  for (index i : parallel_where(p.n, [=](index i) { return stays[i] != 0; }))
    shared.from.push_back(static_cast<std::int32_t>(count + i));
  shared.node = std::move(receivers.node);
  return shared;
}

// The remeshed particles: those of the nodes in memory order, then the old ones that gave nothing, in their order.
// Conserves sum V and sum V u_d to round-off, and sum V x but for the rare particle held back by
// place(). first, last: nodes along the first axis between which the water is; walls stand at both ends.
template <int D>
inline ParticleArrays<D> remesh_conservative(const Grid<D>& grid, const Pores<D>& pores, const ParticleView<D>& p,
                                             index first, index last) {
  const Lattice<D> l(grid, first, last);
  const Shared<D> shared = share_out(l, pores, p);
  const index size = static_cast<index>(shared.from.size()), count = static_cast<index>(shared.node.size());
  ParticleArrays<D> out(size);
  const std::int32_t *source = shared.from.data(), *node = shared.node.data();
  const Gathered<D>* nodes = shared.gathered.data();
  double *x = out.x.data(), *u = out.u.data(), *volume = out.volume.data();
  parallel_for(size, [=, &l](index i) {
    const index r = source[i], old = r - count;
    volume[i] = r < count ? nodes[r].volume : p.volume[old];
    if (r < count) place(l, pores, node[r], nodes[r], x + i * D);
    for (int a = 0; a < D; ++a) {
      if (r >= count) x[i * D + a] = p.x[old * D + a];
      u[i * D + a] = r < count ? nodes[r].momentum[a] / nodes[r].volume : p.u[old * D + a];
    }
  });
  return out;
}

// The paper's remeshing, eqs (6)-(7) with V_j inside the sum and tensor weights: a full particle, V = n h^D, on every
// node whose fill exceeds the threshold, at the velocity sum V u M4' / sum V M4'. Blind to solids. Water is not
// conserved: every remeshing moves the surface to the outermost node that any particle reaches, which raises it.
template <int D>
inline ParticleArrays<D> remesh_paper(const Grid<D>& grid, const ParticleView<D>& p, double threshold) {
  const Lattice<D> l(grid);
  const Slabs<D> slabs(l, p.n, p.x);
  const Receivers<D> receivers(l, node_fill(l, slabs, p), nullptr, threshold);
  std::vector<Gathered<D>> gathered(receivers.count());
  const std::int32_t* number = receivers.number.data();
  Gathered<D>* nodes = gathered.data();
  slabs.scatter([=, &l](index i) {
    const Gathered<D> g(p, i);
    LatticeStencil<D>(l, p.x + i * D).each([=](index node, double w, const int*) {
      if (number[node] >= 0) nodes[number[node]].take(w, g);
    });
  });
  double least = 1.0;  // porosity: the mean of a node, with weights of both signs, is kept within those there are
  for (index i = 0; p.porosity && i < p.n; ++i) least = std::min(least, p.porosity[i]);
  ParticleArrays<D> out(receivers.count());
  const std::int32_t* node = receivers.node.data();
  double *x = out.x.data(), *u = out.u.data(), *volume = out.volume.data();
  parallel_for(receivers.count(), [=, &l](index r) {
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
