// Pressure: sum over faces k_f (p_c - p_nb) + e_c p_c = rhs_c in the active cells of a MAC grid, by conjugate gradients
// preconditioned with one multigrid V-cycle.
//
// * A level coarsens 2 x 2 (x 2) cells into one. Coarse face coefficients are the sums of the fine ones times 1/2 (the
//   centres lie twice as far apart), so every level keeps the 2 D-neighbour stencil; transfers are piecewise constant.
// * The smoother is red-black Gauss-Seidel, in the reverse order after the coarse correction: the cycle is symmetric.
// * The cells of a pencil (a column along the last axis) are stored by colour: cell j = 2 m + s of a pencil is entry m of
//   one of two arrays. All neighbours of a colour are then contiguous entries of the other, and half sweeps vectorise.
// * Cells of one colour that were just relaxed have no residual, and the first half sweep after a correction overwrites
//   that colour: so only red residuals are restricted and only red cells receive the correction.
// * Only pencils with active cells are visited, and of each only the range of entries that holds its active cells.
// * Connected components without any e are closed: p is known up to a constant, and solvable only if rhs sums to
//   zero. There the mean of rhs and of p is taken out.
//
// Every result is bitwise the same for any number of threads.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "grid.hpp"
#include "parallel.hpp"

#if defined(__clang__)
#define HOULE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define HOULE_INDEPENDENT _Pragma("GCC ivdep")
#elif defined(_MSC_VER)
#define HOULE_INDEPENDENT __pragma(loop(ivdep))
#else
#define HOULE_INDEPENDENT
#endif

namespace houle::multigrid {

constexpr int width = 8;  // ranges are whole multiples of this many entries: no loop needs a remainder

struct Pencil {
  index at;            // entry m = 0 in every array of the level
  index child;         // the same of its first pencil on the finer level
  std::int32_t begin, end;  // its active cells are among the entries [begin, end) ...
  std::int32_t lo, hi;      // ... and these are inside [lo, hi), whole vectors
  std::int32_t parity;      // cell j = 2 m + s is of colour (parity + s) % 2
};

struct Seam {  // a pencil at one end of a periodic axis and the ghost pencil beyond the other end
  index from, to;     // first entries
  std::int32_t swap;  // an odd number of cells: equal colours meet
  std::int32_t axis;
};

// One number per cell, split by colour; entry m of a pencil is c[colour][pencil.at + m].
template <class Real>
struct Field {
  std::vector<Real> store;
  std::array<Real*, 2> c{};

  void allocate(index size) {  // zeroed; colours and fields are staggered so that streams do not share cache sets
    static int stagger = 0;
    const index line = 64 / sizeof(Real);
    store.assign(static_cast<std::size_t>(2 * size + 132 * line), Real(0));
    auto address = reinterpret_cast<std::uintptr_t>(store.data());
    Real* base = store.data() + (64 - address % 64) % 64 / sizeof(Real) + line;
    for (int i = 0; i < 2; ++i) c[i] = base + i * size + line * (stagger = (stagger + 5) % 64);
    if (c[1] < c[0] + size) c[1] += 64 * line;
  }
};

template <int D>
struct Layout {
  std::array<index, D> n{};
  std::array<bool, D> wrap{};
  index half = 0;                 // entries per pencil and colour
  index shift = 0;                // entries before m = 0: the ghost of a periodic last axis
  std::array<index, D> step{};    // entries between neighbouring pencils along each axis but the last
  index size = 0;                 // entries per colour, ghost pencils included
  index pencils = 0;              // pencils inside the grid
  std::vector<std::int32_t> first, last;  // active cells of every pencil inside: j in [first, last)
  std::vector<std::int32_t> old_lo, old_hi;  // entries in use after the last setup
  std::vector<Pencil> rows;       // the pencils with active cells
  std::vector<Seam> seams;
  index grain = 1;
  bool odd = false;  // an odd periodic axis: there cells of one colour meet, and relaxing one leaves residuals in it

  Layout(const std::array<index, D>& shape, const std::array<bool, D>& periodic) : n(shape), wrap(periodic) {
    for (int a = 0; a < D; ++a) wrap[a] = wrap[a] && n[a] > 1;
    for (int a = 0; a < D; ++a) odd = odd || (wrap[a] && n[a] % 2 == 1);
    shift = wrap[D - 1] ? 1 : 0;
    const index used = (n[D - 1] + 1) / 2;
    half = (std::max(n[D - 1] / 2 + 1, used + used % 2) + shift + width - 1) / width * width;  // the cell above too
    size = half;
    pencils = 1;
    for (int a = D - 2; a >= 0; --a) {
      step[a] = size;
      size *= n[a] + 2;
      pencils *= n[a];
    }
    first.assign(pencils, 0);
    last.assign(pencils, 0);
    old_lo.assign(pencils, 0);
    old_hi.assign(pencils, 0);
    rows.reserve(pencils);
    for (index p = 0; p < pencils; ++p) {
      const auto i = place(p);
      const index at = offset(i) - shift;
      for (int a = 0; a < D - 1; ++a) {
        if (!wrap[a]) continue;
        const auto swap = static_cast<std::int32_t>(n[a] & 1);
        if (i[a] == 0) seams.push_back({at, at + n[a] * step[a], swap, a});
        if (i[a] == n[a] - 1) seams.push_back({at, at - n[a] * step[a], swap, a});
      }
    }
    grain = std::max<index>(1, 4096 / half);
  }

