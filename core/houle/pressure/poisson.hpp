// Pressure: sum over faces k_f (p_c - p_nb) + e_c p_c = rhs_c in the active cells of a MAC grid, by conjugate gradients
// preconditioned with one multigrid V-cycle (multigrid.hpp; storage in pencils.hpp).
//
// Solution, search direction and all products with the matrix are in double precision, the cycle and the residual that
// conjugate gradients carry on in single (Real): the true one, which decides, is taken anew from the solution. They run
// on the red cells of the checkerboard, the black ones following so that their residual stays zero. Every result is
// bitwise the same for any number of threads.
#pragma once

#include <cmath>
#include <functional>

#include <houle/pressure/components.hpp>
#include <houle/pressure/multigrid.hpp>

namespace houle {

namespace multigrid {

// The finest level and the vectors of conjugate gradients, as loops over its pencils know them: coefficients k,
// diagonal d and its inverse, solution x, right-hand side b, search direction, and q = A direction.
template <int D, class Real>
struct Finest {
  Level<D, Real> level;
  Mask<D> mask;
  std::array<Field<double>, D> k;
  Field<double> d, inverse, x, b, direction;
  Field<Real> q;

  // Zeroes what was active in pencil p at the last set-up and is not now.
  void clear(index p) const {
    const Pencils<D>& l = level.layout;
    const Pencil now = l.pencil(p);
    if (l.shrinks(now, p)) {
      for (auto& f : k) l.clear(f, now, p);
      for (auto* f : {&d, &inverse, &x, &b, &direction}) l.clear(*f, now, p);
      l.clear(q, now, p);
    }
    level.clear(now, p);
  }

  // The system of pencil p.
  void fill(index p, ConstFaces<D> k_f, const double* e) const {
    const Pencils<D>& l = level.layout;
    if (l.first[p] >= l.last[p]) return;
    const Pencil row = l.pencil(p);
    const auto i = l.place(p);
    const index n = l.n[D - 1];
    std::array<const double*, D> k_lo, k_hi;
    for (int a = 0; a < D - 1; ++a) {
      index face = 0;
      for (int t = 0; t < D - 1; ++t) face = face * (l.n[t] + (t == a)) + i[t];
      index up = n;
      for (int t = a + 1; t < D - 1; ++t) up *= l.n[t];
      k_lo[a] = k_f[a] + face * n;
      k_hi[a] = k_lo[a] + up;
    }
    k_lo[D - 1] = k_f[D - 1] + p * (n + 1);
    k_hi[D - 1] = k_lo[D - 1] + 1;
    const std::uint8_t* in_water = mask.pencil(i);
    const std::array<index, D> mask_step = mask.step;
    const double* extra = e + p * n;
    for (index s = 0; s < 2; ++s) {
      const int c = (row.parity + static_cast<int>(s)) & 1;
      const index end = std::min<index>(row.end, (n - s + 1) / 2);
      std::array<double*, D> kd;
      std::array<Real*, D> kf;
      for (int a = 0; a < D; ++a) {
        kd[a] = k[a].c[c] + row.at;
        kf[a] = level.k[a].c[c] + row.at;
      }
      double* diagonal = d.c[c] ? d.c[c] + row.at : nullptr;
      double* over = inverse.c[c] ? inverse.c[c] + row.at : nullptr;
      Real *ef = level.e().c[c] + row.at, *inversef = level.inverse.c[c] + row.at;
      HOULE_INDEPENDENT
      for (index m = row.begin; m < end; ++m) {
        const index j = 2 * m + s;
        const bool in = in_water[j] != 0;
        const double value = extra[j];
        double sum = in ? value : 0.0;
        ef[m] = static_cast<Real>(sum);
        for (int a = 0; a < D; ++a) {
          const double lower = k_lo[a][j], upper = k_hi[a][j];
          const bool below = in_water[j - mask_step[a]] != 0, above = in_water[j + mask_step[a]] != 0;
          const double v = (in & below) ? lower : 0.0, w = (in & above) ? upper : 0.0;
          kd[a][m] = v;
          kf[a][m] = static_cast<Real>(v);
          sum += v + w;
        }
        const double one_over = sum > 0 ? 1 / sum : 0.0;
        if (diagonal) diagonal[m] = sum;
        if (over) over[m] = one_over;
        inversef[m] = static_cast<Real>(one_over);
      }
    }
  }

