// Water that crosses from one porosity to another: the faces where the pressure holds it, and its energy where nothing
// does.
//
// Water of porosity n and inertia J = C_r/n has the kinetic energy 1/2 V s^2 u_d^2 per density, s^2 = J/n = C_r/n^2.
// Deep under water, pressure on both sides of a face holds the flux ("held" faces): there the Bernoulli force of
// forces.hpp speeds the water up or slows it down. A particle that no pressure holds keeps its energy by itself: s u_d
// stays, whatever the step (docs/decisions/0015).
#pragma once

#include <vector>

#include <houle/water/forces.hpp>
#include <houle/water/solids.hpp>
#include <houle/water/transfer.hpp>

namespace houle {

// The medium as particles that cross it meet it.
template <int D>
struct Crossing {
  ConstFaces<D, std::int32_t> number;  // row of each face in the table
  const Material* table;
  Listed inertia;                    // cells: J of all faces that a particle there sees; 0: several
  Listed uniform;                    // the same; 0 also where a particle meets several porosities
  ConstFaces<D, std::uint8_t> held;  // faces: 1 where the Bernoulli force acts
  Interfaces<D> media{};
};

// visit(axis, face, weight) for the faces as the particle at x sees them.
template <int D, class Visit>
inline void each_seen(const Grid<D>& g, const Stencil<LinearKernel, D>& st,
                      const std::array<std::array<index, D>, D>& stride, const Interfaces<D>& media, const double* x,
                      Visit visit) {
  const auto own = [&](const Beside<D>& beside) {
    beside.each([&](int a, index f, double w, double, const auto&) { visit(a, f, w); });
  };
  if (!beside_interface<LinearKernel, D>(g, stride, media, st, x, {}, own))
    each_of<D>([&](auto a) { st.template each<a>(stride[a], [&](index f, double w, double) { visit(a, f, w); }); });
}

// Inertia J (D,) at x along each axis, linear from the faces around: with these weights the step from particles to
// faces makes no energy.
template <int D>
HOULE_NOINLINE inline void sample_inertia(const Grid<D>& g, const Crossing<D>& medium,
                                          const Stencil<LinearKernel, D>& st, const double* x, float* inertia) {
  double sum[D] = {};
  each_seen<D>(g, st, face_strides(g), medium.media, x,
               [&](auto a, index f, double w) { sum[a] += w * medium.table[medium.number[a][f]].inertia; });
  for (int a = 0; a < D; ++a) inertia[a] = static_cast<float>(sum[a]);
}

// The medium at a particle of volume V at x in this cell. Returns its bulk volume V/n, n linear between cell centres;
// writes its inertia J (D,).
template <int D>
inline double sample_one(const Grid<D>& g, const Crossing<D>& medium, const Listed& porosity,
                         const Stencil<LinearKernel, D>& st, index cell, const double* x, double volume,
                         float* inertia) {
  if (const double one = medium.inertia[cell]; one > 0.0)
    std::fill_n(inertia, D, static_cast<float>(one));
  else
    sample_inertia(g, medium, st, x, inertia);
  return medium.uniform[cell] > 0.0 ? volume / porosity[cell]
                                    : volume / st.template gather<-1>(Grid<D>::strides(g.shape), porosity);
}

// The medium at all particles: bulk volume V/n (n,) and inertia J (n, D).
template <int D>
void sample_medium(const Grid<D>& g, index n, const Crossing<D>& medium, const Listed& porosity, const double* x,
                   const double* volume, double* bulk, float* inertia) {
  parallel_for(n, [=](index p) {
    const double* at = x + D * p;
    const index cell = place_of<D>(g, at).cell;
    if (const double one = medium.uniform[cell]; one > 0.0) {
      bulk[p] = volume[p] / porosity[cell];
      std::fill_n(inertia + D * p, D, static_cast<float>(one));
      return;
    }
    Stencil<LinearKernel, D> st;
    st.set(g, at);
    bulk[p] = sample_one(g, medium, porosity, st, cell, at, volume[p], inertia + D * p);
  });
}

// Marks the held faces, held (faces): 1 between two cells with no air around them whose contrast (cells), the ratio of
// C_r/n^2 nearby, is above 1 and no more than `most`. There the pressure on both sides holds the normal flux, and the
// Bernoulli force acts.
template <int D>
void hold_faces(const Grid<D>& g, const std::uint8_t* active, const Listed& open, const Listed& contrast, double most,
                const std::array<std::uint8_t*, D>& held) {
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(g.cells()));
  std::uint8_t* deep = cells.data();
  parallel_for(g.cells(), [=](index c) {
    const double ratio = contrast[c];
    deep[c] = ratio > 1.0 && ratio <= most && active[c] && without_air(g, active, open, c);
  });
  const auto stride = Grid<D>::strides(g.shape);
  for (int a = 0; a < D; ++a) {  // the faces across axis a in lines along it, or along the others
    const index inner = stride[a], n = g.shape[a], end = g.periodic[a] ? 0 : (n - 1) * inner;
    const index begin = g.periodic[a] ? (n - 1) * inner : 0;
    std::uint8_t* out = held[a];
    parallel_for(
        g.cells() / (n * inner) * (n + 1),
        [=](index r) {
          const index block = r / (n + 1), i = r % (n + 1);
          const std::uint8_t* cell = deep + block * n * inner;
          const std::uint8_t *low = cell + (i > 0 ? (i - 1) * inner : begin), *high = cell + (i < n ? i * inner : end);
          for (index k = 0; k < inner; ++k) out[r * inner + k] = low[k] & high[k];
        },
        16);
  }
}