  std::array<index, D> place(index pencil) const {  // its indices; the last entry is unused
    std::array<index, D> i{};
    for (int a = D - 2; a >= 0; --a) {
      i[a] = pencil % n[a];
      pencil /= n[a];
    }
    return i;
  }
  index offset(const std::array<index, D>& i) const {
    index at = shift;
    for (int a = 0; a < D - 1; ++a) at += (i[a] + 1) * step[a];
    return at;
  }
  Pencil pencil(index p) const {
    const auto i = place(p);
    Pencil r{};
    r.at = offset(i);
    r.begin = first[p] / 2;
    r.end = (last[p] + 1) / 2;
    r.lo = static_cast<std::int32_t>((r.begin + shift) / width * width - shift);
    r.hi = static_cast<std::int32_t>((r.end + shift + width - 1) / width * width - shift);
    if (first[p] >= last[p]) r.lo = r.hi = r.begin = r.end = 0;
    for (int a = 0; a < D - 1; ++a) r.parity ^= static_cast<std::int32_t>(i[a] & 1);
    return r;
  }

  // Lists the non-empty pencils and the periodic seams, once first and last are known.
  void list(const Layout* finer) {
    rows.clear();
    for (index p = 0; p < pencils; ++p) {
      if (first[p] >= last[p]) continue;
      Pencil r = pencil(p);
      const auto i = place(p);
      if (finer) {
        auto j = i;
        for (int a = 0; a < D - 1; ++a) j[a] *= 2;
        r.child = finer->offset(j);
      }
      rows.push_back(r);
    }
  }
};

template <int D, class Body>
inline void for_rows(const Layout<D>& l, Body body) {
  const Pencil* rows = l.rows.data();
  parallel_for(static_cast<index>(l.rows.size()), [=](index i) { body(rows[i]); }, l.grain);
}

// Copies what lies beyond the periodic ends (of one axis, or of all) into the ghost entries of one colour.
template <int D, class Real>
inline void exchange(const Layout<D>& l, const Field<Real>& x, int colour, int axis = -1) {
  for (const Seam& s : l.seams)
    if (axis < 0 || s.axis == axis) std::memcpy(x.c[colour] + s.to, x.c[colour ^ s.swap] + s.from, l.half * sizeof(Real));
  if (!l.shift || (axis >= 0 && axis != D - 1)) return;
  const index n = l.n[D - 1];
  for (const Pencil& r : l.rows) {
    auto entry = [&](index j) { return r.at + ((j + 2) / 2 - 1); };
    auto tint = [&](index j) { return (r.parity + static_cast<int>((j + 2) & 1)) & 1; };
    if (tint(-1) == colour) x.c[colour][entry(-1)] = x.c[tint(n - 1)][entry(n - 1)];
    if (tint(n) == colour) x.c[colour][entry(n)] = x.c[tint(0)][entry(0)];
  }
}

// The neighbours of the cells of one colour in one pencil.
template <int D, class Real>
struct Star {
  std::array<const Real*, D> k_lo, k_hi, x_lo, x_hi;

  Star(const Layout<D>& l, const std::array<Field<Real>, D>& k, const Field<Real>& x, const Pencil& r, int colour) {
    const int other = 1 - colour;
    const index s = (r.parity + colour) & 1;
    for (int a = 0; a < D - 1; ++a) {
      k_lo[a] = k[a].c[colour] + r.at;
      k_hi[a] = k[a].c[other] + r.at + l.step[a];
      x_lo[a] = x.c[other] + r.at - l.step[a];
      x_hi[a] = x.c[other] + r.at + l.step[a];
    }
    k_lo[D - 1] = k[D - 1].c[colour] + r.at;
    k_hi[D - 1] = k[D - 1].c[other] + r.at + s;
    x_lo[D - 1] = x.c[other] + r.at + s - 1;
    x_hi[D - 1] = x.c[other] + r.at + s;
  }
  Real operator()(index m) const {  // sum of k_f p_nb
    Real sum = k_lo[0][m] * x_lo[0][m] + k_hi[0][m] * x_hi[0][m];
    for (int a = 1; a < D; ++a) sum += k_lo[a][m] * x_lo[a][m] + k_hi[a][m] * x_hi[a][m];
    return sum;
  }
};

template <int D, class Real>
struct Level {
  Layout<D> layout;
  std::array<Field<Real>, D> k;  // of the lower face of each cell along each axis
  Field<Real> e, d, inverse;     // d = e + sum of k; inverse = 1 / d, zero outside the active cells
  Field<Real> x, b, r;

  Level(const std::array<index, D>& shape, const std::array<bool, D>& periodic) : layout(shape, periodic) {
    for (auto& f : k) f.allocate(layout.size);
    for (auto* f : {&e, &d, &inverse, &x, &b, &r}) f->allocate(layout.size);
  }

