// Transfer kernels: the weights with which a particle and the grid nodes around it see each other, axis by axis.
//
// A kernel has `width` nodes per axis. Along one axis a particle at index coordinate s (node i at i) reaches the nodes
// first(s) .. first(s) + width - 1. weights() writes their weights w; the Gaussian also writes the second-moment terms
// q, its weight in d dimensions being prod_a w_a (1 + sum_a q_a), paper eqs (8)-(11). `edge` is the particle's edge in
// units of the spacing of that axis, dx_p / (h n^(1/d)): only the Gaussian uses it. least_own: share of its weights
// that a particle must have on its own side of an interface; with less it sees all nodes (interfaces.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include <houle/grid/gates.hpp>

namespace houle {

// The edge of a particle, which is a square or a cube: its length, and how the Gaussian is integrated over it.
struct Edge {
  double length = 0.0;
  bool exact = false;  // true: exactly; else to second order
  Edge operator/(double h) const { return {length / h, exact}; }
};

// The tent: its weights sum to 1, and it reproduces linear fields.
struct LinearKernel {
  static constexpr int width = 2;
  static constexpr bool taylor = false;
  static constexpr bool normalised = true;  // the weights sum to 1 for any s
  static constexpr double least_own = 0.01;
  static index first(double s) { return floor_index(s); }
  static void weights(double s, index i0, Edge, double* w, double*) {
    const double f = s - static_cast<double>(i0);
    w[0] = 1.0 - f;
    w[1] = f;
  }
};

// The quadratic B-spline: smooth, and it reproduces linear fields.
struct QuadraticKernel {
  static constexpr int width = 3;
  static constexpr bool taylor = false;
  static constexpr bool normalised = true;
  static constexpr double least_own = 0.01;
  static index first(double s) { return floor_index(s + 0.5) - 1; }
  static void weights(double s, index i0, Edge, double* w, double*) {
    const double f = s - static_cast<double>(i0 + 1);  // in [-1/2, 1/2)
    w[0] = 0.5 * (0.5 - f) * (0.5 - f);
    w[1] = 0.75 - f * f;
    w[2] = 0.5 * (0.5 + f) * (0.5 + f);
  }
};

// M4' of Monaghan (1985), paper eq. (7) as a tensor product: it reproduces quadratic fields, and has negative weights.
struct M4PrimeKernel {
  static constexpr int width = 4;
  static constexpr bool taylor = false;
  static constexpr bool normalised = true;
  static constexpr double least_own = 0.5;  // weights of both signs: the sum of some of them may be near 0
  static double value(double r) {
    const double s = std::abs(r);
    if (s < 1.0) return 1.0 - s * s * (2.5 - 1.5 * s);
    if (s < 2.0) return 0.5 * (2.0 - s) * (2.0 - s) * (1.0 - s);
    return 0.0;
  }
  static index first(double s) { return floor_index(s) - 1; }
  static void weights(double s, index i0, Edge, double* w, double*) {
    for (int k = 0; k < 4; ++k) w[k] = value(s - static_cast<double>(i0 + k));
  }
};

// The Gaussian of standard deviation sigma = 0.6 h (the paper's W ~ exp(-r^2/eps^2) with eps = 0.85 h), cut at 3 nodes,
// of a particle that is a square. To second order: paper eqs (10)-(11), and for an edge of 0 that of a point, eq. (8).
// An edge of more than 1.7 cells counts as one of 1.7: its series has negative weights, whose sum may vanish while the
// momentum that they carry does not. The exact integral is a difference of error functions.
//
// The weights are not a partition of unity, so transfers divide by their sum.
struct GaussianKernel {
  static constexpr int width = 6;
  static constexpr bool taylor = true;
  static constexpr bool normalised = false;
  static constexpr double least_own = 0.01;
  static constexpr double sigma = 0.6;
  static constexpr double widest = 1.0 / 3.0;  // moment up to which 1 + sum_a q_a >= 0 on three axes
  static index first(double s) { return floor_index(s) - 2; }
  static void weights(double s, index i0, Edge edge, double* w, double* q) {
    if (edge.exact) [[unlikely]]
      return integrals(s, i0, edge.length, w, q);
    const double moment = std::min(edge.length * edge.length / 24.0 / (sigma * sigma), widest);  // (1/2) M20 / M00
    for (int k = 0; k < width; ++k) {
      const double r = (s - static_cast<double>(i0 + k)) / sigma;
      w[k] = std::exp(-0.5 * r * r);
      q[k] = moment * (r * r - 1.0);  // moment W_xx / W
    }
  }
  HOULE_NOINLINE static void integrals(double s, index i0, double edge, double* w, double* q) {
    const double c = 1.0 / (sigma * std::sqrt(2.0));
    for (int k = 0; k < width; ++k) {
      const double r = s - static_cast<double>(i0 + k);
      w[k] = std::erf((r + 0.5 * edge) * c) - std::erf((r - 0.5 * edge) * c);
      q[k] = 0.0;
    }
  }
};

// A node index brought back into the grid. On an axis with walls, a node behind the wall is the mirror image of one in
// front; the velocity component normal to the wall then has the sign -1. On a periodic axis the index wraps.
struct Folded {
  index node;
  double sign;
};

// Brings node i of an axis with `cells` cells into the grid.
inline Folded fold(index i, index cells, bool on_faces, bool periodic) {
  if (periodic) {
    i %= cells;
    return {i < 0 ? i + cells : i, 1.0};
  }
  const index last = on_faces ? cells : cells - 1;
  double sign = 1.0;
  for (int pass = 0; pass < 4 && (i < 0 || i > last); ++pass) {  // repeated in a tank narrower than the kernel
    i = i < 0 ? (on_faces ? -i : -1 - i) : (on_faces ? 2 * last - i : 2 * last + 1 - i);
    sign = -sign;
  }
  return {i < 0 ? 0 : (i > last ? last : i), sign};
}

// Calls f with 0 .. n-1: as compile-time constants where n is small, so that what it indexes stays in registers
// (with 3 axes GCC must be told to inline, or the stencil goes through memory: half the speed).
template <int n, class F>
[[gnu::always_inline]] inline void each_of(F f) {
  if constexpr (n <= 3) {
    f(std::integral_constant<int, 0>{});
    if constexpr (n > 1) f(std::integral_constant<int, 1>{});
    if constexpr (n > 2) f(std::integral_constant<int, 2>{});
  } else {
    for (int k = 0; k < n; ++k) f(k);
  }
}

// Calls f with 0 .. n-1 as compile-time constants.
template <int n, class F>
[[gnu::always_inline]] inline void unrolled(F f) {
  [&]<int... k>(std::integer_sequence<int, k...>) {
    (f(std::integral_constant<int, k>{}), ...);
  }(std::make_integer_sequence<int, n>{});
}

// The nodes that a particle reaches along one axis, on the faces across it or at the cell centres.
template <class K>
struct Reach {
  index node[K::width];
  double weight[K::width];
  double moment[K::width];  // q of the Gaussian
  double sign[K::width];    // factor of the velocity along this axis: -1 at mirror images
  double first;             // way from the particle to its first node, before that is folded [cells]

