// The lattice of remeshing, one node per half cell at (i + 1/2) h/2, and how particles give to its nodes in parallel.
#pragma once

#include <vector>

#include <houle/exec/scatter.hpp>
#include <houle/exec/sort.hpp>
#include <houle/grid/gates.hpp>
#include <houle/water/interfaces.hpp>

namespace houle {

// The nodes, two per cell and axis, and where a position lies among them.
template <int D>
struct Lattice {
  std::array<index, D> shape{}, stride{};
  std::array<double, D> h{};
  std::array<bool, D> periodic{};
  double volume = 1;  // size of the half cell of a node [m^D]
  index begin, end;   // nodes begin .. end - 1 along the first axis lie between its walls
  Gates gates;        // on the faces of half cells

  Lattice(const Grid<D>& g, const Gates& shut) : Lattice(g, shut, 0, 2 * g.shape[0]) {}
  Lattice(const Grid<D>& g, const Gates& shut, index first, index last)
      : periodic(g.periodic), begin(first), end(last), gates(shut) {
    for (int a = 0; a < D; ++a) {
      shape[a] = 2 * g.shape[a];
      h[a] = 0.5 * g.h[a];
      volume *= h[a];
    }
    stride = Grid<D>::strides(shape);
  }
  index nodes() const { return shape[0] * stride[0]; }
  index fold(int a, index i) const {  // for a node outside, the one that it repeats, or its mirror image
    const index n = shape[a];
    if (periodic[a]) return i < 0 ? i + n : (i >= n ? i - n : i);
    const index low = a == 0 ? begin : 0, high = a == 0 ? end : n;
    const index image = i < low ? 2 * low - 1 - i : (i >= high ? 2 * high - 1 - i : i);
    return std::clamp<index>(image, 0, n - 1);  // an image may lie beyond the tank, or behind another wall
  }
  Compartment compartment(double x, index top) const {
    return compartment_beside<D>(gates, h, shape[0], periodic[0], x, top);
  }
  // True if a gate stands between two points, at least one of which lies above its lower edge. `to` may lie beyond the
  // end of a periodic axis.
  bool parted(const double* from, const double* to) const {
    const double height = std::max(from[D - 1], to[D - 1]);
    const double length = periodic[0] ? h[0] * static_cast<double>(shape[0]) : 0.0;
    for (int k = 0; k < gates.count; ++k) {
      if (!(height > gates.gate[k].bottom)) continue;
      for (int turn = -1; turn <= 1; ++turn) {
        const double x = gates.gate[k].x + turn * length;
        if ((from[0] < x) != (to[0] < x)) return true;
      }
    }
    return false;
  }
  std::array<index, D> way(index from, index onto) const {  // in nodes, the short way around periodic axes
    auto way = Grid<D>::unflat(onto, shape);
    const auto start = Grid<D>::unflat(from, shape);
    for (int a = 0; a < D; ++a) {
      way[a] -= start[a];
      if (periodic[a] && 2 * std::abs(way[a]) > shape[a]) way[a] += way[a] > 0 ? -shape[a] : shape[a];
    }
    return way;
  }
  double scaled(int a, double x) const {  // x in spacings; NaN counts as 0, for the result leads to a place in memory
    const double s = x / h[a];
    return s > 0.0 ? std::min(s, static_cast<double>(shape[a])) : 0.0;
  }
  index half_cell(const double* x) const {  // the node whose half cell holds x
    index f = 0;
    for (int a = 0; a < D; ++a) f += std::min(static_cast<index>(scaled(a, x[a])), shape[a] - 1) * stride[a];
    return f;
  }
};

// visit(other) for every node within `radius` of a node along each axis, itself too: once, around periodic axes as well
template <int D, class Visit>
inline void each_near(const Lattice<D>& l, index node, index radius, Visit visit) {
  const auto centre = Grid<D>::unflat(node, l.shape);
  std::array<index, D> first, width;
  index all = 1;
  for (int a = 0; a < D; ++a) {
    const index n = l.shape[a], low = centre[a] - radius;
    first[a] = l.periodic[a] ? (low % n + n) % n : std::max<index>(low, 0);
    width[a] = l.periodic[a] ? std::min(2 * radius + 1, n) : std::min(centre[a] + radius, n - 1) - first[a] + 1;
    all *= width[a];
  }
  for (index c = 0; c < all; ++c) {
    index rest = c, other = 0;
    for (int a = D - 1; a >= 0; --a) {
      const index i = first[a] + rest % width[a];
      other += (i < l.shape[a] ? i : i - l.shape[a]) * l.stride[a];
      rest /= width[a];
    }
    visit(other);
  }
}

// The 4^D nodes around a particle: per axis their place in memory, their weight, their distance from the particle [m].
template <int D>
struct LatticeStencil {
  index at[D][4];
  double w[D][4], reach[D][4];
  Compartment compartment;  // a node behind a gate is replaced by its mirror image, in all rows alike