  void clear(const Pencil& now, index p) {  // empties the entries in use before and now
    const index lo = std::min<index>(now.lo, layout.old_lo[p]), hi = std::max<index>(now.hi, layout.old_hi[p]);
    for (int c = 0; c < 2; ++c) {
      for (auto& f : k) std::fill(f.c[c] + now.at + lo, f.c[c] + now.at + hi, Real(0));
      for (auto* f : {&e, &d, &inverse, &x, &b, &r}) std::fill(f->c[c] + now.at + lo, f->c[c] + now.at + hi, Real(0));
    }
    layout.old_lo[p] = now.lo;
    layout.old_hi[p] = now.hi;
  }

  void invert() {
    auto* self = this;
    for_rows(layout, [=](const Pencil& row) {
      for (int c = 0; c < 2; ++c) {
        const Real* d = self->d.c[c] + row.at;
        Real* inverse = self->inverse.c[c] + row.at;
        HOULE_INDEPENDENT
        for (index m = row.lo; m < row.hi; ++m) inverse[m] = d[m] > 0 ? 1 / d[m] : 0;
      }
    });
  }

  void relax_zero(int colour) {  // the half sweep that starts from x = 0
    auto* self = this;
    for_rows(layout, [=](const Pencil& row) {
      const Real* inverse = self->inverse.c[colour] + row.at;
      const Real* b = self->b.c[colour] + row.at;
      Real* x = self->x.c[colour] + row.at;
      HOULE_INDEPENDENT
      for (index m = row.lo; m < row.hi; ++m) x[m] = inverse[m] * b[m];
      if (self->layout.odd)
        std::fill(self->x.c[1 - colour] + row.at + row.lo, self->x.c[1 - colour] + row.at + row.hi, Real(0));
    });
  }

  void relax(int colour) {
    exchange(layout, x, 1 - colour);
    auto* self = this;
    for_rows(layout, [=](const Pencil& row) {
      const Star<D, Real> star(self->layout, self->k, self->x, row, colour);
      const Real* inverse = self->inverse.c[colour] + row.at;
      const Real* b = self->b.c[colour] + row.at;
      Real* x = self->x.c[colour] + row.at;
      HOULE_INDEPENDENT
      for (index m = row.lo; m < row.hi; ++m) x[m] = inverse[m] * (b[m] + star(m));
    });
  }