  // s: index coordinate, node i at i; edge: of the particle, in cells
  void set(double s, Edge edge, bool on_faces, index cells, bool periodic) {
    const index i0 = K::first(s);
    K::weights(s, i0, edge, weight, moment);
    first = static_cast<double>(i0) - s;
    for (int k = 0; k < K::width; ++k) {
      node[k] = i0 + k;
      sign[k] = 1.0;
    }
    const index last = on_faces && !periodic ? cells : cells - 1;
    if (i0 >= 0 && i0 + K::width - 1 <= last) return;
    for (int k = 0; k < K::width; ++k) {
      const Folded f = fold(i0 + k, cells, on_faces, periodic);
      node[k] = f.node;
      if constexpr (K::width > 2) sign[k] = f.sign;  // the linear kernel never reaches behind the wall face
    }
  }
  // Sets the nodes, at cell centres, of a particle between gates: the mirror image in front of a gate for each cell
  // behind it.
  void keep(const Compartment& between, double s, index cells, bool periodic) {
    for (int k = 0; k < K::width; ++k) node[k] = fold(between.image(K::first(s) + k), cells, false, periodic).node;
  }
};

// The compartment of a particle at x among the gates that stand where its tent reaches.
template <int D>
inline Compartment compartment_of_cells(const Grid<D>& g, const Gates& gates, const double* x) {
  const index top = floor_index(x[D - 1] / g.h[D - 1] - 0.5) + 1;
  return compartment_beside<D>(gates, g.h, g.shape[0], g.periodic[0], x[0], top);
}

// The nodes around a particle: those of the field on the faces of axis `component`, or (component -1) at cell centres.
template <class K, int D>
struct Stencil {
  Reach<K> centre[D], face[D];

  // x: position in metres; edge: of the particle, in metres
  [[gnu::always_inline]] void set_centres(const Grid<D>& g, const double* x, Edge edge = {}) {
    each_of<D>([&](auto a) { centre[a].set(x[a] / g.h[a] - 0.5, edge / g.h[a], false, g.shape[a], g.periodic[a]); });
  }
  [[gnu::always_inline]] void set(const Grid<D>& g, const double* x, Edge edge = {}) {
    each_of<D>([&](auto a) {
      const double s = x[a] / g.h[a];
      const Edge cells = edge / g.h[a];
      centre[a].set(s - 0.5, cells, false, g.shape[a], g.periodic[a]);
      face[a].set(s, cells, true, g.shape[a], g.periodic[a]);
    });
  }

