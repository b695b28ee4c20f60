// Pressure: sum over faces k_f (p_c - p_nb) + e_c p_c = rhs_c in the active cells of a MAC grid, by conjugate gradients
// preconditioned with one multigrid V-cycle.
//
// * A level coarsens 2 x 2 (x 2) cells into one; transfers are piecewise constant. A coarse face is the sum of the fine
//   ones, each in series with half a fine cell on either side where there is one (k / 2 inside uniform water, more next
//   to a surface or wall that cuts a coarse cell short), so every level keeps the 2 D-neighbour stencil.
// * The smoother is red-black Gauss-Seidel, in the reverse order after the coarse correction: the cycle is symmetric.
// * The cells of a pencil (a column along the last axis) are stored by colour: cell j = 2 m + s of a pencil is entry
//   m of one of two arrays. All neighbours of a colour are then contiguous in the other, and half sweeps vectorise.
// * Cells of one colour that were just relaxed have no residual, and the first half sweep after a correction overwrites
//   that colour: so only red residuals are restricted and only red cells receive the correction. For the same reason
//   conjugate gradients run on the red cells, the black ones following so that their residual stays zero.
// * The cycle is in single precision (Real), conjugate gradients in double.
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
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "grid.hpp"
#include "parallel.hpp"

namespace houle::multigrid {

constexpr int width = 8;  // ranges are whole multiples of this many entries: no loop needs a remainder

struct Pencil {
  index at;                 // entry m = 0 in every array of the level
  index child;              // the same of its first pencil on the finer level
  std::int32_t begin, end;  // its active cells are among the entries [begin, end) ...
  std::int32_t lo, hi;      // ... and these are inside [lo, hi), whole vectors
  std::int32_t parity;      // cell j = 2 m + s is of colour (parity + s) % 2
};

struct Seam {         // a pencil at one end of a periodic axis and the ghost pencil beyond the other end
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
  index half = 0;                                // entries per pencil and colour
  index shift = 0;                               // entries before m = 0: the ghost of a periodic last axis
  std::array<index, D> step{};                   // entries between neighbouring pencils along each axis but the last
  index size = 0;                                // entries per colour, ghost pencils included
  index pencils = 0;                             // pencils inside the grid
  std::vector<std::int32_t> first, last;         // active cells of every pencil inside: j in [first, last)
  std::vector<std::int32_t> old_begin, old_end;  // active entries at the last setup
  std::vector<Pencil> rows;                      // the pencils with active cells
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
    old_begin.assign(pencils, 0);
    old_end.assign(pencils, 0);
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

