// Gravity, porous drag and the Bernoulli force on the faces of the MAC grid.
#pragma once

#include <houle/exec/reduce.hpp>
#include <houle/water/surface.hpp>

namespace houle {

// The medium around a face, as means over its box. A tank has few different ones: they stand in a table, and a face has
// the number of its row.
struct Material {
  double inertia;      // <C_r / n>
  double darcy;        // <a> [1/s], per Darcy velocity
  double forchheimer;  // <b> [1/m]
};

// The porous medium as the faces see it.
template <int D>
struct Resistance {
  ConstFaces<D, std::int32_t> number;  // row of each face in the table; null: 0
  const Material* table = nullptr;     // null: clear water everywhere
  ConstFaces<D> rate;                  // further linear resistance of the faces [1/s], null: none
  Listed energy;                       // cells: C_r/n^2; null: 1
  ConstFaces<D, std::uint8_t> held;    // faces: 1 where the Bernoulli force acts; null: everywhere
};

// The surroundings of a row of faces of axis a: for every other velocity component the four faces around each, and the
// cells on both sides. Entry k of the row reads them at kl = low(k), kh = high(k): the cells before and after the face
// if the row runs along a, else both are k. Behind a wall, what is in front of it is read again.
template <int D, int a>
struct FaceRow {
  static constexpr int up = D - 1;
  std::array<const double*, 4> around[D];           // component b: two rows on each side of the face
  std::array<Listed, 2> side, after[D], before[D];  // cells: on both sides, and their neighbours along b

  FaceRow(const Grid<D>& g, const std::array<index, D>& i, const ConstFaces<D>& u, const Listed& cells) {
    const auto stride = Grid<D>::strides(g.shape);
    for (int s = 0; s < 2; ++s) {
      auto j = i;
      if (a != up) j[a] = inside(i[a] - 1 + s, g.shape[a], g.periodic[a]);
      side[s] = at(cells, Grid<D>::flat(j, stride));
      for (int b = 0; b < D; ++b) {
        if (b == a) continue;
        const auto across = Grid<D>::strides(g.face_shape(b));
        around[b][2 * s] = u[b] + Grid<D>::flat(j, across);
        around[b][2 * s + 1] = around[b][2 * s] + across[b];
        if (b == up) continue;
        auto n = j;
        n[b] = inside(i[b] + 1, g.shape[b], g.periodic[b]);
        after[b][s] = at(cells, Grid<D>::flat(n, stride));
        n[b] = inside(i[b] - 1, g.shape[b], g.periodic[b]);
        before[b][s] = at(cells, Grid<D>::flat(n, stride));
      }
    }
  }
  double other(int b, index kl, index kh) const {  // component b, averaged to the face
    return 0.25 * (around[b][0][kl] + around[b][1][kl] + around[b][2][kh] + around[b][3][kh]);
  }
  std::array<double, D> velocity(double own, index kl, index kh) const {  // on the face, whose own component is `own`
    std::array<double, D> v;
    each_of<D>([&](auto b) {
      if constexpr (decltype(b)::value == a)
        v[b] = own;
      else
        v[b] = other(b, kl, kh);
    });
    return v;
  }