  // The first guess and the right-hand side of pencil r, zero outside the active cells.
  template <class Number>
  void load(index r, const Number* p, const double* rhs) const {
    const Pencils<D>& l = level.layout;
    if (l.first[r] >= l.last[r]) return;
    const index n = l.n[D - 1];
    const Pencil row = l.pencil(r);
    for (index s = 0; s < 2; ++s) {
      const int c = (row.parity + static_cast<int>(s)) & 1;
      const index end = std::min<index>(row.end, (n - s + 1) / 2);
      const Real* over = level.inverse.c[c] + row.at;
      double *to_x = x.c[c] + row.at, *to_b = b.c[c] + row.at;
      const Number* guess = p + r * n + s;
      const double* source = rhs + r * n + s;
      HOULE_INDEPENDENT
      for (index m = row.begin; m < end; ++m) {
        const double g = guess[2 * m], f = source[2 * m];
        to_x[m] = over[m] > 0 ? g : 0.0;
        to_b[m] = over[m] > 0 ? f : 0.0;
      }
    }
  }

  // The solution of pencil p; single may be null.
  void store(index p, double* to, float* single) const {
    const Pencils<D>& l = level.layout;
    const index n = l.n[D - 1];
    const Pencil row = l.pencil(p);
    double* target = to + p * n;
    std::fill(target, target + std::min<index>(n, 2 * row.begin), 0.0);
    std::fill(target + std::min<index>(n, 2 * row.end), target + n, 0.0);
    for (index s = 0; s < 2; ++s) {
      const int c = (row.parity + static_cast<int>(s)) & 1;
      const index end = std::min<index>(row.end, (n - s + 1) / 2);
      const double* from = x.c[c] + row.at;
      HOULE_INDEPENDENT
      for (index m = row.begin; m < end; ++m) target[2 * m + s] = from[m];
    }
    if (single) std::copy(target, target + n, single + p * n);
  }
};

}  // namespace multigrid

// The outcome of a solve.
struct SolveResult {
  int iterations;   // -1: the tolerance was not reached
  double residual;  // max-norm of rhs - A p, recomputed from p, in the units of rhs
};

// The solver of a grid. setup() takes the system, solve() as many right-hand sides as there are.
template <int D, class Real = float>
class PressureSolver {
 public:
  explicit PressureSolver(const Grid<D>& grid);

  // active (cells, 0 or 1), k (faces), e (cells): the system of the following solves. Copies what it needs.
  void setup(const std::uint8_t* active, ConstFaces<D> k, const double* e);

  const Grid<D>& grid() const { return grid_; }
  int closed_components() const { return components_.count(); }

  // Addresses and capacities of all that could grow: the same after every set-up and solve.
  std::vector<std::uintptr_t> buffers() const;

  // p: in the first guess, out the solution. Stops when the max-norm of the residual is at most `tolerance`.
  // guess (cells), if not null: first guess in place of p, and out the solution as well.
  SolveResult solve(const double* rhs, double* p, double tolerance, int max_iterations, float* guess = nullptr);

 private:
  using Pencil = multigrid::Pencil;
  using Doubles = multigrid::OwnField<double>;

  Grid<D> grid_;
  std::vector<multigrid::OwnLevel<D, Real>> levels_;
  std::array<Doubles, D> k_;
  Doubles d_, inverse_;  // red cells only, black cells only: the system is reduced to the red ones
  Doubles x_, b_, p_;
  multigrid::OwnField<Real> q_;
  std::vector<double> part_;  // one partial result per block of pencils
  multigrid::OwnMask<D> mask_;
  multigrid::ClosedComponents<D> components_;
  double scale_ = 1;

  multigrid::Layout<D>& fine() { return levels_[0].layout; }
  const multigrid::Layout<D>* coarser(std::size_t i) const {
    return i + 1 < levels_.size() ? &levels_[i + 1].layout : nullptr;
  }

