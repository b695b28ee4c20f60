// The parts that remeshing works on: the particles, the pores around the nodes of the lattice, the nodes that receive,
// and what these hold.
#pragma once

#include <houle/exec/scan.hpp>
#include <houle/water/lattice.hpp>

namespace houle {

// The particles that are remeshed: position [m], Darcy velocity [m/s], volume of water [m^D], porosity [-].
template <int D>
struct ParticleView {
  index n;
  const double *x, *u, *volume, *porosity;  // (n, D), (n, D), (n,), (n,) or null: 1
  double bulk(index i) const { return porosity ? volume[i] / porosity[i] : volume[i]; }
};

// The pores of the half cells around the nodes.
template <int D>
struct Pores {
  Listed cells;             // porosity at the cell centres, between which it is linear; null: 1
  const std::int8_t* body;  // number of the body in each half cell: negative in solids
  Interfaces<D> media{};    // interfaces: velocity along one is not handed across,
  bool along = true;        // false: it is, as for what goes with the water itself
  bool solid = true;        // true: some half cells lie in solids

  bool closed(const Lattice<D>& l, index node) const {  // true in a solid, and outside the walls
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

// New particles: position (n, D) [m], Darcy velocity (n, D) [m/s], volume of water (n,) [m^D].
template <int D>
struct ParticleArrays {
  std::vector<double> x, u, volume;
  explicit ParticleArrays(index n) : x(n * D), u(n * D), volume(n) {}
};

// Bulk volume that reaches each node, as a fraction of its half cell: sum_p (V/n) M4' / h^D. stays (n,): 1 for
// particles that give nothing; null: all give.
template <int D>
inline std::vector<double> node_fill(const Lattice<D>& l, const Slabs<D>& slabs, const ParticleView<D>& p,
                                     const unsigned char* stays = nullptr) {
  std::vector<double> fill(static_cast<std::size_t>(l.nodes()), 0.0);
  double* f = fill.data();
  slabs.scatter([=](index i) {
    if (stays && stays[i]) return;
    const double bulk = p.bulk(i) / l.volume;
    LatticeStencil<D>(l, p.x + i * D).each([=](index node, double w, const int*) { f[node] += w * bulk; });
  });
  return fill;
}

// The nodes that may hold a particle, in memory order. number[node] is -1 for the others.
struct Receivers {
  const std::int32_t *number = nullptr, *node = nullptr;
  const double* porosity = nullptr;  // porosity of their half cells; null: 1
  index count = 0;
};

// The memory of the tables of Receivers: the nodes with a fill of `threshold` or more that are not closed. pores null:
// no node is closed.
class ReceiverTables {
 public:
  template <int D>
  ReceiverTables(const Lattice<D>& l, const std::vector<double>& fill, const Pores<D>* pores, double threshold)
      : number_(fill.size()) {
    const double* f = fill.data();
    const bool closes = pores;
    const Pores<D> around = pores ? *pores : Pores<D>{};
    node_ = parallel_where(l.nodes(), [=](index i) { return f[i] >= threshold && !(closes && around.closed(l, i)); });
    if (around.cells) porosity_.resize(node_.size());
    std::int32_t* numbers = number_.data();
    const std::int32_t* nodes = node_.data();
    double* porosity = around.cells ? porosity_.data() : nullptr;
    parallel_for(l.nodes(), [=](index i) { numbers[i] = -1; });
    parallel_for(static_cast<index>(node_.size()), [=](index r) {
      numbers[nodes[r]] = static_cast<std::int32_t>(r);
      if (porosity) porosity[r] = around.porosity(l, nodes[r]);
    });
  }
  Receivers all() const {
    return {number_.data(), node_.data(), porosity_.empty() ? nullptr : porosity_.data(),
            static_cast<index>(node_.size())};
  }

 private:
  std::vector<std::int32_t> number_, node_;
  std::vector<double> porosity_;
};

// The water that a node was given: sums over the particles that gave to it.
template <int D>
struct Gathered {
  double volume = 0, bulk = 0;  // V, V/n
  double momentum[D] = {};      // V u_d
  double moment[D] = {};        // V times (where the water was - where the node is)

  Gathered() = default;
  Gathered(const ParticleView<D>& p, index i) : volume(p.volume[i]), bulk(p.bulk(i)) {
    for (int a = 0; a < D; ++a) momentum[a] = p.volume[i] * p.u[i * D + a];
  }

  bool sound() const { return bulk > 0 && volume > 0; }  // else in debt, by the negative lobes of M4' in thin water
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

// True if neither a solid half cell nor a gate stands between two nodes.
template <int D>
inline bool in_sight(const Lattice<D>& l, const Pores<D>& pores, index from, index onto) {
  const auto way = l.way(from, onto);
  index steps = 1;
  for (int a = 0; a < D; ++a) steps = std::max(steps, std::abs(way[a]));
  const auto start = Grid<D>::unflat(from, l.shape);
  if (l.gates.count) {
    double here[D], there[D];
    for (int a = 0; a < D; ++a) {
      here[a] = (static_cast<double>(start[a]) + 0.5) * l.h[a];
      there[a] = here[a] + static_cast<double>(way[a]) * l.h[a];
    }
    if (l.parted(here, there)) return false;
  }
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

}  // namespace houle
