// Smoothed-particle sums over the neighbours of each particle: volume sum, velocity gradient, viscous acceleration.
//
// Particles are sorted by the cells of the grid (cell_start, flat C order). Sums run over the cells within the radius
// of the kernel, however many that are. Behind a wall they meet the mirror images of the particles in front of it, so
// that a full tank is full up to the wall; on a periodic axis they go on at the other side. Each particle gathers for
// itself, its neighbours in a fixed order: the same bits for any number of threads.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include <houle/grid/grid.hpp>

namespace houle {

// A kernel is a function W(r) of compact support `radius` whose integral is 1 in D dimensions. Its slope is -W'(r)/r >=
// 0, finite at r = 0, so that grad_i W(x_i - x_j) = -slope (x_i - x_j).

// The quintic kernel of Wendland (1995): W ~ (1 - q)^4 (1 + 4 q), q = r / radius.
struct WendlandC2 {
  double radius, scale, inverse;
  WendlandC2(int dimension, double support) : radius(support), inverse(1 / support) {
    constexpr double pi = std::numbers::pi;
    scale = dimension == 2 ? 7 / (pi * support * support) : 10.5 / (pi * support * support * support);
  }
  double value(double r) const {
    const double q = r * inverse, s = 1 - q;
    return s > 0 ? scale * s * s * s * s * (1 + 4 * q) : 0.0;
  }
  double slope(double r) const {
    const double s = 1 - r * inverse;
    return s > 0 ? 20 * scale * inverse * inverse * s * s * s : 0.0;
  }
};

// The paper's kernel, W ~ exp(-r^2/eps^2), cut at radius = 3 eps; the scale makes up for the cut.
struct TruncatedGaussian {
  double radius, scale, inverse;  // inverse: 1 / eps
  TruncatedGaussian(int dimension, double support) : radius(support), inverse(3 / support) {
    const double pi = std::numbers::pi, whole = std::pow(inverse / std::sqrt(pi), dimension);
    const double inside = dimension == 2 ? 1 - std::exp(-9.0) : std::erf(3.0) - 6 / std::sqrt(pi) * std::exp(-9.0);
    scale = whole / inside;
  }
  double value(double r) const {
    const double q = r * inverse;
    return q < 3 ? scale * std::exp(-q * q) : 0.0;
  }
  double slope(double r) const { return 2 * inverse * inverse * value(r); }
};

// The water behind a wall, as particles see it: none (free), or mirror images that slip along the wall or do not.
enum class Wall { free, slip, no_slip };

// The walls of each axis: lower side, upper side; unused on periodic axes.
template <int D>
struct Walls {
  std::array<std::array<Wall, 2>, D> side{};
};

// The sorted particles, and how each of them finds those around it.
template <int D>
struct Neighbours {
  Grid<D> grid;
  Walls<D> walls;
  index n = 0;
  const double* x = nullptr;            // (n, D)
  const std::int32_t* start = nullptr;  // (cells + 1,)

  struct Image {               // the particles of a cell as seen across walls and periodic ends
    double sign[D], shift[D];  // position: sign x + shift
    double velocity[D];        // velocity: component times this
  };

  // visit(j, r, |r|, image) for every particle and image with |r| < radius, r = image of x_j - x_i; i itself included
  template <class Visit>
  void each(index i, double radius, Visit visit) const {
    const double* xi = x + i * D;
    index low[D], width[D], boxes = 1;
    for (int a = 0; a < D; ++a) {
      const double beyond = grid.h[a] * static_cast<double>(grid.shape[a] + 1);
      if (!(xi[a] >= -grid.h[a] && xi[a] <= beyond)) return;  // nowhere near the tank: it sees nobody
      low[a] = floor_index((xi[a] - radius) / grid.h[a]);
      width[a] = floor_index((xi[a] + radius) / grid.h[a]) - low[a] + 1;
      boxes *= width[a];
    }
    for (index box = 0; box < boxes; ++box) {
      Image image;
      std::fill(image.velocity, image.velocity + D, 1.0);
      index at[D], cell = 0, rest = box;
      bool seen = true;
      for (int a = D - 1; a >= 0; --a) {
        at[a] = low[a] + rest % width[a];
        rest /= width[a];
      }
      for (int a = 0; a < D && seen; ++a) {
        seen = fold(a, at[a], image);
        cell = cell * grid.shape[a] + at[a];
      }
      if (!seen) continue;
      for (std::int32_t j = start[cell]; j < start[cell + 1]; ++j) {
        double r[D], r2 = 0;
        for (int a = 0; a < D; ++a) {
          r[a] = image.sign[a] * x[j * D + a] + image.shift[a] - xi[a];
          r2 += r[a] * r[a];
        }
        if (r2 < radius * radius) visit(static_cast<index>(j), r, std::sqrt(r2), image);
      }
    }
  }

