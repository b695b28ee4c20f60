// Forces, projection and extrapolation on the faces of the MAC grid.
#pragma once

#include "surface.hpp"

namespace houle {

// The porous medium as the faces see it (null pointers: clear water everywhere).
template <int D>
struct Resistance {
  ConstFaces<D> inertia;      // <C_r / n>
  ConstFaces<D> darcy;        // <a> [1/s], per Darcy velocity
  ConstFaces<D> forchheimer;  // <b> [1/m]
  const double* inverse_n2 = nullptr;  // cells <1/n^2>
};

// Velocity of the faces of all axes averaged to face i of axis a, for the magnitude in the Forchheimer term.
template <int D>
inline double other_component(const Grid<D>& g, int a, int b, const std::array<index, D>& i, const double* v) {
  const auto shape = g.face_shape(b);
  const auto stride = Grid<D>::strides(shape);
  double sum = 0.0;
  int count = 0;
  for (int da = -1; da <= 0; ++da)
    for (int db = 0; db <= 1; ++db) {
      auto j = i;
      j[a] += da;
      if (g.periodic[a]) j[a] = (j[a] + g.shape[a]) % g.shape[a];
      if (j[a] < 0 || j[a] >= g.shape[a]) continue;
      j[b] += db;
      sum += v[Grid<D>::flat(j, stride)];
      ++count;
    }
  return count ? sum / count : 0.0;
}

// (1 - exp(-y)) / y
inline double phi1(double y) { return y < 1e-8 ? 1.0 - 0.5 * y : -std::expm1(-y) / y; }

// Body forces, porous resistance and Bernoulli term over one step, the pressure left for the projection (paper (13)):
//
//   C_r/n du/dt = f - (a + b |u| + sigma) u - grad p,    sigma = 1/2 u . grad(1/n^2)
//
// by the exponential Rosenbrock-Euler step (Hochbruck & Ostermann 2010), exact for linear drag, of second order for
// quadratic drag, with the exact steady state for any dt:  u1 = u0 + Phi dt c (f - grad p - R u0),  c = 1/<C_r/n>,
// Phi = phi1(dt c J),  J = a + b (|u| + u_a^2/|u|) + 2 max(sigma, 0).
// Out, per face: star = u0 + Phi dt c (f - R u0); drag = 1 - Phi dt c R, so star = drag u0 + Phi dt c f;
// mobility = Phi dt c [s], the factor of grad p in the projection (15), (16);
// resisted = Phi dt c (a + b |u|), the share of u0 that the drag takes, for the ledger (not written in clear water).
// extra: further acceleration on the faces [m/s2] (waves, viscosity), null if none; gravity (D,).
template <int D>
inline void apply_forces(const Grid<D>& g, ConstFaces<D> u, const Resistance<D>& medium, const double* gravity,
                         ConstFaces<D> extra, double dt, Faces<D> star, Faces<D> drag, Faces<D> mobility,
                         Faces<D> resisted) {
  const auto cell_stride = Grid<D>::strides(g.shape);
  for (int a = 0; a < D; ++a) {
    const double force = gravity[a];
    const double *ua = u[a], *ex = extra[a];
    double *us = star[a], *dr = drag[a], *mo = mobility[a], *re = resisted[a];
    if (!medium.inverse_n2) {
      parallel_for(g.faces(a), [=](index f) {
        us[f] = ua[f] + dt * (force + (ex ? ex[f] : 0.0));
        dr[f] = 1.0;
        mo[f] = dt;
      });
      continue;
    }
    const double *inertia = medium.inertia[a], *A = medium.darcy[a], *B = medium.forchheimer[a];
    const double* m = medium.inverse_n2;
    const auto shape = g.face_shape(a);
    parallel_for(g.faces(a), [=](index f) {
      const auto i = Grid<D>::unflat(f, shape);
      double v[D];
      double speed2 = 0.0;
      for (int b = 0; b < D; ++b) {
        v[b] = b == a ? ua[f] : other_component<D>(g, a, b, i, u[b]);
        speed2 += v[b] * v[b];
      }
      // grad(1/n^2): across the face in its own axis, central in the others, zero gradient at walls
      double sigma = 0.0;
      index side[2];
      for (int s = 0; s < 2; ++s) {
        index k = i[a] - 1 + s;
        if (g.periodic[a]) k = (k + g.shape[a]) % g.shape[a];
        side[s] = k < 0 ? 0 : (k >= g.shape[a] ? g.shape[a] - 1 : k);
      }
      for (int b = 0; b < D; ++b) {
        double slope = 0.0;
        auto j = i;
        if (b == a) {
          j[a] = side[1];
          slope = m[Grid<D>::flat(j, cell_stride)];
          j[a] = side[0];
          slope = (slope - m[Grid<D>::flat(j, cell_stride)]) / g.h[a];
        } else {
          for (int s = 0; s < 2; ++s) {
            j[a] = side[s];
            index up = i[b] + 1, down = i[b] - 1;
            if (g.periodic[b]) up %= g.shape[b], down = (down + g.shape[b]) % g.shape[b];
            j[b] = up < g.shape[b] ? up : g.shape[b] - 1;
            slope += m[Grid<D>::flat(j, cell_stride)];
            j[b] = down >= 0 ? down : 0;
            slope -= m[Grid<D>::flat(j, cell_stride)];
          }
          slope /= 4.0 * g.h[b];
        }
        sigma += 0.5 * v[b] * slope;
      }
      const double speed = std::sqrt(speed2), c = 1.0 / inertia[f];
      const double R = A[f] + B[f] * speed + sigma;
      const double J = A[f] + B[f] * (speed + (speed > 0.0 ? v[a] * v[a] / speed : 0.0)) + (sigma > 0.0 ? 2.0 * sigma : 0.0);
      const double step = phi1(dt * c * J) * dt * c;
      dr[f] = 1.0 - step * R;
      mo[f] = step;
      re[f] = step * (A[f] + B[f] * speed);
      us[f] = ua[f] * dr[f] + step * (force + (ex ? ex[f] : 0.0));
    });
  }
}

// Coefficients of the pressure system (15) at the true sub-cell surface:
//   sum_f k_f (p_c - p_nb) + e_c p_c = -(1/h) sum of the net outflux of `star`   [1/s], p = pressure / density.
// k = open mobility / h^2 on every face; e (cells): faces from an active cell to air, k / theta. mobility or star may be
// null: then 1, and no right-hand side (the position correction). least: lower bound of theta.
template <int D>
inline void pressure_system(const Grid<D>& g, const std::uint8_t* active, const double* depth, ConstFaces<D> open,
                            ConstFaces<D> mobility, ConstFaces<D> star, double least, Faces<D> k, double* e,
                            double* rhs) {
  const auto stride = Grid<D>::strides(g.shape);
  for (int a = 0; a < D; ++a) {
    const double *o = open[a], *mo = mobility[a];
    double* ka = k[a];
    const double h2 = 1.0 / (g.h[a] * g.h[a]);
    parallel_for(g.faces(a), [=](index f) { ka[f] = o[f] * (mo ? mo[f] : 1.0) * h2; });
  }
  parallel_for(g.cells(), [=](index c) {
    e[c] = 0.0;
    if (star[0]) rhs[c] = 0.0;
    if (!active[c]) return;
    const auto i = Grid<D>::unflat(c, g.shape);
    double air = 0.0, flux = 0.0;
    for (int a = 0; a < D; ++a) {
      auto face_stride = Grid<D>::strides(g.face_shape(a));
      const index low = Grid<D>::flat(i, face_stride), high = low + face_stride[a];
      for (int s = 0; s < 2; ++s) {
        const index f = s ? high : low;
        index n = i[a] + (s ? 1 : -1);
        if (g.periodic[a]) n = (n + g.shape[a]) % g.shape[a];
        const bool wall = n < 0 || n >= g.shape[a];
        if (star[0] && !wall) flux += (s ? 1.0 : -1.0) * open[a][f] * star[a][f] / g.h[a];
        if (wall) continue;
        const index nb = c + (n - i[a]) * stride[a];
        if (!active[nb] && k[a][f] > 0.0) air += k[a][f] / surface_fraction(depth[c], depth[nb], least);
      }
    }
    e[c] = air;
    if (star[0]) rhs[c] = -flux;
  });
}

// Takes the pressure gradient off the faces that touch an active cell, and closes the others (16). In place on u = star.
// valid (faces): 1 where the velocity is now known (touches an active cell, or a wall), else 0. mobility null: 1.
template <int D>
inline void project(const Grid<D>& g, const std::uint8_t* active, const double* depth, ConstFaces<D> open,
                    ConstFaces<D> mobility, const double* p, double least, Faces<D> u,
                    const std::array<std::uint8_t*, D>& valid) {
  for (int a = 0; a < D; ++a) {
    const double *o = open[a], *mo = mobility[a];
    double* ua = u[a];
    std::uint8_t* known = valid[a];
    const double h = g.h[a];
    each_face(g, a, [=](index f, index low, index high) {
      if (low < 0 || high < 0) {
        ua[f] = 0.0;
        known[f] = 1;
        return;
      }
      const bool wet_low = active[low], wet_high = active[high];
      known[f] = (wet_low || wet_high) && o[f] > 0.0;
      if (!known[f]) return;
      const double step = (mo ? mo[f] : 1.0) / h;
      if (wet_low && wet_high) {
        ua[f] -= step * (p[high] - p[low]);
      } else if (wet_low) {
        ua[f] += step * p[low] / surface_fraction(depth[low], depth[high], least);
      } else {
        ua[f] -= step * p[high] / surface_fraction(depth[high], depth[low], least);
      }
    });
  }
}

// max |div u| over the active cells [1/s]
template <int D>
inline double max_divergence(const Grid<D>& g, const std::uint8_t* active, ConstFaces<D> open, ConstFaces<D> u) {
  return parallel_max(g.cells(), [=](index c) {
    if (!active[c]) return 0.0;
    const auto i = Grid<D>::unflat(c, g.shape);
    double flux = 0.0;
    for (int a = 0; a < D; ++a) {
      const auto stride = Grid<D>::strides(g.face_shape(a));
      const index low = Grid<D>::flat(i, stride), high = low + stride[a];
      const bool wall_low = !g.periodic[a] && i[a] == 0, wall_high = !g.periodic[a] && i[a] == g.shape[a] - 1;
      flux += ((wall_high ? 0.0 : open[a][high] * u[a][high]) - (wall_low ? 0.0 : open[a][low] * u[a][low])) / g.h[a];
    }
    return std::abs(flux);
  });
}

// Carries known face values outwards, `layers` faces deep, each the mean of its known neighbours. known (faces): 1
// known, 0 not; on return layer numbers + 1. After `near` layers, faces with mass > keep_mass count as known as they
// are: spray too far from the water for its pressure flies on. mass null: no such faces.
template <int D>
inline void extrapolate(const Grid<D>& g, int layers, int near, ConstFaces<D> mass, double keep_mass, Faces<D> u,
                        const std::array<std::uint8_t*, D>& known) {
  for (int a = 0; a < D; ++a) {
    const auto shape = g.face_shape(a);
    const auto stride = Grid<D>::strides(shape);
    double* ua = u[a];
    std::uint8_t* k = known[a];
    const double* m = mass[a];
    for (int layer = 1; layer <= layers; ++layer) {
      const std::uint8_t mark = static_cast<std::uint8_t>(layer + 1);
      parallel_for(g.faces(a), [=](index f) {
        if (k[f]) return;
        if (m && layer == near + 1 && m[f] > keep_mass) {
          k[f] = mark;
          return;
        }
        const auto i = Grid<D>::unflat(f, shape);
        double sum = 0.0;
        int count = 0;
        for (int b = 0; b < D; ++b)
          for (int s = -1; s <= 1; s += 2) {
            index j = i[b] + s;
            const index period = g.shape[b];
            if (g.periodic[b]) j = (j + period) % period;
            if (j < 0 || j >= shape[b]) continue;
            const index n = f + (j - i[b]) * stride[b];
            if (k[n] && k[n] < mark) sum += ua[n], ++count;
          }
        if (!count) return;
        ua[f] = sum / count;
        k[f] = mark;
      });
    }
    parallel_for(g.faces(a), [=](index f) { if (!k[f]) ua[f] = 0.0; });
  }
  close_periodic(g, u);
}

// Above the surface of single-valued columns (`column` not NaN), the vertical velocity that keeps div u = 0 with the
// horizontal velocities carried there: the water between the last pressure cell and the surface must not be squeezed.
// Overwrites `layers` faces above the topmost active cell of each column.
template <int D>
inline void continue_upwards(const Grid<D>& g, int layers, const std::uint8_t* active, const double* column,
                             Faces<D> u) {
  constexpr int up = D - 1;
  const index nz = g.shape[up], columns = g.cells() / nz;
  std::array<index, D> shape = g.shape;
  shape[up] = 1;
  parallel_for(
      columns,
      [=](index c) {
        if (std::isnan(column[c])) return;
        index top = nz - 1;
        while (top >= 0 && !active[c * nz + top]) --top;
        if (top < 0) return;
        auto i = Grid<D>::unflat(c, shape);
        for (index k = top + 1; k < std::min(top + 1 + layers, nz - 1); ++k) {
          i[up] = k;
          double squeeze = 0.0;
          for (int a = 0; a < up; ++a) {
            const auto stride = Grid<D>::strides(g.face_shape(a));
            const index f = Grid<D>::flat(i, stride);
            squeeze += (u[a][f + stride[a]] - u[a][f]) / g.h[a];
          }
          const index f = c * (nz + 1) + k;
          u[up][f + 1] = u[up][f] - g.h[up] * squeeze;
        }
      },
      64);
}

}  // namespace houle
