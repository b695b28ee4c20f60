// Transfer kernels: the weights with which a particle and the grid nodes around it see each other, axis by axis.
//
// A kernel has `width` nodes per axis. Along one axis a particle at index coordinate s (node i at i) reaches the nodes
// first(s) .. first(s) + width - 1. weights() writes their weights w; the Taylor Gaussian also writes the second-moment
// terms q, its weight in d dimensions being prod_a w_a (1 + sum_a q_a), paper eqs (8)-(11). `side` is the particle's
// edge length in units of the spacing of that axis, dx_p / (h n^(1/d)): only the Gaussians use it.
#pragma once

#include <cmath>
#include <type_traits>

#include "grid.hpp"

namespace houle {

struct LinearKernel {  // tent: partition of unity, reproduces degree 1
  static constexpr int width = 2;
  static constexpr bool taylor = false;
  static constexpr bool normalised = true;  // the weights sum to 1 for any s
  static index first(double s) { return static_cast<index>(std::floor(s)); }
  static void weights(double s, index i0, double, double* w, double*) {
    const double f = s - static_cast<double>(i0);
    w[0] = 1.0 - f;
    w[1] = f;
  }
};

struct QuadraticKernel {  // quadratic B-spline: C1, reproduces degree 1
  static constexpr int width = 3;
  static constexpr bool taylor = false;
  static constexpr bool normalised = true;
  static index first(double s) { return static_cast<index>(std::floor(s + 0.5)) - 1; }
  static void weights(double s, index i0, double, double* w, double*) {
    const double f = s - static_cast<double>(i0 + 1);  // in [-1/2, 1/2)
    w[0] = 0.5 * (0.5 - f) * (0.5 - f);
    w[1] = 0.75 - f * f;
    w[2] = 0.5 * (0.5 + f) * (0.5 + f);
  }
};

struct M4PrimeKernel {  // Monaghan (1985), paper eq. (7) as a tensor product: reproduces degree 2, has negative weights
  static constexpr int width = 4;
  static constexpr bool taylor = false;
  static constexpr bool normalised = true;
  static double value(double r) {
    const double s = std::abs(r);
    if (s < 1.0) return 1.0 - s * s * (2.5 - 1.5 * s);
    if (s < 2.0) return 0.5 * (2.0 - s) * (2.0 - s) * (1.0 - s);
    return 0.0;
  }
  static index first(double s) { return static_cast<index>(std::floor(s)) - 1; }
  static void weights(double s, index i0, double, double* w, double*) {
    for (int k = 0; k < 4; ++k) w[k] = value(s - static_cast<double>(i0 + k));
  }
};

// Gaussians of standard deviation sigma = 0.6 h (the paper's W ~ exp(-r^2/eps^2) with eps = 0.85 h), cut at 3 nodes;
// not a partition of unity, so transfers divide by the sum of the weights.
struct GaussianBase {
  static constexpr int width = 6;
  static constexpr bool normalised = false;
  static constexpr double sigma = 0.6;
  static index first(double s) { return static_cast<index>(std::floor(s)) - 2; }
};

struct GaussianKernel : GaussianBase {  // the particle is a point
  static constexpr bool taylor = false;
  static void weights(double s, index i0, double, double* w, double*) {
    for (int k = 0; k < width; ++k) {
      const double r = (s - static_cast<double>(i0 + k)) / sigma;
      w[k] = std::exp(-0.5 * r * r);
    }
  }
};

struct GaussianTaylorKernel : GaussianBase {  // the particle is a square of edge `side`, to second order: (10)-(11)
  static constexpr bool taylor = true;
  static void weights(double s, index i0, double side, double* w, double* q) {
    const double moment = side * side / 24.0 / (sigma * sigma);  // (1/2) M20 / M00, times W_xx / W below
    for (int k = 0; k < width; ++k) {
      const double r = (s - static_cast<double>(i0 + k)) / sigma;
      w[k] = std::exp(-0.5 * r * r);
      q[k] = moment * (r * r - 1.0);
    }
  }
};

struct GaussianCellKernel : GaussianBase {  // the exact integral over the particle's square: a difference of erf
  static constexpr bool taylor = false;
  static void weights(double s, index i0, double side, double* w, double*) {
    const double c = 1.0 / (sigma * std::sqrt(2.0));
    for (int k = 0; k < width; ++k) {
      const double r = s - static_cast<double>(i0 + k);
      w[k] = std::erf((r + 0.5 * side) * c) - std::erf((r - 0.5 * side) * c);
    }
  }
};

// A node index brought back into the grid. On a wall axis a node behind the wall is the mirror image of one in front
// of it (sign -1 for the velocity component normal to the wall); on a periodic axis it wraps.
struct Folded {
  index node;
  double sign;
};

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

// The nodes around a particle for a field whose nodes lie on the faces of `component` (-1: at cell centres).
template <class K, int D>
struct Stencil {
  index node[D][K::width];
  double weight[D][K::width];
  double moment[D][K::width];  // q of the Taylor Gaussian
  double sign[K::width];       // of the normal component, along its own axis
  double reach[D];             // from the particle to its first node [m], there where it stands, not where it is folded to
  int component;