  LatticeStencil(const Lattice<D>& l, const double* x) {
    if (l.gates.count) compartment = l.compartment(x[0], floor_index(l.scaled(D - 1, x[D - 1]) - 0.5) + 2);
    for (int a = 0; a < D; ++a) {
      const double s = l.scaled(a, x[a]) - 0.5, base = std::floor(s);
      M4PrimeKernel::weights(s, static_cast<index>(base) - 1, {}, w[a], nullptr);
      for (int k = 0; k < 4; ++k) {
        const index i = between_gates(a, static_cast<index>(base) + k - 1), inside = l.fold(a, i);
        at[a][k] = inside * l.stride[a];
        reach[a][k] = (static_cast<double>(l.periodic[a] ? i : inside) - s) * l.h[a];
      }
    }
  }
  // Replaces the nodes behind an interface parallel to the grid by their mirror images in front of it, on the side of
  // x; false, and nothing is done, if it is not parallel. A node lies behind if its centre does.
  bool mirror(const Lattice<D>& l, const Interface<D>& interface, const double* x) {
    const int a = interface.axis();
    if (a < 0) return false;
    const double place = interface.normal[a] * interface.offset / l.h[a];
    const index first = static_cast<index>(std::ceil(place - 0.5 - 1e-6));  // the first node above the interface
    const index own = static_cast<index>(l.scaled(a, x[a]));                // the node whose half cell holds x
    for (int k = 0; k < 4; ++k) {
      const index i = between_gates(a, static_cast<index>(std::floor(l.scaled(a, x[a]) - 0.5)) + k - 1);
      if ((i < first) == (own < first)) continue;
      const index image = between_gates(a, 2 * first - 1 - i), inside = l.fold(a, image);
      at[a][k] = inside * l.stride[a];
      reach[a][k] = (static_cast<double>(l.periodic[a] ? image : inside) + 0.5) * l.h[a] - x[a];
    }
    return true;
  }
  index between_gates(int a, index i) const { return a == 0 ? compartment.image(i) : i; }
  template <class Visit>
  void each(Visit visit) const {  // visit(node, weight, k): k[a] is the place 0..3 of the node on axis a
    int k[D];
    for (k[0] = 0; k[0] < 4; ++k[0])
      for (k[1] = 0; k[1] < 4; ++k[1]) {
        const index node = at[0][k[0]] + at[1][k[1]];
        const double weight = w[0][k[0]] * w[1][k[1]];
        if constexpr (D == 2)
          visit(node, weight, k);
        else
          for (k[2] = 0; k[2] < 4; ++k[2]) visit(node + at[2][k[2]], weight * w[2][k[2]], k);
      }
  }
};

// Particles in slabs along the first axis, wide enough that every second slab writes to nodes of its own: two sweeps
// over independent slabs scatter without conflict, in an order that the number of threads does not change.
template <int D>
class Slabs {
 public:
  Slabs(const Lattice<D>& l, index n, const double* x) {
    const index nodes = l.shape[0];
    count_ = nodes < 8 ? 1 : nodes / 8 * 2;  // even (periodic axes), each at least 4 nodes wide
    start_.resize(static_cast<std::size_t>(count_) + 1);
    order_.resize(static_cast<std::size_t>(n));
    std::vector<std::int32_t> slab(static_cast<std::size_t>(n));
    std::int32_t* s = slab.data();
    const index count = count_;
    parallel_for(n, [=](index p) {
      const index i = static_cast<index>(l.scaled(0, x[p * D]) + 0.5);
      s[p] = static_cast<std::int32_t>(std::min(i, nodes - 1) * count / nodes);
    });
    counting_sort(n, count, s, order_.data(), start_.data());
  }
  template <class Body>
  void scatter(Body body) const {  // body(p) for every particle
    const std::int32_t *start = start_.data(), *order = order_.data();
    parallel_for_coloured(
        count_, 2, [](index s) { return static_cast<int>(s % 2); },
        [=](index s) {
          for (index q = start[s]; q < start[s + 1]; ++q) body(order[q]);
        });
  }

 private:
  index count_;
  std::vector<std::int32_t> start_, order_;
};

}  // namespace houle