// Share of the faces that a particle sees along axis a that is held: so much of the Bernoulli force it feels there.
template <int a, int D>
inline double held_share(const Stencil<LinearKernel, D>& st, const std::array<std::array<index, D>, D>& stride,
                         const ConstFaces<D, std::uint8_t>& held) {
  double share = 0.0;
  st.template each<a>(stride[a], [&](index f, double w, double) { share += w * held[a][f]; });
  return share;
}

// Turns the velocity u (D) of a particle with that stencil as C_r changes on its way. coefficient (cells): C_r;
// factor (D): s^2; way: dt / (2 n).
template <int D>
inline void turn(const Grid<D>& g, const Stencil<LinearKernel, D>& st, const Listed& coefficient, double way,
                 const double* factor, double* u) {
  const auto cells = Grid<D>::strides(g.shape);
  double C = 0.0, slope[3] = {}, one = 0.0;
  bool same = true;
  st.template each<-1>(cells, [&](index c, double, double, const auto&) {
    one = one > 0.0 ? one : coefficient[c];
    same &= coefficient[c] == one;
  });
  if (same) return;
  st.template each<-1>(cells, [&](index c, double weight, double, const std::array<int, D>& k) {
    C += weight * coefficient[c];
    for (int a = 0; a < D; ++a) {
      const double own = st.centre[a].weight[k[a]];  // 0 of one of the two cells where a particle lies on a centre
      double others = own > 0.0 ? weight / own : 1.0;
      for (int b = 0; b < D && own == 0.0; ++b) others *= b == a ? 1.0 : st.centre[b].weight[k[b]];
      slope[a] += (k[a] ? 1.0 : -1.0) * others * coefficient[c] / g.h[a];
    }
  });
  const double rate = way / C;  // dw/dt = rate (slope (w.u) - u (w.slope)) / dt, w = s u
  double v[3] = {}, w[3] = {}, s[3], axis[3], half[3];
  for (int a = 0; a < D; ++a) s[a] = std::sqrt(factor[a]), v[a] = u[a], w[a] = s[a] * u[a];
  const auto cross = [](const double* p, const double* q, int a) {
    return p[(a + 1) % 3] * q[(a + 2) % 3] - p[(a + 2) % 3] * q[(a + 1) % 3];
  };
  for (int a = 0; a < 3; ++a) axis[a] = rate * cross(v, slope, a);
  const double size = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
  for (int a = 0; a < 3; ++a) half[a] = w[a] + 0.5 * cross(axis, w, a);  // Boris (1970): a rotation to round-off
  for (int a = 0; a < D; ++a) u[a] = (w[a] + cross(axis, half, a) / (1.0 + 0.25 * size)) / s[a];
}

// The work of carry() on one particle, which has moved to x in this cell.
template <int D>
HOULE_NOINLINE inline void carry_one(const Grid<D>& g, const Crossing<D>& medium, const Listed& porosity,
                                     const Listed& coefficient, const Listed& lag, double ago, double dt, index cell,
                                     const double* x, double volume, double& bulk, float* inertia, double* u) {
  const auto stride = face_strides(g);
  Stencil<LinearKernel, D> st;
  st.set(g, x);
  double before[D], now[D], ratio = 1.0, root = 1.0;
  for (int a = 0; a < D; ++a) before[a] = inertia[a] * (bulk / volume) * ago;
  bulk = sample_one(g, medium, porosity, st, cell, x, volume, inertia);
  const double along = lag ? 1.0 - st.template gather<-1>(Grid<D>::strides(g.shape), lag) : 1.0;
  each_of<D>([&](auto a) {
    now[a] = inertia[a] * (bulk / volume) * along;
    if (now[a] == before[a]) return;
    const double free = 1.0 - held_share<a, D>(st, stride, medium.held);
    if (free < 1e-12) return;
    if (const double change = before[a] / now[a]; change != ratio) ratio = change, root = std::sqrt(change);
    u[a] *= free == 1.0 ? root : std::pow(ratio, 0.5 * free);
  });
  if (dt != 0.0) turn(g, st, coefficient, 0.5 * dt * (bulk / volume) * along, now, u);
}