  template <int component, int axis>
  const Reach<K>& along() const {
    if constexpr (axis == component)
      return face[axis];
    else
      return centre[axis];
  }

  // visit(flat node, weight (M4' has negative ones too), sign of the mirrored normal component[, offsets k[D]])
  template <int component, class Visit>
  [[gnu::always_inline]] void each(const std::array<index, D>& stride, Visit visit) const {
    const auto &r0 = along<component, 0>(), &r1 = along<component, 1>();
    each_of<K::width>([&](auto i) {
      const index row = r0.node[i] * stride[0];
      each_of<K::width>([&](auto j) {
        const double w = r0.weight[i] * r1.weight[j];
        if constexpr (D == 2) {
          double q = 1.0, sign = 1.0;
          if constexpr (K::taylor) q += r0.moment[i] + r1.moment[j];
          if constexpr (component == 0) sign = r0.sign[i];
          if constexpr (component == 1) sign = r1.sign[j];
          at(visit, row + r1.node[j], w * q, sign, {i, j});
        } else {
          const auto& r2 = along<component, 2>();
          const index line = row + r1.node[j] * stride[1];
          each_of<K::width>([&](auto l) {
            double q = 1.0, sign = 1.0;
            if constexpr (K::taylor) q += r0.moment[i] + r1.moment[j] + r2.moment[l];
            if constexpr (component == 0) sign = r0.sign[i];
            if constexpr (component == 1) sign = r1.sign[j];
            if constexpr (component == 2) sign = r2.sign[l];
            at(visit, line + r2.node[l], w * r2.weight[l] * q, sign, {i, j, l});
          });
        }
      });
    });
  }

  template <class Visit>
  [[gnu::always_inline]] static void at(Visit& visit, index flat, double w, double sign, std::array<int, D> k) {
    if constexpr (std::is_invocable_v<Visit&, index, double, double, const std::array<int, D>&>)
      visit(flat, w, sign, k);
    else
      visit(flat, w, sign);
  }
  // From the particle to the node k nodes after the first, along each axis [m].
  template <int component>
  std::array<double, D> distance(const Grid<D>& g, const std::array<int, D>& k) const {
    std::array<double, D> r;
    each_of<D>([&](auto b) { r[b] = (along<component, b>().first + k[b]) * g.h[b]; });
    return r;
  }

  // Value of a field at the particle, given at the same nodes. A kernel that is not normalised is divided by the sum of
  // its weights.
  template <int component, class Field>
  [[gnu::always_inline]] double gather(const std::array<index, D>& stride, const Field& field) const {
    double value = 0.0, sum = 0.0;
    each<component>(stride, [&](index f, double w, double sign) {
      value += w * sign * field[f];
      sum += w;
    });
    return K::normalised ? value : value / sum;
  }
  // Sum of the weights: 1 for a normalised kernel.
  template <int component>
  double total() const {
    if constexpr (K::normalised) return 1.0;
    double sum = 0.0;
    each<component>({}, [&](index, double w, double) { sum += w; });
    return sum;
  }
};

// The cell of a point, and whether the point is anywhere near the tank.
struct Place {
  index cell;   // the nearest one, for a point outside the tank
  bool inside;  // no farther from the tank than it is long; false after a flow blew up, and for NaN
};

// The cell that holds the point x (D,) [m].
template <int D>
[[gnu::always_inline]] inline Place place_of(const Grid<D>& g, const double* x) {
  Place place{0, true};
  for (int a = 0; a < D; ++a) {
    const double s = x[a] / g.h[a], n = static_cast<double>(g.shape[a]);
    place.inside &= s >= -n && s <= 2.0 * n;  // not so for NaN
    index i = floor_index(s);
    i = i < 0 ? 0 : (i >= g.shape[a] ? g.shape[a] - 1 : i);
    place.cell = place.cell * g.shape[a] + i;
  }
  return place;
}

// The cell of the particle at x, whose stencil this is.
template <class K, int D>
[[gnu::always_inline]] inline index cell_of(const Grid<D>& g, const Stencil<K, D>& st, const double* x) {
  if constexpr (!std::is_same_v<K, LinearKernel>) return place_of<D>(g, x).cell;
  index cell = 0;
  for (int a = 0; a < D; ++a) cell = cell * g.shape[a] + std::min(st.face[a].node[0], g.shape[a] - 1);
  return cell;
}

// Strides of the face fields of all axes.
template <int D>
inline std::array<std::array<index, D>, D> face_strides(const Grid<D>& g) {
  std::array<std::array<index, D>, D> stride;
  for (int a = 0; a < D; ++a) stride[a] = Grid<D>::strides(g.face_shape(a));
  return stride;
}

}  // namespace houle
