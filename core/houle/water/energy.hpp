// Sums for the ledger: kinetic and potential energy, momentum, volume. Block-wise, so the same for any threads.
#pragma once

#include <houle/exec/reduce.hpp>
#include <houle/water/forces.hpp>

namespace houle {

// Sums of term(r, i), i = 0..n[r]-1, for every range r, by blocks, all ranges in one loop. Four terms are added at a
// time: the sums of one group need not wait for those of the group before.
template <std::size_t ranges, class Term>
inline std::array<double, ranges> sums_by_four(const std::array<index, ranges>& n, Term term) {
  constexpr index block = 2048;
  std::array<index, ranges + 1> first{};  // block of each range
  for (std::size_t r = 0; r < ranges; ++r) first[r + 1] = first[r] + (n[r] + block - 1) / block;
  const auto part = parallel_values(
      first[ranges],
      [=](index b) {
        std::size_t r = 0;
        while (b >= first[r + 1]) ++r;
        const index begin = (b - first[r]) * block, end = std::min(begin + block, n[r]),
                    fours = end - (end - begin) % 4;
        double sum = 0.0, rest = 0.0;
        for (index i = begin; i < fours; i += 4)
          sum += (term(r, i) + term(r, i + 1)) + (term(r, i + 2) + term(r, i + 3));
        for (index i = fours; i < end; ++i) rest += term(r, i);
        return sum + rest;
      },
      4);
  std::array<double, ranges> sum{};
  for (std::size_t r = 0; r < ranges; ++r)
    for (index b = first[r]; b < first[r + 1]; ++b) sum[r] += part[b];
  return sum;
}

// Sum of term(i), i = 0..n-1, in the same order.
template <class Term>
inline double sum_by_four(index n, Term term) {
  return sums_by_four<1>({n}, [=](std::size_t, index i) { return term(i); })[0];
}

// Sum of term(a, f) over the faces of all axes.
template <int D, class Term>
inline double sum_of_faces(const Grid<D>& g, Term term) {
  std::array<index, D> n;
  for (int a = 0; a < D; ++a) n[a] = g.faces(a);
  double sum = 0.0;
  for (double part : sums_by_four(n, term)) sum += part;
  return sum;
}

// Sum of all, in blocks and then in pairs: hundreds of thousands of volumes are added with an error of a few
// round-offs.
double total(index n, const double* value);

// Kinetic energy of the particles per unit density, 1/2 sum_p (V/n) J |u_d|^2 with J = C_r/n: its rate is the work of
// forces less the drag. bulk (n,) V/n; inertia (n, D) J at the particles along each axis, null in clear water.
template <int D>
double kinetic_energy(index n, const double* bulk, const float* inertia, const double* u) {
  return sum_by_four(n, [=](index p) {
    double s = 0.0;
    for (int a = 0; a < D; ++a)
      s += (inertia ? static_cast<double>(inertia[D * p + a]) : 1.0) * u[D * p + a] * u[D * p + a];
    return 0.5 * bulk[p] * s;
  });
}

// Kinetic energy of the faces per unit density, 1/2 sum_f m_f J_f u_f^2; J by the number of the face's material, 1
// where that is null.
template <int D>
double face_kinetic_energy(const Grid<D>& g, ConstFaces<D> mass, ConstFaces<D, std::int32_t> number,
                           const Material* table, ConstFaces<D> u) {
  return sum_of_faces(g, [=](std::size_t a, index f) {
    return 0.5 * mass[a][f] * (number[a] ? table[number[a][f]].inertia : 1.0) * u[a][f] * u[a][f];
  });
}

// Power of the accelerations f on the faces per unit density, sum_f m_f u_f f_f.
template <int D>
double face_power(const Grid<D>& g, ConstFaces<D> mass, ConstFaces<D> u, ConstFaces<D> acceleration) {
  return sum_of_faces(g, [=](std::size_t a, index f) { return mass[a][f] * u[a][f] * acceleration[a][f]; });
}

// True if all n numbers are finite: x - x is then 0, else NaN.
bool all_finite(index n, const double* x);

// Largest pore speed along each axis, max_p |u_a| / n with n = volume / bulk [m/s]; NaN if any is.
template <int D>
std::array<double, D> max_speed(index n, const double* u, const double* volume, const double* bulk) {
  using Speeds = std::array<double, D>;
  return parallel_reduce(
      n, Speeds{},
      [=](index p) {
        const double slow = bulk[p] / volume[p];
        Speeds speed;
        for (int a = 0; a < D; ++a) speed[a] = std::abs(u[D * p + a]) * slow;
        return speed;
      },
      [](Speeds most, const Speeds& speed) {
        for (int a = 0; a < D; ++a) most[a] = ((speed[a] > most[a]) | (speed[a] != speed[a])) ? speed[a] : most[a];
        return most;
      });
}

// Sum over particles of weight_p value_p, value being one column of an (n, D) array.
double weighted_sum(index n, const double* weight, const double* value, index stride);

}  // namespace houle