  // x: position in metres; side: particle edge in metres
  void set(const Grid<D>& g, int of_component, const double* x, double side) {
    component = of_component;
    for (int a = 0; a < D; ++a) {
      const bool on_faces = a == component;
      const double s = x[a] / g.h[a] - (on_faces ? 0.0 : 0.5);
      const index i0 = K::first(s);
      K::weights(s, i0, side / g.h[a], weight[a], moment[a]);
      reach[a] = (static_cast<double>(i0) - s) * g.h[a];
      const index last = on_faces && !g.periodic[a] ? g.shape[a] : g.shape[a] - 1;
      if (i0 >= 0 && i0 + K::width - 1 <= last) {
        for (int k = 0; k < K::width; ++k) node[a][k] = i0 + k;
        if (on_faces)
          for (int k = 0; k < K::width; ++k) sign[k] = 1.0;
      } else {
        for (int k = 0; k < K::width; ++k) {
          const Folded f = fold(i0 + k, g.shape[a], on_faces, g.periodic[a]);
          node[a][k] = f.node;
          if (on_faces) sign[k] = f.sign;
        }
      }
    }
  }

  // visit(flat node, weight >= 0 or of the kernel's own sign, sign of the mirrored normal component[, offsets k[D]])
  template <class Visit>
  void each(const std::array<index, D>& stride, Visit visit) const {
    if constexpr (D == 2) {
      for (int i = 0; i < K::width; ++i)
        for (int j = 0; j < K::width; ++j) {
          const int k[2] = {i, j};
          at(visit, node[0][i] * stride[0] + node[1][j], k);
        }
    } else {
      for (int i = 0; i < K::width; ++i)
        for (int j = 0; j < K::width; ++j)
          for (int l = 0; l < K::width; ++l) {
            const int k[3] = {i, j, l};
            at(visit, node[0][i] * stride[0] + node[1][j] * stride[1] + node[2][l], k);
          }
    }
  }

  template <class Visit>
  void at(Visit& visit, index flat, const int* k) const {
    if constexpr (std::is_invocable_v<Visit&, index, double, double, const int*>)
      visit(flat, product(k), signed_by(k), k);
    else
      visit(flat, product(k), signed_by(k));
  }

  double product(const int* k) const {
    double w = 1.0;
    for (int a = 0; a < D; ++a) w *= weight[a][k[a]];
    if constexpr (K::taylor) {
      double q = 1.0;
      for (int a = 0; a < D; ++a) q += moment[a][k[a]];
      w *= q;
    }
    return w;
  }
  double signed_by(const int* k) const {
    if constexpr (K::width == 2) return 1.0;  // the linear kernel never reaches behind the wall face
    return component >= 0 ? sign[k[component]] : 1.0;
  }
};

}  // namespace houle