  void residual(int colour) {
    exchange(layout, x, 1 - colour);
    auto* self = this;
    for_rows(layout, [=](const Pencil& row) {
      const Star<D, Real> star(self->layout, self->k, self->x, row, colour);
      const Real* d = self->d.c[colour] + row.at;
      const Real* b = self->b.c[colour] + row.at;
      const Real* x = self->x.c[colour] + row.at;
      Real* r = self->r.c[colour] + row.at;
      HOULE_INDEPENDENT
      for (index m = row.lo; m < row.hi; ++m) r[m] = d[m] > 0 ? b[m] + star(m) - d[m] * x[m] : 0;
    });
  }
};

// The pencils of the finer level that one coarse pencil is made of.
template <int D>
inline std::array<index, (1 << (D - 1))> children(const Layout<D>& fine, const Pencil& row) {
  std::array<index, (1 << (D - 1))> at{};
  for (int i = 0; i < (1 << (D - 1)); ++i) {
    at[i] = row.child;
    for (int a = 0; a < D - 1; ++a) at[i] += (i >> a & 1) * fine.step[a];
  }
  return at;
}

// Coarse coefficients from fine ones.
template <int D, class Real>
inline void coarsen(Level<D, Real>& fine, Level<D, Real>& coarse) {
  Layout<D>& lf = fine.layout;
  Layout<D>& lc = coarse.layout;
  for (index p = 0; p < lc.pencils; ++p) {
    const auto i = lc.place(p);
    std::int32_t first = INT32_MAX, last = 0;
    for (int child = 0; child < (1 << (D - 1)); ++child) {
      index q = 0;
      bool inside = true;
      for (int a = 0; a < D - 1; ++a) {
        const index j = 2 * i[a] + (child >> a & 1);
        inside = inside && j < lf.n[a];
        q = q * lf.n[a] + j;
      }
      if (!inside || lf.first[q] >= lf.last[q]) continue;
      first = std::min(first, lf.first[q] / 2);
      last = std::max(last, (lf.last[q] + 1) / 2);
    }
    lc.first[p] = std::min(first, last);
    lc.last[p] = last;
  }
  auto *f = &fine, *c = &coarse;
  parallel_for(lc.pencils, [=](index p) { c->clear(c->layout.pencil(p), p); }, lc.grain);
  lc.list(&lf);
  for_rows(lc, [=](const Pencil& row) {
    constexpr int pencils = 1 << (D - 1);
    const auto child = children(f->layout, row);
    for (int s = 0; s < 2; ++s) {
      const int colour = (row.parity + s) & 1;
      for (int i = 0; i < pencils; ++i) {
        const int even = D == 2 ? i & 1 : (i ^ (i >> 1)) & 1;  // colour of its cells with even j
        for (int a = 0; a < D; ++a) {
          if (a < D - 1 && (i >> a & 1)) continue;
          Real* k = c->k[a].c[colour] + row.at;
          const Real* k0 = f->k[a].c[even] + child[i] + s;
          const Real* k1 = f->k[a].c[1 - even] + child[i] + s;
          if (a < D - 1) {
            HOULE_INDEPENDENT
            for (index m = row.begin; m < row.end; ++m) k[m] += Real(0.5) * (k0[2 * m] + k1[2 * m]);
          } else {
            HOULE_INDEPENDENT
            for (index m = row.begin; m < row.end; ++m) k[m] += Real(0.5) * k0[2 * m];
          }
        }
        Real* e = c->e.c[colour] + row.at;
        const Real* e0 = f->e.c[even] + child[i] + s;
        const Real* e1 = f->e.c[1 - even] + child[i] + s;
        HOULE_INDEPENDENT
        for (index m = row.begin; m < row.end; ++m) e[m] += Real(0.5) * (e0[2 * m] + e1[2 * m]);
      }
    }
    for (int a = 0; a < D; ++a) {  // one cell around a periodic axis: no neighbour but itself
      if (c->layout.n[a] > 1) continue;
      for (int colour = 0; colour < 2; ++colour)
        std::fill(c->k[a].c[colour] + row.at + row.lo, c->k[a].c[colour] + row.at + row.hi, Real(0));
    }
  });
  for (int a = 0; a < D; ++a)
    for (int colour = 0; colour < 2; ++colour) exchange(lc, coarse.k[a], colour, a);
  for_rows(lc, [=](const Pencil& row) {
    for (int colour = 0; colour < 2; ++colour) {
      const Level<D, Real>* level = c;
      std::array<const Real*, 2 * D> k;
      for (int a = 0; a < D; ++a) {
        k[2 * a] = level->k[a].c[colour] + row.at;
        const index up = a < D - 1 ? level->layout.step[a] : (row.parity + colour) & 1;
        k[2 * a + 1] = level->k[a].c[1 - colour] + row.at + up;
      }
      const Real* e = level->e.c[colour] + row.at;
      Real* d = level->d.c[colour] + row.at;
      const index end = std::min<index>(row.end, (level->layout.n[D - 1] + 1 - ((row.parity + colour) & 1)) / 2);
      HOULE_INDEPENDENT
      for (index m = row.begin; m < end; ++m) {
        Real sum = e[m];
        for (int i = 0; i < 2 * D; ++i) sum += k[i][m];
        d[m] = sum;
      }
    }
  });
  coarse.invert();
}

// coarse.b = sums of the residuals of fine. Black cells, relaxed last, have none, except at an odd periodic seam.
template <int D, class Real>
inline void restrict_residual(Level<D, Real>& fine, Level<D, Real>& coarse) {
  auto* f = &fine;
  auto* c = &coarse;
  for (int colour = 0; colour < (fine.layout.odd ? 2 : 1); ++colour) {
    fine.residual(colour);
    for_rows(coarse.layout, [=](const Pencil& row) {
      const auto child = children(f->layout, row);
      for (int s = 0; s < 2; ++s) {
        std::array<const Real*, (1 << (D - 1))> r;
        for (std::size_t i = 0; i < r.size(); ++i) r[i] = f->r.c[colour] + child[i] + s;
        Real* b = c->b.c[(row.parity + s) & 1] + row.at;
        HOULE_INDEPENDENT
        for (index m = row.begin; m < row.end; ++m) {
          Real sum = r[0][2 * m] + r[1][2 * m];
          if constexpr (D == 3) sum += r[2][2 * m] + r[3][2 * m];
          b[m] = colour == 0 ? sum : b[m] + sum;
        }
      }
    });
  }
}

// fine.x += coarse.x; in the red cells only where the black ones are overwritten next.
template <int D, class Real>
inline void prolong(const Level<D, Real>& coarse, Level<D, Real>& fine) {
  auto* f = &fine;
  auto* c = &coarse;
  for_rows(coarse.layout, [=](const Pencil& row) {
    const Real* even = c->x.c[row.parity] + row.at;
    const Real* odd = c->x.c[1 - row.parity] + row.at;
    for (int colour = 0; colour < (f->layout.odd ? 2 : 1); ++colour)
      for (index at : children(f->layout, row)) {
        Real* x = f->x.c[colour] + at;
        HOULE_INDEPENDENT
        for (index m = row.begin; m < row.end; ++m) {
          x[2 * m] += even[m];
          x[2 * m + 1] += odd[m];
        }
      }
  });
}

}  // namespace houle::multigrid

namespace houle {

struct SolveResult {
  int iterations;   // -1: the tolerance was not reached
  double residual;  // max-norm, recomputed from p
};

template <int D, class Real = float>
class PressureSolver {
 public:
  explicit PressureSolver(const Grid<D>& grid) : grid_(grid) {
    auto shape = grid.shape;
    levels_.emplace_back(shape, grid.periodic);
    while (*std::max_element(shape.begin(), shape.end()) > 1) {
      for (index& n : shape) n = (n + 1) / 2;
      levels_.emplace_back(shape, grid.periodic);
    }
    const auto& l = fine();
    for (auto& f : k_) f.allocate(l.size);
    for (auto* f : {&d_, &x_, &b_, &r_, &p_, &q_}) f->allocate(l.size);
    part_.assign(l.pencils, 0);
    mask_row_ = grid.shape[D - 1] + 2;
    index rows = 1;
    for (int a = D - 2; a >= 0; --a) {
      mask_step_[a] = rows * mask_row_;
      rows *= grid.shape[a] + 2;
    }
    mask_.assign(rows * mask_row_, 0);
    const index most = l.pencils * ((grid.shape[D - 1] + 1) / 2);
    runs_.reserve(most);
    run_start_.assign(l.pencils + 1, 0);
    sums_.reserve(most);
  }