  // Zeroes the entries that were active before and are not now: everything else outside [begin, end) is zero already.
  template <class Real>
  void clear(const Field<Real>& f, const Pencil& now, index p) const {
    for (int c = 0; c < 2; ++c) {
      Real* row = f.c[c] + now.at;
      for (index m = old_begin[p]; m < std::min(now.begin, old_end[p]); ++m) row[m] = 0;
      for (index m = std::max(now.end, old_begin[p]); m < old_end[p]; ++m) row[m] = 0;
    }
  }
  bool shrinks(const Pencil& now, index p) const {
    return old_begin[p] < old_end[p] && (old_begin[p] < now.begin || old_end[p] > now.end);
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

// Calls body(s, i, n) for the entries [i, i + n) of one colour in one pencil; s is 0 or 1: they are the cells j = 2 m +
// s.
template <class Body>
inline void with_entries(const Pencil& row, int colour, Body& body) {
  const index n = static_cast<index>(row.hi - row.lo) & ~static_cast<index>(width - 1);  // a multiple of width: no tail
  if ((row.parity + colour) & 1)
    body(std::integral_constant<index, 1>{}, row.at + row.lo, n);
  else
    body(std::integral_constant<index, 0>{}, row.at + row.lo, n);
}

template <int D, class Body>
inline void sweep(const Layout<D>& l, int colour, Body body) {
  for_rows(l, [=](const Pencil& row) { with_entries(row, colour, body); });
}

// Copies what lies beyond the periodic ends (of one axis, or of all) into the ghost entries of one colour.
template <int D, class Real>
inline void exchange(const Layout<D>& l, const Field<Real>& x, int colour, int axis = -1) {
  for (const Seam& s : l.seams)
    if (axis < 0 || s.axis == axis)
      std::memcpy(x.c[colour] + s.to, x.c[colour ^ s.swap] + s.from, l.half * sizeof(Real));
  if (!l.shift || (axis >= 0 && axis != D - 1)) return;
  const index n = l.n[D - 1];
  for (const Pencil& r : l.rows) {
    auto entry = [&](index j) { return r.at + ((j + 2) / 2 - 1); };
    auto tint = [&](index j) { return (r.parity + static_cast<int>((j + 2) & 1)) & 1; };
    if (tint(-1) == colour) x.c[colour][entry(-1)] = x.c[tint(n - 1)][entry(n - 1)];
    if (tint(n) == colour) x.c[colour][entry(n)] = x.c[tint(0)][entry(0)];
  }
}

// What couples the cells of one colour to their neighbours: star(s, i) = sum of k_f p_nb over the faces of entry i.
template <int D, class Real>
struct Star {
  std::array<const Real*, D> own, other;  // coefficients of the lower faces of this and of the other colour
  const Real* x;                          // the other colour
  std::array<index, D> step;

  Star(const Layout<D>& l, const std::array<Field<Real>, D>& k, const Field<Real>& f, int colour)
      : x(f.c[1 - colour]), step(l.step) {
    for (int a = 0; a < D; ++a) {
      own[a] = k[a].c[colour];
      other[a] = k[a].c[1 - colour];
    }
  }
  template <class S>
  Real operator()(S s, index i) const {
    Real sum = own[D - 1][i] * x[i + s - 1] + other[D - 1][i + s] * x[i + s];
    for (int a = 0; a < D - 1; ++a) sum += own[a][i] * x[i - step[a]] + other[a][i + step[a]] * x[i + step[a]];
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

  void clear(const Pencil& now, index p) {
    if (layout.shrinks(now, p)) {
      for (auto& f : k) layout.clear(f, now, p);
      for (auto* f : {&e, &d, &inverse, &x, &b, &r}) layout.clear(*f, now, p);
    }
    layout.old_begin[p] = now.begin;
    layout.old_end[p] = now.end;
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
    const Real *inverse = this->inverse.c[colour], *b = this->b.c[colour];
    Real *x = this->x.c[colour], *rest = layout.odd ? this->x.c[1 - colour] : nullptr;
    sweep(layout, colour, [=](auto, index first, index n) {
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) x[i] = inverse[i] * b[i];
      if (rest) std::fill(rest + first, rest + first + n, Real(0));
    });
  }

  void relax(int colour) {
    exchange(layout, x, 1 - colour);
    const Star<D, Real> star(layout, k, x, colour);
    const Real *inverse = this->inverse.c[colour], *b = this->b.c[colour];
    Real* x = this->x.c[colour];
    sweep(layout, colour, [=](auto s, index first, index n) {
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) x[i] = inverse[i] * (b[i] + star(s, i));
    });
  }

  void residual(int colour) {
    exchange(layout, x, 1 - colour);
    const Star<D, Real> star(layout, k, x, colour);
    const Real *d = this->d.c[colour], *b = this->b.c[colour], *x = this->x.c[colour];
    Real* r = this->r.c[colour];
    sweep(layout, colour, [=](auto s, index first, index n) {
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) r[i] = d[i] > 0 ? b[i] + star(s, i) - d[i] * x[i] : 0;
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

// A face between coarse cells stands for the fine face k in series with half a fine cell on either side, if there is
// one: its coefficient is `below` or `above`. Never less than k / 2: weak faces inside must not uncouple strong ones.
template <class Real>
inline Real coupled(Real k, Real below, Real above) {
  const Real least = std::max(k, std::numeric_limits<Real>::min());
  const Real b = below > 0 ? least / std::max(least, below) : Real(0);
  const Real a = above > 0 ? least / std::max(least, above) : Real(0);
  return k / (1 + Real(0.5) * (a + b));
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
        const index at = child[i] + s;
        for (int a = 0; a < D - 1; ++a) {
          if (i >> a & 1) continue;
          Real* k = c->k[a].c[colour] + row.at;
          for (int t = 0; t < 2; ++t) {
            const Real* link = f->k[a].c[t] + at;
            const Real* above = f->k[a].c[1 - t] + at + f->layout.step[a];
            const Real* below = f->k[a].c[1 - t] + at - f->layout.step[a];
            HOULE_INDEPENDENT
            for (index m = row.begin; m < row.end; ++m)
              k[m] = (i + t > 0 ? k[m] : Real(0)) + coupled(link[2 * m], below[2 * m], above[2 * m]);
          }
        }
        Real* k = c->k[D - 1].c[colour] + row.at;
        Real* e = c->e.c[colour] + row.at;
        const Real* link = f->k[D - 1].c[even] + at;
        const Real* inner = f->k[D - 1].c[1 - even] + at;
        const Real* e0 = f->e.c[even] + at;
        const Real* e1 = f->e.c[1 - even] + at;
        HOULE_INDEPENDENT
        for (index m = row.begin; m < row.end; ++m) {
          k[m] = (i > 0 ? k[m] : Real(0)) + coupled(link[2 * m], inner[2 * m - 1], inner[2 * m]);
          e[m] = (i > 0 ? e[m] : Real(0)) + coupled(e0[2 * m], Real(0), inner[2 * m]) +
                 coupled(e1[2 * m], Real(0), inner[2 * m]);
        }
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
    for (auto* f : {&d_, &inverse_, &x_, &b_, &r_, &p_, &q_}) f->allocate(l.size);
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

  // Addresses and capacities of all that could grow: the same after every set-up and solve.
  std::vector<std::uintptr_t> buffers() const {
    std::vector<std::uintptr_t> all;
    auto note = [&](const auto& v) {
      all.push_back(reinterpret_cast<std::uintptr_t>(v.data()));
      all.push_back(v.capacity());
    };
    for (const auto& level : levels_) note(level.layout.rows);
    note(runs_);
    note(sums_);
    note(part_);
    return all;
  }

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
    if (!std::isfinite(norm)) forget();
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
  Doubles d_, inverse_, x_, b_, r_, p_, q_;
  std::vector<double> part_;  // one partial sum per block of pencils
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
          std::memcpy(to, from, n);
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
    parallel_for(l.pencils, [=](index p) { self->fill_fine(p, k, e); }, l.grain);
    auto& level = levels_[0];
    for (int a = 0; a < D; ++a)
      for (int c = 0; c < 2; ++c) {
        multigrid::exchange(l, k_[a], c, a);
        multigrid::exchange(l, level.k[a], c, a);
      }
  }

  void clear_fine(index p) {
    auto& l = fine();
    const Pencil now = l.pencil(p);
    if (l.shrinks(now, p)) {
      for (auto& f : k_) l.clear(f, now, p);
      for (auto* f : {&d_, &inverse_, &x_, &b_, &r_, &p_, &q_}) l.clear(*f, now, p);
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
      std::array<double*, D> kd;
      std::array<Real*, D> kf;
      for (int a = 0; a < D; ++a) {
        kd[a] = k_[a].c[c] + row.at;
        kf[a] = level.k[a].c[c] + row.at;
      }
      double *d = d_.c[c] + row.at, *inverse = inverse_.c[c] + row.at;
      Real *df = level.d.c[c] + row.at, *ef = level.e.c[c] + row.at, *inversef = level.inverse.c[c] + row.at;
      HOULE_INDEPENDENT
      for (index m = row.begin; m < end; ++m) {
        const index j = 2 * m + s;
        const bool in = mask[j] != 0;
        const double value = extra[j];
        double sum = in ? value : 0.0;
        ef[m] = static_cast<Real>(sum);
        for (int a = 0; a < D; ++a) {
          const double lower = k_lo[a][j], upper = k_hi[a][j];
          const bool below = mask[j - mask_step[a]] != 0, above = mask[j + mask_step[a]] != 0;
          const double v = in & below ? lower : 0.0, w = in & above ? upper : 0.0;
          kd[a][m] = v;
          kf[a][m] = static_cast<Real>(v);
          sum += v + w;
        }
        d[m] = sum;
        df[m] = static_cast<Real>(sum);
        const double one_over = sum > 0 ? 1 / sum : 0.0;
        inverse[m] = one_over;
        inversef[m] = static_cast<Real>(one_over);
      }
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
      if (run.parent == r)
        run.parent = run.open ? -1 : ~(++closed_);
      else
        run.parent = runs_[run.parent].parent;
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
        if (runs_[x].last < runs_[y].last)
          ++x;
        else
          ++y;
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

  void forget() {  // zeroes all vectors, so that no NaN survives in entries that are never read but multiplied by zero
    for (auto* f : {&x_, &b_, &r_, &p_, &q_}) std::fill(f->store.begin(), f->store.end(), 0.0);
    for (auto& level : levels_)
      for (auto* f : {&level.x, &level.b, &level.r}) std::fill(f->store.begin(), f->store.end(), Real(0));
  }

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
            for (index m = row.begin; m < end; ++m) {
              const double value = source[2 * m];
              x[m] = d[m] > 0 ? value : 0.0;
            }
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

  template <class Other>
  static void add_products(const double* a, const Other* b, index n, double* lanes) {
    double sum[multigrid::width] = {};
    for (index i = 0; i < n; i += multigrid::width)
      for (int v = 0; v < multigrid::width; ++v) sum[v] += a[i + v] * static_cast<double>(b[i + v]);
    for (int v = 0; v < multigrid::width; ++v) lanes[v] += sum[v];
  }
  static double larger(double a, double b) { return (a >= b) | (a != a) ? a : b; }  // NaN wins
  static void max_size(const double* a, index n, double* lanes) {
    double most[multigrid::width] = {};
    for (index i = 0; i < n; i += multigrid::width)
      for (int v = 0; v < multigrid::width; ++v) {
        const double size = std::abs(a[i + v]);
        most[v] = larger(most[v], size);
      }
    for (int v = 0; v < multigrid::width; ++v) lanes[v] = larger(lanes[v], most[v]);
  }

  // Sums or maxima over the colours in use: body(colour, s, first, n, lanes) adds n entries to eight partial results of
  // its block of pencils; all are combined in a fixed order.
  static constexpr index block = 16;  // pencils

  template <class Body, class Combine>
  double reduce(Body body, Combine combine) {
    double* part = part_.data();
    const Pencil* rows = fine().rows.data();
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
  template <class Body>
  double sum(Body body) {
    return reduce(body, [](double a, double b) { return a + b; });
  }
  template <class Body>
  double largest(Body body) {
    return reduce(body, [](double a, double b) { return larger(a, b); });
  }

  // On an even grid the black cells only see red ones: their residual is kept at zero and CG iterates on the red ones.
  int colours() const { return levels_[0].layout.odd ? 2 : 1; }

  using Star = multigrid::Star<D, double>;

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

  double true_residual() {  // r = b - A x; returns its max-norm
    extend(x_, b_.c[1]);
    for (int c = 0; c < 2; ++c) multigrid::exchange(fine(), x_, c);
    const std::array<Star, 2> stars{Star(fine(), k_, x_, 0), Star(fine(), k_, x_, 1)};
    const auto ds = d_.c, bs = b_.c, xs = x_.c, rs = r_.c;
    return largest([=](int c, auto s, index first, index n, double* lanes) {
      const Star star = stars[c];
      const double *d = ds[c], *b = bs[c], *x = xs[c];
      double* r = rs[c];
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) r[i] = d[i] > 0 ? b[i] + star(s, i) - d[i] * x[i] : 0.0;
      max_size(r + first, n, lanes);
    });
  }

  void round_residual(double scale) {
    scale_ = scale;
    for (int c = 0; c < colours(); ++c) {
      const double* r = r_.c[c];
      Real* b = levels_[0].b.c[c];
      multigrid::sweep(fine(), c, [=](auto, index first, index n) {
        HOULE_INDEPENDENT
        for (index i = first; i < first + n; ++i) b[i] = static_cast<Real>(scale * r[i]);
      });
    }
  }

  double dot_rz() {
    const auto rs = r_.c;
    const auto zs = levels_[0].x.c;
    return sum([=](int c, auto, index first, index n, double* lanes) {
      const double* r = rs[c] + first;
      const Real* z = zs[c] + first;
      add_products(r, z, n, lanes);
    });
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
    const auto ds = d_.c, ps = p_.c, qs = q_.c;
    return sum([=](int c, auto s, index first, index n, double* lanes) {
      const Star star = stars[c];
      const double *d = ds[c], *p = ps[c];
      double* q = qs[c];
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) q[i] = d[i] > 0 ? d[i] * p[i] - star(s, i) : 0.0;
      add_products(p + first, q + first, n, lanes);
    });
  }

  double advance(double alpha) {  // x += alpha p, r -= alpha q; returns the max-norm of r
    const auto ps = p_.c, qs = q_.c, xs = x_.c, rs = r_.c;
    const auto bs = levels_[0].b.c;
    const double scale = scale_;
    return largest([=](int c, auto, index first, index n, double* lanes) {
      const double *p = ps[c] + first, *q = qs[c] + first;
      double *x = xs[c] + first, *r = rs[c] + first;
      Real* b = bs[c] + first;
      HOULE_INDEPENDENT
      for (index i = 0; i < n; ++i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * q[i];
        b[i] = static_cast<Real>(scale * r[i]);
      }
      max_size(r, n, lanes);
    });
  }

  // One V-cycle for levels_[i].x from levels_[i].b, symmetric and positive definite. An even number of half sweeps.
  void cycle(std::size_t i) {
    auto& level = levels_[i];
    if (i + 1 == levels_.size()) {  // a single cell
      level.relax_zero(0);
      level.relax_zero(1);
      return;
    }
    const int half_sweeps = i == 0 ? 4 : 6;
    level.relax_zero(0);
    for (int s = 1; s < half_sweeps; ++s) level.relax(s % 2);
    multigrid::restrict_residual(level, levels_[i + 1]);
    cycle(i + 1);
    multigrid::prolong(levels_[i + 1], level);
    for (int s = 1; s <= half_sweeps; ++s) level.relax(s % 2);
  }
};

}  // namespace houle