  static std::vector<multigrid::OwnLevel<D, Real>> hierarchy(const Grid<D>& grid) {
    std::vector<multigrid::OwnLevel<D, Real>> levels;
    auto shape = grid.shape;
    levels.emplace_back(shape, grid.periodic);
    while (*std::max_element(shape.begin(), shape.end()) > 1) {
      for (index& n : shape) n = (n + 1) / 2;
      levels.emplace_back(shape, grid.periodic);
    }
    return levels;
  }

  multigrid::Finest<D, Real> finest() const {
    multigrid::Finest<D, Real> all{levels_[0].all(), mask_, {}, d_, inverse_, x_, b_, p_, q_};
    for (int a = 0; a < D; ++a) all.k[a] = k_[a];
    return all;
  }

  void build_fine(ConstFaces<D> k, const double* e) {
    auto& l = fine();
    const auto all = finest();
    parallel_for(l.pencils, [=](index p) { all.clear(p); }, l.grain);
    l.list(nullptr, coarser(0));
    parallel_for(l.pencils, [=](index p) { all.fill(p, k, e); }, l.grain);
    auto& level = levels_[0];
    for (int a = 0; a < D; ++a)
      for (int c = 0; c < 2; ++c) {
        multigrid::exchange(l, k_[a], c, a);
        multigrid::exchange(l, level.k[a], c, a);
      }
  }

  // ---- conjugate gradients

  void forget() {  // zeroes all vectors, so that no NaN survives in entries that are never read but multiplied by zero
    for (auto* f : {&x_, &b_, &p_}) std::fill(f->store.begin(), f->store.end(), 0.0);
    std::fill(q_.store.begin(), q_.store.end(), Real(0));
    for (auto& level : levels_)
      for (auto* f : {&level.x, &level.b, &level.r}) std::fill(f->store.begin(), f->store.end(), Real(0));
  }

  template <class Number>
  void load(const Number* p, const double* rhs) {
    const auto all = finest();
    parallel_for(fine().pencils, [=](index r) { all.load(r, p, rhs); }, fine().grain);
  }

  void store(double* to, float* single) {
    const auto all = finest();
    parallel_for(fine().pencils, [=](index p) { all.store(p, to, single); }, fine().grain);
  }

  template <class One, class Other>
  static void add_products(const One* a, const Other* b, index n, double* lanes) {
    double sum[multigrid::width] = {};
    for (index i = 0; i < n; i += multigrid::width)
      for (int v = 0; v < multigrid::width; ++v)
        sum[v] += static_cast<double>(a[i + v]) * static_cast<double>(b[i + v]);
    for (int v = 0; v < multigrid::width; ++v) lanes[v] += sum[v];
  }
  struct Larger {  // NaN wins
    template <class Number>
    Number operator()(Number a, Number b) const {
      return ((a >= b) | (a != a)) ? a : b;
    }
  };
  static constexpr Larger larger{};
  static void max_size(const Real* a, index n, double* lanes) {
    Real most[multigrid::width] = {};
    for (index i = 0; i < n; i += multigrid::width)
      for (int v = 0; v < multigrid::width; ++v) most[v] = larger(most[v], std::abs(a[i + v]));
    for (int v = 0; v < multigrid::width; ++v) lanes[v] = larger(lanes[v], static_cast<double>(most[v]));
  }

  // Sums or maxima over the colours in use: body(colour, s, first, n, lanes) adds n entries to eight partial results of
  // its block of pencils; all are combined in a fixed order.
  static constexpr index block = 16;  // pencils

  template <class Body, class Combine>
  double reduce(Body body, Combine combine) {
    double* part = part_.data();
    const Pencil* rows = fine().row;
    const auto n = static_cast<index>(fine().rows.size());
    const int colours = this->colours();
    const index blocks = (n + block - 1) / block;
    parallel_for(
        blocks,
        [=](index b) {
          double lanes[multigrid::width] = {};
          for (index p = b * block; p < std::min(n, (b + 1) * block); ++p)
            for (int c = 0; c < colours; ++c) {
              auto entries = [&](auto s, index first, index n) { body(c, s, first, n, lanes); };
              multigrid::with_entries(rows[p], c, entries);
            }
          for (int half = multigrid::width / 2; half > 0; half /= 2)
            for (int v = 0; v < half; ++v) lanes[v] = combine(lanes[v], lanes[v + half]);
          part[b] = lanes[0];
        },
        std::max<index>(1, fine().grain / block));
    double result = 0;
    for (index b = 0; b < blocks; ++b) result = combine(result, part[b]);
    return result;
  }