  // active (cells, 0 or 1), k (faces), e (cells): the system of the following solves. Copies what it needs.
  void setup(const std::uint8_t* active, ConstFaces<D> k, const double* e) {
    copy_mask(active);
    build_fine(k, e);
    for (std::size_t i = 1; i < levels_.size(); ++i) multigrid::coarsen(levels_[i - 1], levels_[i]);
    find_closed(k, e);
  }

  const Grid<D>& grid() const { return grid_; }
  int closed_components() const { return closed_; }
  int half_sweeps = 4;

  // p: in the first guess, out the solution. Stops when the max-norm of the residual is at most `tolerance`.
  SolveResult solve(const double* rhs, double* p, double tolerance, int max_iterations) {
    load(p, x_);
    load(rhs, b_);
    remove_means(b_);
    remove_means(x_);
    double norm = true_residual(), reached = norm;
    int iterations = 0;
    bool restart = true;
    double rz = 0;
    while (!(norm <= tolerance) && std::isfinite(norm) && iterations < max_iterations) {
      if (restart) round_residual(1 / norm);
      cycle(0);
      const double rz_new = dot_rz();
      if (!(rz_new > 0)) break;
      direction(restart ? 0.0 : rz_new / rz);
      rz = rz_new;
      const double pq = apply();
      if (!(pq > 0)) break;
      norm = advance(rz / pq);
      ++iterations;
      restart = false;
      if (norm <= tolerance) {
        norm = true_residual();
        if (norm > 0.5 * reached) break;  // round-off reached
        reached = norm;
        restart = true;
      }
    }
    remove_means(x_);
    norm = true_residual();
    store(p);
    return {norm <= tolerance ? iterations : -1, norm};
  }

 private:
  using Pencil = multigrid::Pencil;
  using Doubles = multigrid::Field<double>;
  struct Run {
    index at;
    std::int32_t first, last, parity;
    std::int32_t parent;  // union-find; after find_closed: number of its closed component or -1
    bool open;
  };

  Grid<D> grid_;
  std::vector<multigrid::Level<D, Real>> levels_;
  std::array<Doubles, D> k_;
  Doubles d_, x_, b_, r_, p_, q_;
  std::vector<double> part_;  // one partial sum per pencil
  std::vector<std::uint8_t> mask_;
  index mask_row_ = 0;
  std::array<index, D> mask_step_{};
  std::vector<Run> runs_;
  std::vector<index> run_start_;
  struct Sum {
    double value;
    index cells;
  };
  std::vector<Sum> sums_;
  int closed_ = 0;
  double scale_ = 1;

  multigrid::Layout<D>& fine() { return levels_[0].layout; }

  index mask_offset(const std::array<index, D>& i) const {
    index at = 1;
    for (int a = 0; a < D - 1; ++a) at += (i[a] + 1) * mask_step_[a];
    return at;
  }

  // The mask with a ghost layer: empty at walls, wrapped on periodic axes. Finds the active range of every pencil.
  void copy_mask(const std::uint8_t* active) {
    auto* self = this;
    const index n = grid_.shape[D - 1];
    parallel_for(
        fine().pencils,
        [=](index p) {
          auto& l = self->fine();
          const auto i = l.place(p);
          const std::uint8_t* from = active + p * n;
          std::uint8_t* to = self->mask_.data() + self->mask_offset(i);
          index first = 0, last = n;
          while (first < n && !from[first]) ++first;
          while (last > first && !from[last - 1]) --last;
          l.first[p] = static_cast<std::int32_t>(first);
          l.last[p] = static_cast<std::int32_t>(last);
          HOULE_INDEPENDENT
          for (index j = 0; j < n; ++j) to[j] = from[j] != 0;
          if (l.wrap[D - 1]) {
            to[-1] = to[n - 1];
            to[n] = to[0];
          }
          for (int a = 0; a < D - 1; ++a) {
            if (!l.wrap[a]) continue;
            if (i[a] == 0) std::memcpy(to + l.n[a] * self->mask_step_[a], to, n);
            if (i[a] == l.n[a] - 1) std::memcpy(to - l.n[a] * self->mask_step_[a], to, n);
          }
        },
        fine().grain);
  }

  void build_fine(ConstFaces<D> k, const double* e) {
    auto* self = this;
    auto& l = fine();
    parallel_for(l.pencils, [=](index p) { self->clear_fine(p); }, l.grain);
    l.list(nullptr);
    // the pencils' own numbers are needed too: walk all pencils
    parallel_for(l.pencils, [=](index p) { self->fill_fine(p, k, e); }, l.grain);
    auto& level = levels_[0];
    for (int a = 0; a < D; ++a)
      for (int c = 0; c < 2; ++c) {
        multigrid::exchange(l, k_[a], c, a);
        multigrid::exchange(l, level.k[a], c, a);
      }
    level.invert();
  }