  // Brings cell index i of axis a inside and notes how its particles are seen from where it was; false: not at all.
  bool fold(int a, index& i, Image& image) const {
    const index n_a = grid.shape[a];
    const double length = grid.h[a] * static_cast<double>(n_a);
    image.sign[a] = 1;
    image.shift[a] = 0;
    if (grid.periodic[a]) {
      const index turns = i >= 0 ? i / n_a : -((n_a - 1 - i) / n_a);
      i -= turns * n_a;
      image.shift[a] = static_cast<double>(turns) * length;
      return true;
    }
    while (i < 0 || i >= n_a) {  // more than once in a tank narrower than the kernel
      const bool upper = i >= n_a;
      const Wall wall = walls.side[a][upper];
      if (wall == Wall::free) return false;
      i = upper ? 2 * n_a - 1 - i : -1 - i;
      // seen from outside: x' = c - x with c = 0 or 2 length, applied before what is already noted
      image.shift[a] += image.sign[a] * (upper ? 2 * length : 0.0);
      image.sign[a] = -image.sign[a];
      for (int b = 0; b < D; ++b)
        if (wall == Wall::no_slip || b == a) image.velocity[b] = -image.velocity[b];
    }
    return true;
  }
};

// Volume sum, paper eq. (14) divided by n rho: out_i = sum_j B_j W(x_i - x_j), B = V/n; 1 in full water
template <int D, class Kernel>
void density_sum(const Neighbours<D>& near, const Kernel& kernel, const double* bulk, double* out) {
  parallel_for(
      near.n,
      [=](index i) {
        double sum = 0;
        near.each(i, kernel.radius,
                  [&](index j, const double*, double r, const auto&) { sum += bulk[j] * kernel.value(r); });
        out[i] = sum;
      },
      64);
}

// The viscous term of paper eq. (3), out (n, D) [m/s2]: sum_j K nu_ij ((u_j - u_i).r / |r|^2) grad_i W B_j with K = 2
// (D + 2) and nu_ij = (nu_i + nu_j)/2. For smooth fields this is div(nu (grad u + grad u^T)) + grad(nu div u): the
// viscous force of a flow without divergence for any nu(x). The harmonic mean agrees with it for smooth nu, but lets an
// eddy viscosity that vanishes at one particle switch off the exchange of momentum with all its neighbours.
template <int D, class Kernel>
void sph_viscous_acceleration(const Neighbours<D>& near, const Kernel& kernel, const double* u, const double* bulk,
                              const double* nu, double* out) {
  constexpr double K = 2 * (D + 2);
  parallel_for(
      near.n,
      [=](index i) {
        double sum[D] = {};
        near.each(i, kernel.radius, [&](index j, const double* r, double distance, const auto& image) {
          double along = 0;
          for (int a = 0; a < D; ++a) along += (image.velocity[a] * u[j * D + a] - u[i * D + a]) * r[a];
          if (!(distance > 0)) return;
          const double f = 0.5 * (nu[i] + nu[j]) * bulk[j] * along / (distance * distance) * kernel.slope(distance);
          for (int a = 0; a < D; ++a) sum[a] += f * r[a];
        });
        for (int a = 0; a < D; ++a) out[i * D + a] = K * sum[a];
      },
      64);
}

// Replaces m (D x D, symmetric positive) by its inverse; false, and m as it was, if its condition is worse than about
// 1e6.
template <int D>
inline bool invert(double (&m)[D][D]) {
  double trace = 0, c[D][D], det;
  for (int a = 0; a < D; ++a) trace += m[a][a] / D;
  if constexpr (D == 2) {
    det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    c[0][0] = m[1][1], c[1][1] = m[0][0], c[0][1] = -m[0][1], c[1][0] = -m[1][0];
  } else {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
        c[b][a] = m[a1][b1] * m[a2][b2] - m[a1][b2] * m[a2][b1];
      }
    det = m[0][0] * c[0][0] + m[0][1] * c[1][0] + m[0][2] * c[2][0];
  }
  if (!(det > 1e-6 * std::pow(trace, D))) return false;
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) m[a][b] = c[a][b] / det;
  return true;
}

// Velocity gradient d u_a / d x_b at the particles, out (n, D, D), exact for linear fields whatever the particles
// (Randles & Libersky 1996); zero where they are too few or in line. Mirror images would bend a linear field: call with
// free walls, the correction needs none.
template <int D, class Kernel>
void velocity_gradient(const Neighbours<D>& near, const Kernel& kernel, const double* u, const double* bulk,
                       double* out) {
  parallel_for(
      near.n,
      [=](index i) {
        double m[D][D] = {}, g[D][D] = {};
        near.each(i, kernel.radius, [&](index j, const double* r, double distance, const auto&) {
          const double w = bulk[j] * kernel.slope(distance);
          for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b) {
              m[a][b] += w * r[a] * r[b];
              g[a][b] += w * (u[j * D + a] - u[i * D + a]) * r[b];
            }
        });
        const bool regular = invert<D>(m);
        for (int a = 0; a < D; ++a)
          for (int b = 0; b < D; ++b) {
            double sum = 0;
            for (int c = 0; c < D && regular; ++c) sum += g[a][c] * m[c][b];
            out[(i * D + a) * D + b] = sum;
          }
      },
      64);
}

}  // namespace houle