  // On an even grid the black cells only see red ones: their residual is kept at zero and CG iterates on the red ones.
  int colours() const { return levels_[0].layout.odd ? 2 : 1; }

  using Star = multigrid::Star<D, double>;

  const multigrid::OwnField<Real>& residual() const { return levels_[0].b; }  // the right-hand side of the cycle

  void extend(const Doubles& f, const double* rhs) {  // the black values that leave no black residual
    if (colours() == 2) return;
    multigrid::exchange(fine(), f, 0);
    const Star star(fine(), k_, f, 1);
    const double* inverse = inverse_.c[1];
    double* x = f.c[1];
    if (rhs)
      multigrid::sweep(fine(), 1, [=](auto s, index first, index n) {
        HOULE_INDEPENDENT
        for (index i = first; i < first + n; ++i) x[i] = inverse[i] * (rhs[i] + star(s, i));
      });
    else
      multigrid::sweep(fine(), 1, [=](auto s, index first, index n) {
        HOULE_INDEPENDENT
        for (index i = first; i < first + n; ++i) x[i] = inverse[i] * star(s, i);
      });
  }

  // Share of its peak down to which the residual carried on in single precision is trusted: below, the true one is
  // taken.
  static constexpr double trusted = 1e-5;

  double true_residual() {  // r = b - A x, scaled; returns its max-norm, unscaled
    extend(x_, b_.c[1]);
    for (int c = 0; c < 2; ++c) multigrid::exchange(fine(), x_, c);
    const std::array<Star, 2> stars{Star(fine(), k_, x_, 0), Star(fine(), k_, x_, 1)};
    const auto ds = d_.c, bs = b_.c, xs = x_.c;
    const auto rs = residual().c;
    const double scale = scale_;
    const auto entries = [=](int c, auto s, index first, index n, double* lanes) {
      const Star star = stars[c];
      const double *d = ds[c], *b = bs[c], *x = xs[c];
      Real* r = rs[c];
      double most[multigrid::width] = {};
      for (index i = first; i < first + n; i += multigrid::width)
        for (index v = 0; v < multigrid::width; ++v) {
          const index at = i + v;
          const double value = d[at] > 0 ? b[at] + star(s, at) - d[at] * x[at] : 0.0;
          r[at] = static_cast<Real>(scale * value);
          most[v] = larger(most[v], std::abs(value));
        }
      for (int v = 0; v < multigrid::width; ++v) lanes[v] = larger(lanes[v], most[v]);
    };
    return reduce(entries, larger);
  }

  void scale_residual(double scale) {  // so that the numbers of the cycle are far from the smallest there are
    scale_ = scale;
    for (int c = 0; c < colours(); ++c) {
      Real* r = residual().c[c];
      multigrid::sweep(fine(), c, [=](auto, index first, index n) {
        HOULE_INDEPENDENT
        for (index i = first; i < first + n; ++i) r[i] = static_cast<Real>(scale * r[i]);
      });
    }
  }

  double dot_rz() {
    const auto rs = residual().c, zs = levels_[0].x.c;
    const auto products = [=](int c, auto, index first, index n, double* lanes) {
      const Real *r = rs[c] + first, *z = zs[c] + first;
      add_products(r, z, n, lanes);
    };
    return reduce(products, std::plus<double>());
  }

  void direction(double beta) {
    for (int c = 0; c < colours(); ++c) {
      double* p = p_.c[c];
      const Real* z = levels_[0].x.c[c];
      multigrid::sweep(fine(), c, [=](auto, index first, index n) {
        HOULE_INDEPENDENT
        for (index i = first; i < first + n; ++i) p[i] = static_cast<double>(z[i]) + beta * p[i];
      });
    }
    extend(p_, nullptr);
  }

  double apply() {  // q = A p; returns p . q
    for (int c = 0; c < 2; ++c) multigrid::exchange(fine(), p_, c);
    const std::array<Star, 2> stars{Star(fine(), k_, p_, 0), Star(fine(), k_, p_, 1)};
    const auto ds = d_.c, ps = p_.c;
    const auto qs = q_.c;
    const auto entries = [=](int c, auto s, index first, index n, double* lanes) {
      const Star star = stars[c];
      const double *d = ds[c], *p = ps[c];
      Real* q = qs[c];
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) q[i] = d[i] > 0 ? static_cast<Real>(d[i] * p[i] - star(s, i)) : Real(0);
      add_products(p + first, q + first, n, lanes);
    };
    return reduce(entries, std::plus<double>());
  }