  void clear_fine(index p) {
    auto& l = fine();
    const Pencil now = l.pencil(p);
    const index lo = std::min<index>(now.lo, l.old_lo[p]), hi = std::max<index>(now.hi, l.old_hi[p]);
    for (int c = 0; c < 2; ++c) {
      for (auto& f : k_) std::fill(f.c[c] + now.at + lo, f.c[c] + now.at + hi, 0.0);
      for (auto* f : {&d_, &x_, &b_, &r_, &p_, &q_}) std::fill(f->c[c] + now.at + lo, f->c[c] + now.at + hi, 0.0);
    }
    levels_[0].clear(now, p);
  }

  void fill_fine(index p, ConstFaces<D> k, const double* e) {
    auto& l = fine();
    if (l.first[p] >= l.last[p]) return;
    const Pencil row = l.pencil(p);
    const auto i = l.place(p);
    const index n = grid_.shape[D - 1];
    std::array<const double*, D> k_lo, k_hi;
    for (int a = 0; a < D - 1; ++a) {
      index face = 0;
      for (int t = 0; t < D - 1; ++t) face = face * (l.n[t] + (t == a)) + i[t];
      index up = n;
      for (int t = a + 1; t < D - 1; ++t) up *= l.n[t];
      k_lo[a] = k[a] + face * n;
      k_hi[a] = k_lo[a] + up;
    }
    k_lo[D - 1] = k[D - 1] + p * (n + 1);
    k_hi[D - 1] = k_lo[D - 1] + 1;
    const std::uint8_t* mask = mask_.data() + mask_offset(i);
    std::array<index, D> mask_step = mask_step_;
    mask_step[D - 1] = 1;
    const double* extra = e + p * n;
    auto& level = levels_[0];
    for (index s = 0; s < 2; ++s) {
      const int c = (row.parity + static_cast<int>(s)) & 1;
      const index end = std::min<index>(row.end, (n - s + 1) / 2);
      double* d = d_.c[c] + row.at;
      Real* df = level.d.c[c] + row.at;
      Real* ef = level.e.c[c] + row.at;
      HOULE_INDEPENDENT
      for (index m = row.begin; m < end; ++m) {
        d[m] = mask[2 * m + s] ? extra[2 * m + s] : 0.0;
        ef[m] = static_cast<Real>(d[m]);
      }
      for (int a = 0; a < D; ++a) {
        double* kd = k_[a].c[c] + row.at;
        Real* kf = level.k[a].c[c] + row.at;
        const double *lower = k_lo[a], *upper = k_hi[a];
        const std::uint8_t *below = mask - mask_step[a], *above = mask + mask_step[a];
        HOULE_INDEPENDENT
        for (index m = row.begin; m < end; ++m) {
          const index j = 2 * m + s;
          const double v = (mask[j] & below[j]) ? lower[j] : 0.0;
          const double w = (mask[j] & above[j]) ? upper[j] : 0.0;
          kd[m] = v;
          kf[m] = static_cast<Real>(v);
          d[m] += v + w;
        }
      }
      HOULE_INDEPENDENT
      for (index m = row.begin; m < end; ++m) df[m] = static_cast<Real>(d[m]);
    }
  }

  // ---- closed components: runs of linked cells along pencils, joined across pencils by union-find

  int root(int r) {
    while (runs_[r].parent != r) r = runs_[r].parent = runs_[runs_[r].parent].parent;
    return r;
  }
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (b < a) std::swap(a, b);
    runs_[b].parent = a;
    runs_[a].open = runs_[a].open || runs_[b].open;
  }

  void find_closed(ConstFaces<D> k, const double* e) {
    auto& l = fine();
    const index n = grid_.shape[D - 1];
    runs_.clear();
    for (index p = 0; p < l.pencils; ++p) {
      run_start_[p] = static_cast<index>(runs_.size());
      if (l.first[p] >= l.last[p]) continue;
      const Pencil row = l.pencil(p);
      const std::uint8_t* mask = mask_.data() + mask_offset(l.place(p));
      const double* up = k[D - 1] + p * (n + 1);
      for (index j = l.first[p]; j < l.last[p];) {
        if (!mask[j]) {
          ++j;
          continue;
        }
        const index start = j;
        bool open = e[p * n + j] > 0;
        for (++j; j < l.last[p] && mask[j] && up[j] > 0; ++j) open = open || e[p * n + j] > 0;
        runs_.push_back({row.at, static_cast<std::int32_t>(start), static_cast<std::int32_t>(j), row.parity,
                         static_cast<std::int32_t>(runs_.size()), open});
      }
    }
    run_start_[l.pencils] = static_cast<index>(runs_.size());
    for (index p = 0; p < l.pencils; ++p) join_neighbours(p, k);
    closed_ = 0;
    for (int r = 0; r < static_cast<int>(runs_.size()); ++r) {  // roots come first
      Run& run = runs_[r];
      if (run.parent == r) run.parent = run.open ? -1 : ~(++closed_);
      else run.parent = runs_[run.parent].parent;
    }
    if (closed_ == 0) return;
    for (auto& run : runs_) run.parent = run.parent == -1 ? -1 : ~run.parent - 1;
    sums_.assign(closed_, {0, 0});
  }