 private:
  static Listed at(const Listed& cells, index i) { return cells ? cells + i : Listed{}; }
};

// (1 - exp(-y)) / y, for the small y of most faces by its series sum_k (-y)^k / (k+1)!, to round-off
inline double phi1(double y) {
  if (y > 0.5 || y < -0.5) return -std::expm1(-y) / y;
  constexpr auto over_factorial = [] {  // 1 / (k+1)!
    std::array<double, 14> c{1.0};
    for (std::size_t k = 1; k < c.size(); ++k) c[k] = c[k - 1] / static_cast<double>(k + 1);
    return c;
  }();
  double sum = 0.0;
  for (std::size_t k = over_factorial.size(); k-- > 0;) sum = over_factorial[k] - y * sum;
  return sum;
}

// The rise of twice C_r/n^2 across a face of inertia J, from `before` to `after`: s^2 ln(after / before), s^2 =
// C_r/n^2. A velocity along an interface that water crosses then changes by exp(-1/2 d ln s^2), as s u_d is kept,
// however steep the step. The plain difference changed it by much more: e^3 instead of e^1.3 for n = 0.3. At the face
// s^2 is that of the medium there. It is not known; of the three values around it is the least that such a J allows, as
// s^2 = J/n >= J.
inline double rise(double J, double before, double here, double after) {
  if (before == after) return 0.0;
  double least = std::max({before, here, after});
  for (double s2 : {before, here, after})
    if (s2 >= 2.0 * J * (1.0 - 1e-9)) least = std::min(least, s2);
  return least * std::log(after / before);
}

// Body forces, porous resistance and Bernoulli term over one step, the pressure left for the projection (paper (13)):
//
//   C_r/n du/dt = f - (a + b |u| + sigma) u - grad p,    sigma = 1/2 u . grad(C_r/n^2)
//
// by the exponential Rosenbrock-Euler step (Hochbruck & Ostermann 2010), exact for linear drag, of second order for
// quadratic drag, with the exact steady state for any dt:  u1 = u0 + Phi dt c (f - grad p - R u0),  c = 1/<C_r/n>,
// Phi = phi1(dt c J),  J = a + b (|u| + u_a^2/|u|) + 2 max(sigma, 0).
// Out, per face: star = u0 + Phi dt c (f - R u0); drag = 1 - Phi dt c R, so star = drag u0 + Phi dt c f;
// mobility = Phi dt c [s], the factor of grad p in the projection (15), (16).
// drag may be null; in clear water mobility, which is dt there, too.
// extra: further acceleration on the faces [m/s2] (waves, viscosity), null if none; gravity (D,).
template <int D>
void apply_forces(const Grid<D>& g, ConstFaces<D> u, const Resistance<D>& medium, const double* gravity,
                  ConstFaces<D> extra, double dt, Faces<D> star, Faces<D> drag, Faces<D> mobility) {
  each_of<D>([&](auto axis) {
    constexpr int a = decltype(axis)::value, up = D - 1;
    const double force = gravity[a];
    const double *ua = u[a], *ex = extra[a];
    double *us = star[a], *dr = drag[a], *mo = mobility[a];
    if (!medium.table) {
      const double fall = dt * force;
      parallel_for(g.faces(a), [=](index f) {
        us[f] = ex ? ua[f] + dt * (force + ex[f]) : ua[f] + fall;
        if (dr) dr[f] = 1.0;
        if (mo) mo[f] = dt;
      });
      return;
    }
    const std::int32_t* number = medium.number[a];
    const Material* table = medium.table;
    const double* rate = medium.rate[a];
    const Listed cells = medium.energy;
    const std::uint8_t* held = medium.held[a];
    const auto shape = g.face_shape(a);
    const index line = shape[up], nz = g.shape[up];
    const auto face = [=](const FaceRow<D, a>& row, index f, index k) {
      const index kl = a == up ? inside(k - 1, nz, g.periodic[up]) : k,
                  kh = a == up ? inside(k, nz, g.periodic[up]) : k;
      const auto v = row.velocity(ua[f], kl, kh);
      double speed2 = 0.0;
      for (int b = 0; b < D; ++b) speed2 += v[b] * v[b];
      const Material m = table[number ? number[f] : 0];
      const double c = 1.0 / m.inertia, A = m.darcy + (rate ? rate[f] : 0.0);
      double R = A, J = A;
      if (speed2 > 0.0) {
        double sigma = 0.0;  // by grad(C_r/n^2): along a the difference across the face, else rise()
        if (cells && (!held || held[f]))
          each_of<D>([&](auto axis_b) {
            constexpr int b = decltype(axis_b)::value;
            if constexpr (b == a) {
              sigma += 0.5 * v[b] * (row.side[1][kh] - row.side[0][kl]) / g.h[b];
            } else if constexpr (b == up) {
              const index ku = inside(k + 1, nz, g.periodic[up]), kd = inside(k - 1, nz, g.periodic[up]);
              sigma += 0.5 * v[b] *
                       rise(m.inertia, row.side[0][kd] + row.side[1][kd], row.side[0][kl] + row.side[1][kh],
                            row.side[0][ku] + row.side[1][ku]) /
                       (4.0 * g.h[b]);
            } else {
              sigma += 0.5 * v[b] *
                       rise(m.inertia, row.before[b][0][kl] + row.before[b][1][kh], row.side[0][kl] + row.side[1][kh],
                            row.after[b][0][kl] + row.after[b][1][kh]) /
                       (4.0 * g.h[b]);
            }
          });
        if (m.forchheimer > 0.0) {
          const double speed = std::sqrt(speed2);
          R += m.forchheimer * speed;
          J += m.forchheimer * (speed + v[a] * v[a] / speed);
        }
        R += sigma;
        J += sigma > 0.0 ? 2.0 * sigma : 0.0;
      }
      const double step = J == 0.0 ? dt * c : phi1(dt * c * J) * dt * c;  // phi1(0) = 1: clear water
      const double kept = 1.0 - step * R;
      if (dr) dr[f] = kept;
      mo[f] = step;
      us[f] = ua[f] * kept + step * (force + (ex ? ex[f] : 0.0));
    };
    parallel_for(
        g.faces(a) / line,
        [=](index r) {
          const FaceRow<D, a> row(g, Grid<D>::unflat(r, rows_of<D>(shape)), u, cells);
          for (index k = 0; k < line; ++k) face(row, r * line + k, k);
        },
        16);
  });
}

// Energy that the drag took in a step, per unit density: sum_f m_f J_f r_f u0_f (u0_f + u1_f) / 2. Here J = C_r/n, u0 =
// u and u1 = after are the velocities before and after the step, and r = mobility (a + b |u0|) is the share of u0 that
// drag takes; mobility as apply_forces() gave it for u0.
template <int D>
double drag_work(const Grid<D>& g, const Resistance<D>& medium, ConstFaces<D> mass, ConstFaces<D> mobility,
                 ConstFaces<D> u, ConstFaces<D> after) {
  double work = 0.0;
  each_of<D>([&](auto axis) {
    constexpr int a = decltype(axis)::value, up = D - 1;
    const auto shape = g.face_shape(a);
    const index line = shape[up], nz = g.shape[up];
    const double *m = mass[a], *k_a = mobility[a], *u0 = u[a], *u1 = after[a], *rate = medium.rate[a];
    const std::int32_t* number = medium.number[a];
    const Material* table = medium.table;
    const index rows = g.faces(a) / line;
    const auto each = parallel_values(rows, [=](index r) {
      const FaceRow<D, a> row(g, Grid<D>::unflat(r, rows_of<D>(shape)), u, {});
      double sum = 0.0;
      for (index k = 0; k < line; ++k) {
        const index f = r * line + k;
        const Material material = table[number ? number[f] : 0];
        double taken = material.darcy + (rate ? rate[f] : 0.0);
        if (material.forchheimer > 0.0) {
          const index kl = a == up ? inside(k - 1, nz, g.periodic[up]) : k,
                      kh = a == up ? inside(k, nz, g.periodic[up]) : k;
          double speed2 = 0.0;
          for (double v : row.velocity(u0[f], kl, kh)) speed2 += v * v;
          taken += material.forchheimer * std::sqrt(speed2);
        }
        sum += 0.5 * m[f] * material.inertia * k_a[f] * taken * u0[f] * (u0[f] + u1[f]);
      }
      return sum;
    });
    work += parallel_sum(rows, [taken = each.data()](index r) { return taken[r]; });
  });
  return work;
}

}  // namespace houle