// Takes the medium and the energy of particles along after they have moved to x. bulk (n,) and inertia (n, D): on entry
// those of the old places, on return those of the new ones. Where nothing holds a particle it keeps s u_d. Where C_r
// changes, its velocity turns: C_r u along an interface is kept, which is a rotation of s u_d at the rate u x grad C_r
// / (2 C_r), exact in energy.
//
// coefficient (cells): C_r; dt: duration of the motion, 0 if the particles have moved but not in time. Where the
// convective acceleration has a coefficient K of its own, coefficient is K, lag (cells) 1 - K/C_r and ago (n,) K/C_r at
// the old places, else both null: K then stands for C_r in s and in what turns.
template <int D>
void carry(const Grid<D>& g, index n, const Crossing<D>& medium, const Listed& porosity, const Listed& coefficient,
           const Listed& lag, const double* ago, double dt, const double* x, const double* volume, double* bulk,
           float* inertia, double* u) {
  parallel_for(n, [=](index p) {
    const double* at = x + D * p;
    const index cell = place_of<D>(g, at).cell;
    float* J = inertia + D * p;
    if (const double one = medium.uniform[cell]; one > 0.0 && !ago) {
      bool same = bulk[p] == volume[p] / porosity[cell];
      for (int a = 0; a < D; ++a) same &= J[a] == static_cast<float>(one);
      if (same) return;
    }
    carry_one(g, medium, porosity, coefficient, lag, ago ? ago[p] : 1.0, dt, cell, at, volume[p], bulk[p], J,
              u + D * p);
  });
}

// The surroundings of a point: velocity of the faces, linear, their least and largest inertia, and the share of them
// that is held.
template <int D>
struct Around {
  double velocity[D] = {}, least[D], most[D] = {}, held[D] = {};

  Around(const Grid<D>& g, const Crossing<D>& medium, const std::array<std::array<index, D>, D>& stride,
         ConstFaces<D> u, const double* x) {
    Stencil<LinearKernel, D> st;
    st.set(g, x);
    std::fill(least, least + D, 1e300);
    each_seen<D>(g, st, stride, medium.media, x, [&](auto a, index f, double w) {
      if (w == 0.0) return;
      const double J = medium.table[medium.number[a][f]].inertia;
      velocity[a] += w * u[a][f];
      least[a] = std::min(least[a], J);
      most[a] = std::max(most[a], J);
      held[a] += w * medium.held[a][f];
    });
  }
};

// Change of the velocity on faces, change [m/s], while water moves for dt in bodies where the added mass does not stand
// before the convective acceleration: C_r du/dt + K (u . grad) u = C_r (d/dt + (1 - lag) u . grad) u with lag = 1 -
// K/C_r (cells).
//
// Momentum goes with 1 - lag of the velocity of the water. So water on a face at x finds the velocity that is `lag` of
// its way ahead, and changes by u(y) - u(x), with y by the midpoint rule (19). u(y) is taken by M4' in all directions,
// third order, which makes no wave larger, however long the step: |sum_k M4'(f - k) exp(i k phi)| <= 1 for all f and
// phi. Where other media are among those faces it is linear from the faces on the side of y, and between different
// inertias it counts in the share that is held. porosity (cells): that of the particles.
template <int D>
void fall_behind(const Grid<D>& g, const Crossing<D>& medium, const Listed& lag, const Listed& porosity,
                 ConstFaces<D> u, double dt, Faces<D> change) {
  const auto stride = face_strides(g);
  const auto cells = Grid<D>::strides(g.shape);
  each_of<D>([&](auto axis) {
    constexpr int a = decltype(axis)::value;
    const std::int32_t* number = medium.number[a];
    const double* ua = u[a];
    const std::uint8_t* held = medium.held[a];
    double* out = change[a];
    parallel_for(g.faces(a), [=](index f) {
      out[f] = 0.0;
      const auto i = Grid<D>::unflat(f, g.face_shape(a));
      double x[D], y[D];
      for (int b = 0; b < D; ++b) x[b] = y[b] = (static_cast<double>(i[b]) + (b == a ? 0.0 : 0.5)) * g.h[b];
      Stencil<LinearKernel, D> st;
      st.set_centres(g, x);
      const double share = st.template gather<-1>(cells, lag);
      if (!(share > 0.0)) return;
      for (const double time : {0.5 * dt, dt}) {
        const Around<D> at(g, medium, stride, u, y);
        st.set_centres(g, y);
        const double way = time * share / st.template gather<-1>(cells, porosity);
        for (int b = 0; b < D; ++b) y[b] = x[b] + way * at.velocity[b];
        bring_into_tank(g, y);
      }
      Stencil<M4PrimeKernel, D> wide;
      wide.set(g, y);
      double ahead = 0.0;
      bool one = true;
      wide.template each<a>(stride[a], [&](index k, double w, double sign) {
        ahead += w * sign * ua[k];
        one &= w == 0.0 || number[k] == number[f];
      });
      if (one) {
        out[f] = ahead - ua[f];
        return;
      }
      const double J = medium.table[number[f]].inertia;
      const Around<D> there(g, medium, stride, u, y);
      const bool same = there.least[a] == J && there.most[a] == J;
      const double part = same ? 1.0 : std::min(static_cast<double>(held[f]), there.held[a]);
      out[f] = part * (there.velocity[a] - ua[f]);
    });
  });
}