  void join_neighbours(index p, ConstFaces<D> k) {
    auto& l = fine();
    const index n = grid_.shape[D - 1];
    if (run_start_[p] == run_start_[p + 1]) return;
    const auto i = l.place(p);
    if (l.wrap[D - 1] && k[D - 1][p * (n + 1)] > 0 && runs_[run_start_[p]].first == 0 &&
        runs_[run_start_[p + 1] - 1].last == n)
      join(static_cast<int>(run_start_[p]), static_cast<int>(run_start_[p + 1] - 1));
    for (int a = 0; a < D - 1; ++a) {
      if (i[a] == 0 && !l.wrap[a]) continue;
      index face = 0, q = 0;
      for (int t = 0; t < D - 1; ++t) {
        face = face * (l.n[t] + (t == a)) + i[t];
        q = q * l.n[t] + (t == a ? (i[t] + l.n[t] - 1) % l.n[t] : i[t]);
      }
      const double* link = k[a] + face * n;
      index x = run_start_[p], y = run_start_[q];
      while (x < run_start_[p + 1] && y < run_start_[q + 1]) {
        const index from = std::max(runs_[x].first, runs_[y].first), to = std::min(runs_[x].last, runs_[y].last);
        for (index j = from; j < to; ++j)
          if (link[j] > 0) {
            join(static_cast<int>(x), static_cast<int>(y));
            break;
          }
        if (runs_[x].last < runs_[y].last) ++x;
        else ++y;
      }
    }
  }

  void remove_means(const Doubles& f) {
    if (closed_ == 0) return;
    for (auto& s : sums_) s = {0, 0};
    auto entry = [&](const Run& r, index j) -> double& { return f.c[(r.parity + j) & 1][r.at + j / 2]; };
    for (const Run& r : runs_) {
      if (r.parent < 0) continue;
      for (index j = r.first; j < r.last; ++j) sums_[r.parent].value += entry(r, j);
      sums_[r.parent].cells += r.last - r.first;
    }
    for (const Run& r : runs_) {
      if (r.parent < 0) continue;
      const double mean = sums_[r.parent].value / static_cast<double>(sums_[r.parent].cells);
      for (index j = r.first; j < r.last; ++j) entry(r, j) -= mean;
    }
  }

  // ---- conjugate gradients

  void load(const double* from, const Doubles& to) {
    auto* self = this;
    auto* field = &to;
    const index n = grid_.shape[D - 1];
    parallel_for(
        fine().pencils,
        [=](index p) {
          auto& l = self->fine();
          if (l.first[p] >= l.last[p]) return;
          const Pencil row = l.pencil(p);
          for (index s = 0; s < 2; ++s) {
            const int c = (row.parity + static_cast<int>(s)) & 1;
            const index end = std::min<index>(row.end, (n - s + 1) / 2);
            const double* d = self->d_.c[c] + row.at;
            double* x = field->c[c] + row.at;
            const double* source = from + p * n + s;
            HOULE_INDEPENDENT
            for (index m = row.begin; m < end; ++m) x[m] = d[m] > 0 ? source[2 * m] : 0.0;
          }
        },
        fine().grain);
  }

  void store(double* to) {
    auto* self = this;
    const index n = grid_.shape[D - 1];
    parallel_for(
        fine().pencils,
        [=](index p) {
          auto& l = self->fine();
          const Pencil row = l.pencil(p);
          double* target = to + p * n;
          std::fill(target, target + std::min<index>(n, 2 * row.begin), 0.0);
          std::fill(target + std::min<index>(n, 2 * row.end), target + n, 0.0);
          for (index s = 0; s < 2; ++s) {
            const int c = (row.parity + static_cast<int>(s)) & 1;
            const index end = std::min<index>(row.end, (n - s + 1) / 2);
            const double* x = self->x_.c[c] + row.at;
            HOULE_INDEPENDENT
            for (index m = row.begin; m < end; ++m) target[2 * m + s] = x[m];
          }
        },
        fine().grain);
  }

  template <class Body>
  void partials(Body body) {  // part_[i] = body(pencil i)
    double* part = part_.data();
    const Pencil* rows = fine().rows.data();
    parallel_for(static_cast<index>(fine().rows.size()), [=](index i) { part[i] = body(rows[i]); }, fine().grain);
  }
  template <class Body>
  double sum(Body body) {
    partials(body);
    double s = 0;
    for (std::size_t i = 0; i < fine().rows.size(); ++i) s += part_[i];
    return s;
  }
  template <class Body>
  double largest(Body body) {
    partials(body);
    double s = 0;
    for (std::size_t i = 0; i < fine().rows.size(); ++i) s = (part_[i] > s || std::isnan(part_[i])) ? part_[i] : s;
    return s;
  }