  double advance(double alpha) {  // x += alpha p, r -= alpha q; returns the max-norm of r, both unscaled
    const auto ps = p_.c, xs = x_.c;
    const auto qs = q_.c, rs = residual().c;
    const double way = alpha / scale_;
    const Real step = static_cast<Real>(alpha);
    const auto go = [=](int c, auto, index first, index n, double* lanes) {
      const double* p = ps[c] + first;
      const Real* q = qs[c] + first;
      double* x = xs[c] + first;
      Real* r = rs[c] + first;
      HOULE_INDEPENDENT
      for (index i = 0; i < n; ++i) {
        x[i] += way * p[i];
        r[i] -= step * q[i];
      }
      max_size(r, n, lanes);
    };
    return reduce(go, larger) / scale_;
  }
};

template <int D, class Real>
PressureSolver<D, Real>::PressureSolver(const Grid<D>& grid)
    : grid_(grid), levels_(hierarchy(grid)), mask_(grid.shape), components_(fine()) {
  const auto& l = fine();
  for (auto& f : k_) f.allocate(l.size);
  const int red = colours() == 2 ? -1 : 0, black = colours() == 2 ? -1 : 1;
  for (auto* f : {&x_, &b_, &p_}) f->allocate(l.size);
  d_.allocate(l.size, red);
  inverse_.allocate(l.size, black);
  q_.allocate(l.size, red);
  part_.assign(l.pencils, 0);
}

template <int D, class Real>
void PressureSolver<D, Real>::setup(const std::uint8_t* active, ConstFaces<D> k, const double* e) {
  multigrid::copy_active<D>(fine(), mask_, active);
  build_fine(k, e);
  for (std::size_t i = 1; i < levels_.size(); ++i) multigrid::coarsen(levels_[i - 1], levels_[i], coarser(i));
  components_.find(fine(), mask_, k, e);
}

template <int D, class Real>
std::vector<std::uintptr_t> PressureSolver<D, Real>::buffers() const {
  std::vector<std::uintptr_t> all;
  auto note = [&](const auto& v) {
    all.push_back(reinterpret_cast<std::uintptr_t>(v.data()));
    all.push_back(v.capacity());
  };
  for (const auto& level : levels_) note(level.layout.rows);
  components_.note_buffers(note);
  note(part_);
  return all;
}

template <int D, class Real>
SolveResult PressureSolver<D, Real>::solve(const double* rhs, double* p, double tolerance, int max_iterations,
                                           float* guess) {
  if (guess)
    load(guess, rhs);
  else
    load(p, rhs);
  components_.remove_means(b_);
  components_.remove_means(x_);
  scale_ = 1;
  double norm = true_residual(), reached = norm, peak = norm;
  if (norm > tolerance) scale_residual(1 / norm);
  bool exact = true;  // true: norm is that of the true residual, not of the one carried on
  int iterations = 0;
  double rz = 0;
  while (!(norm <= tolerance) && std::isfinite(norm) && iterations < max_iterations) {
    multigrid::cycle(levels_);
    const double rz_new = dot_rz();
    if (!(rz_new > 0)) break;
    direction(rz > 0 ? rz_new / rz : 0.0);
    rz = rz_new;
    const double pq = apply();
    if (!(pq > 0)) break;
    norm = advance(rz / pq);
    exact = false;
    ++iterations;
    peak = std::max(peak, norm);
    if (norm <= std::max(tolerance, trusted * peak)) {
      const double believed = norm;
      norm = true_residual();
      exact = true;
      if (norm > 2 * believed && norm > 0.5 * reached) break;  // round-off reached
      reached = peak = norm;
    }
  }
  components_.remove_means(x_);
  if (!exact || closed_components() > 0) norm = true_residual();
  store(p, guess);
  if (!std::isfinite(norm)) forget();
  return {norm <= tolerance ? iterations : -1, norm};
}

}  // namespace houle
