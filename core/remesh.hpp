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

#include "lattice.hpp"
#include "solids.hpp"

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
  Interfaces<D> media{};    // across which the velocity along them is not handed,
  bool along = true;        // unless what the particles carry goes with the water itself

  bool closed(const Lattice<D>& l, index node) const {  // in a solid, or not between the walls
    return body[node] < 0 || node < l.begin * l.stride[0] || node >= l.end * l.stride[0];
  }
  const Interface<D>* near(const Lattice<D>& l, const double* x) const {  // nearest to the centre of the cell of x
    if (!media.number) return nullptr;
    index cell = 0;
    for (int a = 0; a < D; ++a)
      cell = cell * (l.shape[a] / 2) + std::min(static_cast<index>(l.scaled(a, x[a])) / 2, l.shape[a] / 2 - 1);
    return media.in(cell);
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

// Bulk volume that reaches each node, as a fraction of its half cell: sum_p (V/n) M4' / h^D. stays: of each particle,
// whether it gives nothing; null: all give.
template <int D>
inline std::vector<double> node_fill(const Lattice<D>& l, const Slabs<D>& slabs, const ParticleView<D>& p,
                                     const unsigned char* stays = nullptr) {
  std::vector<double> fill(static_cast<std::size_t>(l.nodes()), 0.0);
  double* f = fill.data();
  slabs.scatter([=, &l](index i) {
    if (stays && stays[i]) return;
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

  bool sound() const { return bulk > 0 && volume > 0; }  // debts: the negative lobes of M4' in thin water
  bool nothing() const {
    double sum = std::abs(volume) + std::abs(bulk);
    for (int a = 0; a < D; ++a) sum += std::abs(momentum[a]) + std::abs(moment[a]);
    return sum == 0;
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
constexpr index far = 32;        // nodes from which a debt is paid, or a moment taken, at most
}  // namespace remesh

// The nodes to which a particle beside an interface gives its momentum along that: those of its own side.
template <int D>
struct Aside {
  const Interface<D>* at = nullptr;  // null: far from any
  bool parallel = false;             // to the grid: the nodes across are replaced by their mirror images
  LatticeStencil<D> nodes;

  Aside(const Lattice<D>& l, const Pores<D>& pores, const LatticeStencil<D>& s, const double* x)
      : at(pores.near(l, x)), nodes(s) {
    if (at) parallel = nodes.mirror(l, *at, x);
  }
  bool has(const double* x, const int* k) const {  // whether node k, one place per axis, lies on the side of x
    double node[D];
    for (int a = 0; a < D; ++a) node[a] = x[a] + nodes.reach[a][k[a]];
    return parallel || at->beyond(node) == at->beyond(x);
  }
};

// Takes the momentum along the interface out of what a particle at x has to give, and gives it to the nodes of its own
// side; where hardly any of those receive it stays with the rest.
template <int D, class Room>
inline void give_along(const Receivers<D>& receivers, const Aside<D>& aside, const double* x, Gathered<D>& g, Room room,
                       Gathered<D>* nodes) {
  const std::int32_t* number = receivers.number.data();
  double sum = 0, all = 0;
  aside.nodes.each([&](index node, double w, const int* k) {
    if (number[node] < 0) return;
    all += std::abs(w) * room(node);
    if (aside.has(x, k)) sum += w * room(node);
  });
  if (!(sum > remesh::weigh * all)) return;
  double along[D];
  for (int a = 0; a < D; ++a) {
    along[a] = aside.at->across(a) ? 0.0 : g.momentum[a];
    g.momentum[a] -= along[a];
  }
  aside.nodes.each([&](index node, double w, const int* k) {
    if (number[node] < 0 || !aside.has(x, k)) return;
    for (int a = 0; a < D; ++a) nodes[number[node]].momentum[a] += w * room(node) / sum * along[a];
  });
}

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
  const Aside<D> aside(l, pores, s, x);
  s.each([&](index node, double, const int*) { all = all && sees(node) && room(node) == own; });
  if (all && !aside.at) {
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
    if (aside.at && pores.along) give_along(receivers, aside, x, g, room, nodes);
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

// Whether no solid half cell stands between two nodes.
template <int D>
inline bool in_sight(const Lattice<D>& l, const Pores<D>& pores, index from, index onto) {
  const auto way = l.way(from, onto);
  index steps = 1;
  for (int a = 0; a < D; ++a) steps = std::max(steps, std::abs(way[a]));
  const auto start = Grid<D>::unflat(from, l.shape);
  for (index s = 1; s < steps; ++s) {
    index node = 0;
    for (int a = 0; a < D; ++a) {
      const double share = static_cast<double>(s * way[a]) / static_cast<double>(steps);
      node += inside(start[a] + static_cast<index>(std::round(share)), l.shape[a], l.periodic[a]) * l.stride[a];
    }
    if (pores.closed(l, node)) return false;
  }
  return true;
}

// Of the other nodes in sight within `radius` nodes that may(what they hold), the one that holds most; -1: none
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

// All that `given` at node `from` has goes to `taken` at node `onto`, with its centre where it was.
template <int D>
inline void hand_over(const Lattice<D>& l, index from, index onto, Gathered<D>& given, Gathered<D>& taken) {
  const auto way = l.way(onto, from);
  for (int a = 0; a < D; ++a) given.moment[a] += given.volume * static_cast<double>(way[a]) * l.h[a];
  taken.take(1, given);
  given = {};  // so that nobody hands anything to it any more
}

// A node still in debt is paid off by the fullest node in sight that has amply more than the debt, however far: rare,
// so one by one. Its volume can be in debt and its bulk not, where the porosity changes.
template <int D>
inline bool repay(const Lattice<D>& l, const Pores<D>& pores, const Receivers<D>& receivers, index r,
                  Gathered<D>* nodes) {
  const std::int32_t* number = receivers.number.data();
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

// Where no node has so much the nearest give the debtor all they have, until it owns amply more than it owed: the water
// of a drop or a tip in one particle, if need be.
template <int D>
inline void collect(const Lattice<D>& l, const Pores<D>& pores, const Receivers<D>& receivers, index r,
                    Gathered<D>* nodes) {
  const std::int32_t *number = receivers.number.data(), *node = receivers.node.data();
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
inline void merge_small(const Lattice<D>& l, const Pores<D>& pores, const Receivers<D>& receivers, Gathered<D>* nodes) {
  const index count = receivers.count();
  const std::int32_t *number = receivers.number.data(), *node = receivers.node.data();
  const double enough = remesh::keep * l.volume;
  const auto holds = [=](const Gathered<D>& g) { return g.bulk > enough; };
  std::vector<std::int32_t> target(count);
  std::int32_t* to = target.data();
  for (bool all = false; !all;) {  // a debt can leave the node that pays it with little
    parallel_for(count, [=, &l, &pores](index r) {
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

// Where particles may be: in the tank, between the walls, in the pores, outside of the solids.
template <int D>
struct Space {
  const Grid<D>& grid;
  const Lattice<D>& l;
  const Pores<D>& pores;
  Solids<D> solids;

  bool in_pores(const double* x) const {
    for (int a = 0; a < D; ++a)
      if (!(x[a] >= 0 && x[a] <= l.h[a] * static_cast<double>(l.shape[a]))) return false;
    return !pores.closed(l, l.half_cell(x));
  }
  bool holds(const double* x) const { return in_pores(x) && !in_solid(grid, solids, x); }
  void move(double* x, double step, const double* way) const {  // around periodic axes
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

// Position of the particle of a node: where its water came from on average, at most a spacing off, never in a solid.
// On return its moment is what this takes from V x: zero but for the particle that is held back.
template <int D>
inline void place(const Space<D>& space, index node, Gathered<D>& g, double* x) {
  const Lattice<D>& l = space.l;
  const auto at = Grid<D>::unflat(node, l.shape);
  double right[D], lies[D];
  for (int a = 0; a < D; ++a) {
    const double centre = (static_cast<double>(at[a]) + 0.5) * l.h[a], offset = g.moment[a] / g.volume;
    right[a] = centre + offset;
    x[a] = lies[a] = centre + std::clamp(offset, -l.h[a], l.h[a]);
    space.wrap(a, x[a]);
  }
  if (!space.in_pores(x)) {  // back into the half cell of the node
    constexpr double half = 0.5 - 1e-9;
    for (int a = 0; a < D; ++a) {
      const double centre = (static_cast<double>(at[a]) + 0.5) * l.h[a];
      x[a] = lies[a] = centre + std::clamp(lies[a] - centre, -half * l.h[a], half * l.h[a]);
    }
  }
  double before[D];
  for (int a = 0; a < D; ++a) before[a] = x[a];
  if (in_solid(space.grid, space.solids, x)) {  // round a corner, or in a half cell that the outline cuts
    leave_solids(space.grid, space.solids, x);
    bring_into_tank(space.grid, x);
  }
  for (int a = 0; a < D; ++a) g.moment[a] = g.volume * (right[a] - lies[a] + (before[a] - x[a]));
}

// What one of the held back particles takes from the moment goes to those around it, which all move by the same
// fraction of a spacing: the nearest that may all go there and are enough.
template <int D>
class Neighbours {
 public:
  Neighbours(const Space<D>& space, const Receivers<D>& receivers, const std::vector<std::int32_t>& kept,
             ParticleArrays<D>& particles)
      : space_(space), receivers_(receivers), place_(receivers.count(), -1), p_(particles) {
    for (std::size_t i = 0; i < kept.size() && kept[i] < receivers.count(); ++i)
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
  const Receivers<D>& receivers_;
  std::vector<std::int32_t> place_, found_;  // of each receiver, number of its particle or -1; those that may move
  ParticleArrays<D>& p_;

  bool can_go(index i, double step, const double* way) const {
    double x[D];
    for (int a = 0; a < D; ++a) x[a] = p_.x[i * D + a];
    space_.move(x, step, way);
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

// What the nodes were given, and what of the old particles gave nothing: all that remeshing needs when it has done.
template <int D>
struct Shared {
  Receivers<D> receivers;
  std::vector<Gathered<D>> gathered;  // by each receiver
  std::vector<std::int32_t> from;  // of the new particles: number of the receiver, then count + number of the old one
};

// stays: of each particle, whether it must give nothing; on return, whether it gave nothing.
template <int D>
inline Shared<D> share_out(const Lattice<D>& l, const Pores<D>& pores, const ParticleView<D>& p,
                           std::vector<unsigned char>& stayed) {
  const Slabs<D> slabs(l, p.n, p.x);
  unsigned char* stays = stayed.data();
  Shared<D> shared{Receivers<D>(l, node_fill(l, slabs, p, stays), &pores, remesh::receive), {}, {}};
  const Receivers<D>& receivers = shared.receivers;
  const index count = receivers.count();
  shared.gathered.resize(count);
  Gathered<D>* nodes = shared.gathered.data();
  slabs.scatter(
      [=, &l, &pores, &receivers](index i) { stays[i] = stays[i] || !give(l, pores, receivers, p, i, nodes); });
  merge_small(l, pores, receivers, nodes);
  shared.from = parallel_where(count, [=](index r) { return !nodes[r].nothing(); });
  for (index i : parallel_where(p.n, [=](index i) { return stays[i] != 0; }))
    shared.from.push_back(static_cast<std::int32_t>(count + i));
  return shared;
}

template <int D>
inline ParticleArrays<D> placed(const Space<D>& space, Shared<D>& shared, const ParticleView<D>& p) {
  const index size = static_cast<index>(shared.from.size()), count = shared.receivers.count();
  ParticleArrays<D> out(size);
  const std::int32_t *source = shared.from.data(), *node = shared.receivers.node.data();
  Gathered<D>* nodes = shared.gathered.data();
  double *x = out.x.data(), *u = out.u.data(), *volume = out.volume.data();
  parallel_for(size, [=, &space](index i) {
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

// Gives what the held back particles take from the moment to those around them. Returns the nodes whose particle is in
// debt, or has a moment that nobody can take.
template <int D>
inline std::vector<index> settle(const Space<D>& space, const Shared<D>& shared, ParticleArrays<D>& out) {
  const index size = static_cast<index>(shared.from.size()), count = shared.receivers.count();
  const std::int32_t* source = shared.from.data();
  const Gathered<D>* nodes = shared.gathered.data();
  const auto held = parallel_where(size, [=](index i) {
    if (source[i] >= count) return false;
    const Gathered<D>& g = nodes[source[i]];
    double sum = 0;
    for (int a = 0; a < D; ++a) sum += std::abs(g.moment[a]);
    return !(g.sound() && sum == 0);
  });
  std::vector<index> open;
  if (held.empty()) return open;
  Neighbours<D> neighbours(space, shared.receivers, shared.from, out);
  for (index i : held) {
    const Gathered<D>& g = nodes[source[i]];
    if (!(g.sound() && neighbours.take(source[i], g.moment))) open.push_back(shared.receivers.node[source[i]]);
  }
  return open;
}

// The particles within `radius` nodes of one of the nodes are to stay as they are.
template <int D>
inline void leave_as_they_are(const Lattice<D>& l, const std::vector<index>& nodes, index radius,
                              const ParticleView<D>& p, std::vector<unsigned char>& stayed) {
  std::vector<unsigned char> near(static_cast<std::size_t>(l.nodes()), 0);
  for (index node : nodes) each_near(l, node, radius, [&](index other) { near[other] = 1; });
  const unsigned char* marked = near.data();
  unsigned char* stays = stayed.data();
  parallel_for(p.n, [=, &l](index i) { stays[i] = stays[i] || marked[l.half_cell(p.x + i * D)]; });
}

// The remeshed particles: those of the nodes in memory order, then the old ones that gave nothing, in their order.
// Conserves sum V, sum V u_d and sum V x to round-off: water of which no particles can be made so, a drop around the
// corner of a solid, is left as it is. first, last: nodes along the first axis between which the water is; walls stand
// at both ends.
template <int D>
inline ParticleArrays<D> remesh_conservative(const Grid<D>& grid, const Pores<D>& pores, const Solids<D>& solids,
                                             const ParticleView<D>& p, index first, index last) {
  const Lattice<D> l(grid, first, last);
  const Space<D> space{grid, l, pores, solids};
  const index all = *std::max_element(l.shape.begin(), l.shape.end());
  std::vector<unsigned char> stayed(p.n, 0);
  for (index radius = 4;; radius *= 2) {
    Shared<D> shared = share_out(l, pores, p, stayed);
    ParticleArrays<D> out = placed(space, shared, p);
    const std::vector<index> open = settle(space, shared, out);
    if (open.empty() || radius > 2 * all) return out;
    leave_as_they_are(l, open, radius, p, stayed);
  }
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