  double true_residual() {  // r = b - A x; returns its max-norm
    auto* self = this;
    for (int c = 0; c < 2; ++c) multigrid::exchange(fine(), x_, c);
    return largest([=](const Pencil& row) {
      double most[multigrid::width] = {};
      for (int c = 0; c < 2; ++c) {
        const multigrid::Star<D, double> star(self->fine(), self->k_, self->x_, row, c);
        const double* d = self->d_.c[c] + row.at;
        const double* b = self->b_.c[c] + row.at;
        const double* x = self->x_.c[c] + row.at;
        double* r = self->r_.c[c] + row.at;
        HOULE_INDEPENDENT
        for (index m = row.lo; m < row.hi; ++m) r[m] = d[m] > 0 ? b[m] + star(m) - d[m] * x[m] : 0.0;
        for (index m = row.lo; m < row.hi; m += multigrid::width)
          for (int v = 0; v < multigrid::width; ++v) {
            const double size = std::abs(r[m + v]);
            most[v] = size <= most[v] ? most[v] : size;
          }
      }
      double all = 0;
      for (double m : most) all = m <= all ? all : m;
      return all;
    });
  }

  void round_residual(double scale) {
    scale_ = scale;
    auto* self = this;
    multigrid::for_rows(fine(), [=](const Pencil& row) {
      for (int c = 0; c < 2; ++c) {
        const double* r = self->r_.c[c] + row.at;
        Real* b = self->levels_[0].b.c[c] + row.at;
        HOULE_INDEPENDENT
        for (index m = row.lo; m < row.hi; ++m) b[m] = static_cast<Real>(scale * r[m]);
      }
    });
  }

  double dot_rz() {
    auto* self = this;
    return sum([=](const Pencil& row) {
      double s[multigrid::width] = {};
      for (int c = 0; c < 2; ++c) {
        const double* r = self->r_.c[c] + row.at;
        const Real* z = self->levels_[0].x.c[c] + row.at;
        for (index m = row.lo; m < row.hi; m += multigrid::width)
          for (int v = 0; v < multigrid::width; ++v) s[v] += r[m + v] * static_cast<double>(z[m + v]);
      }
      return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
    });
  }

  void direction(double beta) {
    auto* self = this;
    multigrid::for_rows(fine(), [=](const Pencil& row) {
      for (int c = 0; c < 2; ++c) {
        double* p = self->p_.c[c] + row.at;
        const Real* z = self->levels_[0].x.c[c] + row.at;
        HOULE_INDEPENDENT
        for (index m = row.lo; m < row.hi; ++m) p[m] = static_cast<double>(z[m]) + beta * p[m];
      }
    });
  }

  double apply() {  // q = A p; returns p . q
    auto* self = this;
    for (int c = 0; c < 2; ++c) multigrid::exchange(fine(), p_, c);
    return sum([=](const Pencil& row) {
      double s[multigrid::width] = {};
      for (int c = 0; c < 2; ++c) {
        const multigrid::Star<D, double> star(self->fine(), self->k_, self->p_, row, c);
        const double* d = self->d_.c[c] + row.at;
        const double* p = self->p_.c[c] + row.at;
        double* q = self->q_.c[c] + row.at;
        HOULE_INDEPENDENT
        for (index m = row.lo; m < row.hi; ++m) q[m] = d[m] > 0 ? d[m] * p[m] - star(m) : 0.0;
        for (index m = row.lo; m < row.hi; m += multigrid::width)
          for (int v = 0; v < multigrid::width; ++v) s[v] += p[m + v] * q[m + v];
      }
      return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
    });
  }

  double advance(double alpha) {  // x += alpha p, r -= alpha q; returns the max-norm of r
    auto* self = this;
    const double scale = scale_;
    return largest([=](const Pencil& row) {
      double most[multigrid::width] = {};
      for (int c = 0; c < 2; ++c) {
        const double* p = self->p_.c[c] + row.at;
        const double* q = self->q_.c[c] + row.at;
        double* x = self->x_.c[c] + row.at;
        double* r = self->r_.c[c] + row.at;
        Real* b = self->levels_[0].b.c[c] + row.at;
        HOULE_INDEPENDENT
        for (index m = row.lo; m < row.hi; ++m) {
          x[m] += alpha * p[m];
          r[m] -= alpha * q[m];
          b[m] = static_cast<Real>(scale * r[m]);
        }
        for (index m = row.lo; m < row.hi; m += multigrid::width)
          for (int v = 0; v < multigrid::width; ++v) {
            const double size = std::abs(r[m + v]);
            most[v] = size <= most[v] ? most[v] : size;
          }
      }
      double all = 0;
      for (double m : most) all = m <= all ? all : m;
      return all;
    });
  }

  void cycle(std::size_t i) {
    auto& level = levels_[i];
    if (i + 1 == levels_.size()) {
      level.relax_zero(0);
      level.relax_zero(1);
      return;
    }
    int colour = half_sweeps % 2 == 0 ? 0 : 1;
    level.relax_zero(colour);
    for (int s = 1; s < half_sweeps; ++s) level.relax(colour = 1 - colour);
    multigrid::restrict_residual(level, levels_[i + 1]);
    cycle(i + 1);
    multigrid::prolong(levels_[i + 1], level);
    colour = 0;
    for (int s = 0; s < half_sweeps; ++s) level.relax(colour = 1 - colour);
  }
};

}  // namespace houle