// Settles the velocities of particles that see faces of different inertia, on their own side of an interface or beyond.
// They become linear from the faces that are seen, whatever the transfer. Where nothing holds a particle it gets no
// more energy than those faces have, J_p u_p^2 <= sum_f w_fp J_f u_f^2 with J_p = sum_f w_fp J_f. (Else a face of much
// inertia and little speed beside one of little inertia and much speed makes energy, and so does what FLIP keeps.)
// affine (n, D, D): a gradient is kept to the share that is held; may be null.
template <int D>
void settle(const Grid<D>& g, index n, const Crossing<D>& medium, ConstFaces<D> velocity, const double* x, double* u,
            double* affine) {
  const auto stride = face_strides(g);
  parallel_for(n, [=](index p) {
    if (medium.inertia[place_of<D>(g, x + D * p).cell] > 0.0) return;
    Stencil<LinearKernel, D> st;
    st.set(g, x + D * p);
    bool unlike[D] = {}, any = false;
    each_of<D>([&](auto a) {
      double first = 0.0;
      st.template each<a>(stride[a], [&](index f, double, double) {
        const double J = medium.table[medium.number[a][f]].inertia;
        first = first > 0.0 ? first : J;
        unlike[a] |= J != first;
      });
      any |= unlike[a];
    });
    if (!any) return;
    double mean[D] = {}, inertia[D] = {}, energy[D] = {};
    each_seen<D>(g, st, stride, medium.media, x + D * p, [&](auto a, index f, double w) {
      const double J = medium.table[medium.number[a][f]].inertia, v = velocity[a][f];
      mean[a] += w * v;
      inertia[a] += w * J;
      energy[a] += w * J * v * v;
    });
    each_of<D>([&](auto a) {
      if (!unlike[a]) return;
      const double share = held_share<a, D>(st, stride, medium.held), made = inertia[a] * mean[a] * mean[a];
      u[D * p + a] = mean[a] * (made > energy[a] ? share + (1.0 - share) * std::sqrt(energy[a] / made) : 1.0);
      if (affine)
        for (int b = 0; b < D; ++b) affine[D * D * p + D * a + b] *= share;
    });
  });
}

// Twice the kinetic energy per density of the particles of each cell marked in near (cells), 0 in the others: out
// (cells). The particles may be in any order, so they are added one by one: the sums are the same for any number of
// threads.
template <int D>
void cell_energy(const Grid<D>& g, index n, const std::uint8_t* near, const double* x, const double* bulk,
                 const float* inertia, const double* u, double* out) {
  std::fill_n(out, g.cells(), 0.0);
  for (index p = 0; p < n; ++p) {
    const index cell = place_of<D>(g, x + D * p).cell;
    if (!near[cell]) continue;
    for (index k = D * p; k < D * (p + 1); ++k) out[cell] += bulk[p] * inertia[k] * u[k] * u[k];
  }
}

// Multiplies the velocity of each particle by share (cells) of its cell.
template <int D>
void scale_by_cell(const Grid<D>& g, index n, const double* share, const double* x, double* u) {
  parallel_for(n, [=](index p) {
    const double s = share[place_of<D>(g, x + D * p).cell];
    for (index k = D * p; k < D * (p + 1); ++k) u[k] *= s;
  });
}

}  // namespace houle
