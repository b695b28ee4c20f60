// Particles to grid and back.
//
// Particles are sorted by cell (cell_sort). Scattering runs over slabs of columns along the first axis in two colours,
// so that no two slabs of one colour reach the same node: the order of every sum is fixed, whatever the threads.
#pragma once

#include <houle/exec/reduce.hpp>
#include <houle/exec/scatter.hpp>
#include <houle/exec/sort.hpp>
#include <houle/water/interfaces.hpp>

namespace houle {

// Stable sort by cell: order (n,) the particle to take for each place, start (cells + 1,) the place of the first of
// each cell. cell (n,) is work space. Returns the number of the first particle that is far outside the tank or has no
// position (NaN), -1 if there is none. Such a particle is sorted into the nearest cell, so that nothing is read or
// written elsewhere.
template <int D>
index cell_sort(const Grid<D>& g, index n, const double* x, std::int32_t* cell, std::int32_t* order,
                std::int32_t* start) {
  const index cells = g.cells();
  const index outside = parallel_reduce(
      n, n,
      [=](index p) {
        const Place place = place_of<D>(g, x + D * p);
        cell[p] = static_cast<std::int32_t>(place.cell);
        return place.inside ? n : p;
      },
      [](index a, index b) { return std::min(a, b); });
  counting_sort(n, cells, cell, order, start);
  return outside < n ? outside : -1;
}

// Copies rows of `width` numbers in a given order: to[k] = from[order[k]].
inline void permute(index n, index width, const std::int32_t* order, const double* from, double* to) {
  if (width == 1) {
    parallel_for(n, [=](index k) { to[k] = from[order[k]]; });
  } else if (width == 2) {
    parallel_for(n, [=](index k) {
      for (int a = 0; a < 2; ++a) to[2 * k + a] = from[2 * static_cast<index>(order[k]) + a];
    });
  } else {
    parallel_for(n, [=](index k) {
      for (index a = 0; a < width; ++a) to[width * k + a] = from[width * static_cast<index>(order[k]) + a];
    });
  }
}

// Brings rows of `width` numbers into that order, in place; spare: work space of the same size.
inline void reorder(index n, index width, const std::int32_t* order, double* rows, double* spare) {
  permute(n, width, order, rows, spare);
  parallel_for(n, [=](index k) {
    for (index a = k * width; a < (k + 1) * width; ++a) rows[a] = spare[a];
  });
}

// Puts particles into the order of their cells; spare (n, D) is work space. If one is outside, as cell_sort tells, all
// stay as they were and its number is returned, else -1.
template <int D>
index sort_particles(const Grid<D>& g, index n, double* x, double* u, double* volume, double* spare,
                     std::int32_t* order, std::int32_t* start) {
  const index outside = cell_sort<D>(g, n, x, reinterpret_cast<std::int32_t*>(spare), order, start);
  if (outside >= 0) return outside;
  reorder(n, D, order, x, spare);
  reorder(n, D, order, u, spare);
  reorder(n, 1, order, volume, spare);
  return -1;
}

// Runs slab(p_begin, p_end) over all particles, each slab of columns once, neighbours never at the same time.
template <int D, class Slab>
inline void each_slab(const Grid<D>& g, const std::int32_t* start, const Slab& slab) {
  constexpr index columns = 8;  // at least twice the reach of the widest kernel
  const index nx = g.shape[0], plane = g.cells() / nx, slabs = std::max<index>(1, nx / columns);
  const auto first = [=](index s) { return start[(s == slabs ? nx : s * columns) * plane]; };
  const bool third = g.periodic[0] && slabs % 2 == 1;  // the last around a periodic axis touches the first
  const auto colour = [=](index s) { return third && s == slabs - 1 ? 2 : static_cast<int>(s % 2); };
  parallel_for_coloured(slabs, third ? 3 : 2, colour, [=](index s) { slab(first(s), first(s + 1)); });
}

// Copies the first faces of each periodic axis to the last, which are the same faces.
template <int D>
inline void close_periodic(const Grid<D>& g, const Faces<D>& f) {
  for (int a = 0; a < D; ++a) {
    if (!g.periodic[a]) continue;
    const auto shape = g.face_shape(a);
    const auto stride = Grid<D>::strides(shape);
    const index n = g.faces(a) / shape[a];
    double* data = f[a];
    const index inner = stride[a], outer = stride[a] * shape[a], jump = g.shape[a] * stride[a];
    parallel_for(n, [=](index k) {
      const index base = (k / inner) * outer + k % inner;
      data[base + jump] = data[base];
    });
  }
}

constexpr double mirrored = 3.0;  // cells in front of a paddle whose particles have images behind it

// Calls visit(position) with the image of a particle behind each wall that it is near to.
template <int D, class Visit>
inline void each_image(const Grid<D>& g, const Paddles& paddles, const double* x, Visit visit) {
  for (int k = 0; k < paddles.count; ++k) {
    const double behind = 2.0 * (paddles.paddle[k].x - x[0]);
    if (std::abs(behind) >= 2.0 * mirrored * g.h[0]) continue;
    std::array<double, D> image;
    std::copy(x, x + D, image.begin());
    image[0] += behind;
    visit(image.data());
  }
}

// Calls sum(keep). keep(reach, x) takes what a particle reaches along the first axis, at cell centres, in front of the
// gates.
template <int D, class Sum>
inline void between_gates(const Grid<D>& g, const Gates& gates, const Sum& sum) {
  if (gates.count == 0) {
    sum([](auto&, const double*) {});
    return;
  }
  sum([=](auto& reach, const double* x) {
    reach.keep(compartment_of_cells(g, gates, x), x[0] / g.h[0] - 0.5, g.shape[0], g.periodic[0]);
  });
}

// Sums over particles of weight * amount to cell centres with the tent kernel: out (cells), overwritten. Walls and
// gates fold. A particle near a wall between the faces counts for its mirror image too, so that full water is full up
// to the wall. factor (cells) multiplies the sums; null: 1.
template <int D>
void scatter_cells(const Grid<D>& g, const std::int32_t* start, const double* x, const double* amount,
                   const Paddles& paddles, const Gates& gates, const double* factor, double* out) {
  const auto stride = Grid<D>::strides(g.shape);
  parallel_for(g.cells(), [=](index c) { out[c] = 0.0; });
  const auto sum = [=](auto keep) {
    each_slab(g, start, [=](index begin, index end) {
      for (index p = begin; p < end; ++p) {
        const double v = amount[p];
        const auto add = [=](const double* at) {
          Stencil<LinearKernel, D> st;
          st.set_centres(g, at);
          keep(st.centre[0], at);
          st.template each<-1>(stride, [=](index f, double w, double) { out[f] += w * v; });
        };
        add(x + D * p);
        each_image(g, paddles, x + D * p, add);
      }
    });
  };
  between_gates(g, gates, sum);
  if (factor) parallel_for(g.cells(), [=](index c) { out[c] *= factor[c]; });
}

// Cell field at particle positions, (bi/tri)linear with walls folded: out (n,).
template <int D>
void gather_cells(const Grid<D>& g, index n, const double* x, const double* field, double* out) {
  const auto stride = Grid<D>::strides(g.shape);
  parallel_for(n, [=](index p) {
    Stencil<LinearKernel, D> st;
    st.set_centres(g, x + D * p);
    out[p] = st.template gather<-1>(stride, field);
  });
}

// The particles as a transfer knows them: positions (n, D) [m], edge length `side` (n,) [m] for the Gaussian (null:
// they are points), mass (n,), the weight of the momentum, V/n; start (cells + 1,) as cell_sort gives it. exact: how
// the Gaussian is integrated over a particle.
template <int D>
struct Cloud {
  index n;
  const double* x;
  const double* side;
  const double* mass;
  const std::int32_t* start;
  Interfaces<D> media;
  bool exact = false;
  Edge edge(index p) const { return {side ? side[p] : 0.0, exact}; }
};

// For a particle beside an interface the functions below take the place of the loops of to_faces(), add_residual(),
// to_particles() and affine_from(): the same for all kernels.

// The centre (D, D) of the faces of each axis, as a particle beside an interface sees them, from the particle [m].
template <int D>
inline std::array<std::array<double, D>, D> centre_of_faces(const Grid<D>& g, const Beside<D>& beside) {
  std::array<std::array<double, D>, D> centre{};
  beside.each([&](int a, index, double w, double, const auto& k) {
    const auto r = beside.distance(g, a, k);
    for (int b = 0; b < D; ++b) centre[a][b] += w * r[b];
  });
  return centre;
}

// Adds what it gives to the masses and momenta of the faces; affine (D, D) or null.
template <int D>
void give_beside(const Grid<D>& g, const Beside<D>& beside, double m, const double* u, const double* affine,
                 const Faces<D>& mass, const Faces<D>& momentum) {
  const auto centre = affine ? centre_of_faces(g, beside) : std::array<std::array<double, D>, D>{};
  beside.each([&](int a, index f, double w, double sign, const auto& k) {
    double value = u[a];
    if (affine) {
      const auto r = beside.distance(g, a, k);
      for (int b = 0; b < D; ++b) value += affine[D * a + b] * (r[b] - centre[a][b]);
    }
    mass[a][f] += m * w;
    momentum[a][f] += m * w * sign * value;
  });
}

// Adds to the faces the momentum that it has and they do not show.
template <int D>
void give_residual_beside(const Beside<D>& beside, double m, const double* u, const Faces<D>& velocity,
                          const Faces<D>& work) {
  const auto seen = beside.gather(velocity);
  beside.each(
      [&](int a, index f, double w, double sign, const auto&) { work[a][f] += w * sign * m * (u[a] - seen[a]); });
}

// Its velocity u (D,) from the faces.
template <int D>
void take_beside(const Beside<D>& beside, const ConstFaces<D>& now, const ConstFaces<D>& change,
                 const ConstFaces<D>& drag, double flip, double* u) {
  const auto value = beside.gather(now);
  std::array<double, D> kept{};  // share of the old velocity that drag leaves, then the velocity of FLIP
  if (flip > 0.0) {
    const auto added = beside.gather(change);
    beside.each([&](int a, index f, double w, double, const auto&) { kept[a] += w * drag[a][f]; });
    for (int a = 0; a < D; ++a) kept[a] = kept[a] * u[a] + added[a];
  }
  for (int a = 0; a < D; ++a) u[a] = flip * kept[a] + (1.0 - flip) * value[a];
}

// Solves M x = b for the least squares x.Mx - 2 b.x of some points, M (D, D) being their second moments [cells^2]: by
// elimination with the largest pivots. It ends where the points that are left do not differ: along these axes x is 0.
template <int D>
inline void least_squares(double (&M)[D][D], double (&b)[D], double* x) {
  constexpr double least = 1e-10;  // cells squared
  int order[D], rank = 0;
  for (int k = 0; k < D; ++k) order[k] = k, x[k] = 0.0;
  for (; rank < D; ++rank) {
    int best = rank;
    for (int k = rank + 1; k < D; ++k)
      if (M[order[k]][order[k]] > M[order[best]][order[best]]) best = k;
    std::swap(order[rank], order[best]);
    const int p = order[rank];
    if (!(M[p][p] > least)) break;
    for (int k = rank + 1; k < D; ++k) {
      const int i = order[k];
      const double share = M[i][p] / M[p][p];
      for (int l = rank + 1; l < D; ++l) M[i][order[l]] -= share * M[p][order[l]];
      b[i] -= share * b[p];
    }
  }
  for (int k = rank; k-- > 0;) {
    const int p = order[k];
    double sum = b[p];
    for (int l = k + 1; l < rank; ++l) sum -= M[p][order[l]] * x[order[l]];
    x[p] = sum / M[p][p];
  }
}

// APIC's velocity gradient (D, D) of a particle beside an interface: the gradient of the faces that it sees, about
// their centre and their mean, by least squares. What the particle gives back to them then has no more energy than they
// have. (If it does not see all corners of a box, the moments along different axes are not independent, as they are
// elsewhere.)
template <int D>
void affine_beside(const Grid<D>& g, const Beside<D>& beside, const ConstFaces<D>& velocity, double* affine) {
  const auto mean = beside.gather(velocity);
  const auto centre = centre_of_faces(g, beside);
  double first[D][D] = {}, second[D][D][D] = {};
  beside.each([&](int a, index f, double w, double sign, const auto& k) {
    const auto r = beside.distance(g, a, k);
    double from[D];
    for (int b = 0; b < D; ++b) from[b] = (r[b] - centre[a][b]) / g.h[b];
    for (int b = 0; b < D; ++b) {
      first[a][b] += w * (sign * velocity[a][f] - mean[a]) * from[b];
      for (int c = 0; c < D; ++c) second[a][b][c] += w * from[b] * from[c];
    }
  });
  for (int a = 0; a < D; ++a) {
    least_squares<D>(second[a], first[a], affine + D * a);
    for (int b = 0; b < D; ++b) affine[D * a + b] /= g.h[b];
  }
}

// Mass-weighted mean velocity of the faces, (1/m_f) sum_p m_p w_fp u_p, and the face masses m_f = sum_p m_p w_fp [m^d].
// affine (n, D, D) or null: APIC's velocity gradient, u_p + C_p (x_f - x_p). Faces without mass get 0.
template <class K, int D>
void to_faces(const Grid<D>& g, const Cloud<D>& cloud, const double* u, const double* affine, Faces<D> velocity,
              Faces<D> mass) {
  const auto stride = face_strides(g);
  for (int a = 0; a < D; ++a) {
    double *m = mass[a], *v = velocity[a];
    parallel_for(g.faces(a), [=](index f) { m[f] = v[f] = 0.0; });
  }
  each_slab(g, cloud.start, [=](index begin, index end) {
    for (index p = begin; p < end; ++p) {
      const auto give = [=](const Beside<D>& beside) {
        give_beside(g, beside, cloud.mass[p], u + D * p, affine ? affine + D * D * p : nullptr, mass, velocity);
      };
      Stencil<K, D> st;
      st.set(g, cloud.x + D * p, cloud.edge(p));
      if (beside_interface<K, D>(g, stride, cloud.media, st, cloud.x + D * p, cloud.edge(p), give)) continue;
      each_of<D>([&](auto a) {
        double *m = mass[a], *v = velocity[a];
        const double up = u[D * p + a], scale = cloud.mass[p] / st.template total<a>();
        if (!affine) {
          const double mu = scale * up;
          st.template each<a>(stride[a], [=](index f, double w, double sign) {
            m[f] += w * scale;
            v[f] += w * sign * mu;
          });
        } else {
          const double* C = affine + D * D * p + D * a;
          st.template each<a>(stride[a], [&](index f, double w, double sign, const std::array<int, D>& k) {
            const auto r = st.template distance<a>(g, k);
            double value = up;
            for (int b = 0; b < D; ++b) value += C[b] * r[b];
            m[f] += w * scale;
            v[f] += w * sign * scale * value;
          });
        }
      });
    }
  });
  for (int a = 0; a < D; ++a) {
    double *m = mass[a], *v = velocity[a];
    parallel_for(g.faces(a), [=](index f) { v[f] = m[f] > 0.0 ? v[f] / m[f] : 0.0; });
  }
  close_periodic(g, mass);
  close_periodic(g, velocity);
}

// One term of the full-mass-matrix transfer, FMPM(k) (Nairn & Hammerquist 2021; XPIC, Hammerquist & Nairn 2017):
// velocity += (1/m_f) sum_p m_p w_fp (u_p - (interpolated velocity)_p). Repeated, it converges to the velocity whose
// interpolation is nearest to the particles' in the mass-weighted norm: the conservative l2 projection (Maljaars 2018).
template <class K, int D>
void add_residual(const Grid<D>& g, const Cloud<D>& cloud, const double* u, ConstFaces<D> mass, Faces<D> velocity,
                  Faces<D> work) {
  const auto stride = face_strides(g);
  for (int a = 0; a < D; ++a) {
    double* r = work[a];
    parallel_for(g.faces(a), [=](index f) { r[f] = 0.0; });
  }
  each_slab(g, cloud.start, [=](index begin, index end) {
    for (index p = begin; p < end; ++p) {
      const auto give = [=](const Beside<D>& beside) {
        give_residual_beside(beside, cloud.mass[p], u + D * p, velocity, work);
      };
      Stencil<K, D> st;
      st.set(g, cloud.x + D * p, cloud.edge(p));
      if (beside_interface<K, D>(g, stride, cloud.media, st, cloud.x + D * p, cloud.edge(p), give)) continue;
      each_of<D>([&](auto a) {
        double* r = work[a];
        const double lacking = u[D * p + a] - st.template gather<a>(stride[a], velocity[a]);
        const double mr = cloud.mass[p] / st.template total<a>() * lacking;
        st.template each<a>(stride[a], [=](index f, double w, double sign) { r[f] += w * sign * mr; });
      });
    }
  });
  for (int a = 0; a < D; ++a) {
    const double *m = mass[a], *r = work[a];
    double* v = velocity[a];
    parallel_for(g.faces(a), [=](index f) { v[f] += m[f] > 0.0 ? r[f] / m[f] : 0.0; });
  }
  close_periodic(g, velocity);
}

// Particle velocities from the grid: u_p = flip (I[drag] u_p + I[change]) + (1 - flip) I[now].
// flip = 0 is PIC (and FMPM), and needs no change and drag. change: what forces and pressure added to each face,
// now - drag * old, where drag is the factor by which the implicit resistance has scaled the old velocity.
template <class K, int D>
void to_particles(const Grid<D>& g, const Cloud<D>& cloud, ConstFaces<D> now, ConstFaces<D> change, ConstFaces<D> drag,
                  double flip, double* u) {
  const auto stride = face_strides(g);
  parallel_for(cloud.n, [=](index p) {
    const auto take = [=](const Beside<D>& beside) { take_beside(beside, now, change, drag, flip, u + D * p); };
    Stencil<K, D> st;
    st.set(g, cloud.x + D * p, cloud.edge(p));
    if (beside_interface<K, D>(g, stride, cloud.media, st, cloud.x + D * p, cloud.edge(p), take)) return;
    each_of<D>([&](auto a) {
      double& up = u[D * p + a];
      const double value = st.template gather<a>(stride[a], now[a]);
      if (flip > 0.0) {
        double factor = 0.0;
        st.template each<a>(stride[a], [&](index f, double w, double) { factor += w * drag[a][f]; });
        factor /= st.template total<a>();
        up = flip * (factor * up + st.template gather<a>(stride[a], change[a])) + (1.0 - flip) * value;
      } else {
        up = value;
      }
    });
  });
}

// APIC's velocity gradient (n, D, D), row a: C_ab = sum_f w u_f (x_f - x_p)_b / sum_f w (x_f - x_p)_b^2 (Jiang 2015).
template <class K, int D>
void affine_from(const Grid<D>& g, const Cloud<D>& cloud, ConstFaces<D> velocity, double* affine) {
  const auto stride = face_strides(g);
  parallel_for(cloud.n, [=](index p) {
    const auto take = [=](const Beside<D>& beside) { affine_beside(g, beside, velocity, affine + D * D * p); };
    Stencil<K, D> st;
    st.set(g, cloud.x + D * p, cloud.edge(p));
    if (beside_interface<K, D>(g, stride, cloud.media, st, cloud.x + D * p, cloud.edge(p), take)) return;
    each_of<D>([&](auto a) {
      double first[D] = {}, second[D] = {};
      st.template each<a>(stride[a], [&](index f, double w, double sign, const std::array<int, D>& k) {
        const auto r = st.template distance<a>(g, k);
        for (int b = 0; b < D; ++b) {
          first[b] += w * sign * velocity[a][f] * r[b];
          second[b] += w * r[b] * r[b];
        }
      });
      for (int b = 0; b < D; ++b)
        affine[D * D * p + D * a + b] = second[b] > 1e-10 * g.h[b] * g.h[b] ? first[b] / second[b] : 0.0;
    });
  });
}

}  // namespace houle
