// The multigrid cycle that preconditions the pressure solver, in single precision.
//
// * A level coarsens 2 x 2 (x 2) cells into one; transfers are piecewise constant. A coarse face is the sum of the fine
//   ones, each in series with half a fine cell on either side where there is one (k / 2 inside uniform water, more next
//   to a surface or wall that cuts a coarse cell short), so every level keeps the 2 D-neighbour stencil.
// * The smoother is red-black Gauss-Seidel, in the reverse order after the coarse correction: the cycle is symmetric.
// * Cells of one colour that were just relaxed have no residual, and the first half sweep after a correction overwrites
//   that colour: so only red residuals are restricted and only red cells receive the correction.
#pragma once

#include <limits>

#include <houle/pressure/pencils.hpp>

namespace houle::multigrid {

// A level of the multigrid, as pointers to its numbers: coefficients, solution x, right-hand side b, residual r.
template <int D, class Real>
struct Level {
  Pencils<D> layout;
  std::array<Field<Real>, D> k;  // coefficient of the lower face of each cell, along each axis
  Field<Real> inverse;           // 1 / (e + sum of k), zero outside the active cells
  Field<Real> x, b, r;

  const Field<Real>& e() const { return r; }  // wanted until the level is coarsened; residuals come after that

  void clear(const Pencil& now, index p) const {
    if (layout.shrinks(now, p)) {
      for (auto& f : k) layout.clear(f, now, p);
      for (auto* f : {&inverse, &x, &b, &r}) layout.clear(*f, now, p);
    }
    layout.old_begin[p] = now.begin;
    layout.old_end[p] = now.end;
  }
};

// A level and its memory.
template <int D, class Real>
struct OwnLevel {
  Layout<D> layout;
  std::array<OwnField<Real>, D> k;
  OwnField<Real> inverse, x, b, r;

  OwnLevel(const std::array<index, D>& shape, const std::array<bool, D>& periodic) : layout(shape, periodic) {
    for (auto& f : k) f.allocate(layout.size);
    for (auto* f : {&inverse, &x, &b, &r}) f->allocate(layout.size);
  }
  OwnLevel(OwnLevel&&) = default;

  Level<D, Real> all() const {
    Level<D, Real> level{layout, {}, inverse, x, b, r};
    for (int a = 0; a < D; ++a) level.k[a] = k[a];
    return level;
  }
};

// The half sweeps of a level: each treats the cells of one colour in the pencils from begin to end. relax() solves
// their equations with their neighbours as they are, residual() writes b - A x.
template <int D, class Real>
struct Sweeps {
  std::array<Star<D, Real>, 2> star;
  std::array<const Real*, 2> b, inverse;
  std::array<Real*, 2> x, r;
  bool odd;

  explicit Sweeps(const Level<D, Real>& l)
      : star{Star<D, Real>(l.layout, l.k, l.x, 0), Star<D, Real>(l.layout, l.k, l.x, 1)}, odd(l.layout.odd) {
    for (int c = 0; c < 2; ++c) {
      b[c] = l.b.c[c];
      inverse[c] = l.inverse.c[c];
      x[c] = l.x.c[c];
      r[c] = l.r.c[c];
    }
  }

  void relax_zero(const Pencil* begin, const Pencil* end, int colour) const {  // the half sweep that starts from x = 0
    const Real *inverse = this->inverse[colour], *b = this->b[colour];
    Real *x = this->x[colour], *rest = odd ? this->x[1 - colour] : nullptr;
    auto entries = [=](auto, index first, index n) {
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) x[i] = inverse[i] * b[i];
      if (rest) std::fill(rest + first, rest + first + n, Real(0));
    };
    for (const Pencil* row = begin; row < end; ++row) with_entries(*row, colour, entries);
  }

  void relax(const Pencil* begin, const Pencil* end, int colour) const {
    const Star<D, Real> star = this->star[colour];
    const Real *inverse = this->inverse[colour], *b = this->b[colour];
    Real* x = this->x[colour];
    auto entries = [=](auto s, index first, index n) {
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) x[i] = inverse[i] * (b[i] + star(s, i));
    };
    for (const Pencil* row = begin; row < end; ++row) with_entries(*row, colour, entries);
  }

  void residual(const Pencil* begin, const Pencil* end, int colour) const {
    const Star<D, Real> star = this->star[colour];
    const Real *inverse = this->inverse[colour], *b = this->b[colour], *x = this->x[colour];
    Real* r = this->r[colour];
    auto entries = [=](auto s, index first, index n) {
      HOULE_INDEPENDENT
      for (index i = first; i < first + n; ++i) r[i] = inverse[i] > 0 ? b[i] + star(s, i) - x[i] / inverse[i] : 0;
    };
    for (const Pencil* row = begin; row < end; ++row) with_entries(*row, colour, entries);
  }
};

// The pencils of the finer level that one coarse pencil is made of.
template <int D>
inline std::array<index, (1 << (D - 1))> children(const Pencils<D>& fine, const Pencil& row) {
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

// Coarse coefficients from fine ones. coarser: the layout of the level after, null if there is none.
template <int D, class Real>
inline void coarsen(OwnLevel<D, Real>& fine, OwnLevel<D, Real>& coarse, const Layout<D>* coarser) {
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
  constexpr index heavy = 64;
  const Level<D, Real> f = fine.all(), c = coarse.all();
  parallel_for(lc.pencils, [=](index p) { c.clear(c.layout.pencil(p), p); }, lc.grain);
  lc.list(&lf, coarser);
  for_rows(
      lc,
      [=](const Pencil& row) {
        constexpr int pencils = 1 << (D - 1);
        const auto child = children(f.layout, row);
        for (int s = 0; s < 2; ++s) {
          const int colour = (row.parity + s) & 1;
          for (int i = 0; i < pencils; ++i) {
            const int even = D == 2 ? i & 1 : (i ^ (i >> 1)) & 1;  // colour of its cells with even j
            const index at = child[i] + s;
            for (int a = 0; a < D - 1; ++a) {
              if (i >> a & 1) continue;
              Real* k = c.k[a].c[colour] + row.at;
              for (int t = 0; t < 2; ++t) {
                const Real* link = f.k[a].c[t] + at;
                const Real* above = f.k[a].c[1 - t] + at + f.layout.step[a];
                const Real* below = f.k[a].c[1 - t] + at - f.layout.step[a];
                HOULE_INDEPENDENT
                for (index m = row.begin; m < row.end; ++m)
                  k[m] = (i + t > 0 ? k[m] : Real(0)) + coupled(link[2 * m], below[2 * m], above[2 * m]);
              }
            }
            Real* k = c.k[D - 1].c[colour] + row.at;
            Real* e = c.e().c[colour] + row.at;
            const Real* link = f.k[D - 1].c[even] + at;
            const Real* inner = f.k[D - 1].c[1 - even] + at;
            const Real* e0 = f.e().c[even] + at;
            const Real* e1 = f.e().c[1 - even] + at;
            HOULE_INDEPENDENT
            for (index m = row.begin; m < row.end; ++m) {
              k[m] = (i > 0 ? k[m] : Real(0)) + coupled(link[2 * m], inner[2 * m - 1], inner[2 * m]);
              e[m] = (i > 0 ? e[m] : Real(0)) + coupled(e0[2 * m], Real(0), inner[2 * m]) +
                     coupled(e1[2 * m], Real(0), inner[2 * m]);
            }
          }
        }
        for (int a = 0; a < D; ++a) {  // one cell around a periodic axis: no neighbour but itself
          if (c.layout.n[a] > 1) continue;
          for (int colour = 0; colour < 2; ++colour)
            std::fill(c.k[a].c[colour] + row.at + row.lo, c.k[a].c[colour] + row.at + row.hi, Real(0));
        }
      },
      heavy);
  for (int a = 0; a < D; ++a)
    for (int colour = 0; colour < 2; ++colour) exchange(lc, coarse.k[a], colour, a);
  for_rows(
      lc,
      [=](const Pencil& row) {
        for (int colour = 0; colour < 2; ++colour) {
          std::array<const Real*, 2 * D> k;
          for (int a = 0; a < D; ++a) {
            k[2 * a] = c.k[a].c[colour] + row.at;
            const index up = a < D - 1 ? c.layout.step[a] : (row.parity + colour) & 1;
            k[2 * a + 1] = c.k[a].c[1 - colour] + row.at + up;
          }
          const Real* e = c.e().c[colour] + row.at;
          Real* inverse = c.inverse.c[colour] + row.at;
          const index end = std::min<index>(row.end, (c.layout.n[D - 1] + 1 - ((row.parity + colour) & 1)) / 2);
          HOULE_INDEPENDENT
          for (index m = row.begin; m < end; ++m) {
            Real sum = e[m];
            for (int i = 0; i < 2 * D; ++i) sum += k[i][m];
            inverse[m] = sum > 0 ? 1 / sum : 0;
          }
        }
      },
      heavy);
}

// coarse.b = sums over the fine cells in each coarse one of the residual of one colour; the red one (0) is written, the
// black one, if there is one, added. It is done for the coarse pencils whose last children are in `part`: the children
// before these are in the slice before.
template <int D, class Real>
inline void restrict_residual(const Level<D, Real>& fine, const Level<D, Real>& coarse, int colour,
                              const Slices& part) {
  const Pencils<D>& l = coarse.layout;
  const index n = fine.layout.n[0], end = part.to == n ? l.n[0] : part.to / 2;
  for (const Pencil* row = l.row + l.slices[part.from / 2]; row < l.row + l.slices[end]; ++row) {
    const auto child = children(fine.layout, *row);
    for (int s = 0; s < 2; ++s) {
      std::array<const Real*, (1 << (D - 1))> r;
      for (std::size_t i = 0; i < r.size(); ++i) r[i] = fine.r.c[colour] + child[i] + s;
      Real* b = coarse.b.c[(row->parity + s) & 1] + row->at;
      HOULE_INDEPENDENT
      for (index m = row->begin; m < row->end; ++m) {
        Real sum = r[0][2 * m] + r[1][2 * m];
        if constexpr (D == 3) sum += r[2][2 * m] + r[3][2 * m];
        b[m] = colour == 0 ? sum : b[m] + sum;
      }
    }
  }
}

// fine.x += coarse.x on the fine pencils from begin to end; in the red cells only where the black ones are overwritten
// next.
template <int D, class Real>
inline void prolong(const Level<D, Real>& coarse, const Level<D, Real>& fine, const Pencil* begin, const Pencil* end) {
  for (int colour = 0; colour < (fine.layout.odd ? 2 : 1); ++colour)
    for (const Pencil* row = begin; row < end; ++row) {
      const Real* even = coarse.x.c[row->parent_parity] + row->parent;
      const Real* odd = coarse.x.c[1 - row->parent_parity] + row->parent;
      Real* x = fine.x.c[colour] + row->at;
      HOULE_INDEPENDENT
      for (index m = row->begin / 2; m < (row->end + 1) / 2; ++m) {
        x[2 * m] += even[m];
        x[2 * m + 1] += odd[m];
      }
    }
}

// One V-cycle for levels[i].x from levels[i].b, symmetric and positive definite. An even number of half sweeps. Black
// cells, relaxed last, have no residual, except at an odd periodic seam.
template <int D, class Real>
inline void cycle(const std::vector<OwnLevel<D, Real>>& levels, std::size_t i = 0) {
  const Layout<D>& layout = levels[i].layout;
  const Level<D, Real> level = levels[i].all();
  const Sweeps<D, Real> sweeps(level);
  const auto fetch = [&](int k) {  // copies to the ghost cells of periodic ends the colour that operation k reads
    if (k > 0) exchange(layout, level.x, 1 - k % 2);
  };
  if (i + 1 == levels.size()) {  // a single cell
    const Pencil *begin = layout.rows.data(), *end = begin + layout.rows.size();
    for (int colour = 0; colour < 2; ++colour) sweeps.relax_zero(begin, end, colour);
    return;
  }
  const Level<D, Real> coarse = levels[i + 1].all();
  const int half_sweeps = i == 0 ? 4 : 6;
  in_turn(layout, half_sweeps + 2, fetch, [=](int k, const Slices& part) {
    if (k == 0)
      sweeps.relax_zero(part.begin, part.end, 0);
    else if (k < half_sweeps)
      sweeps.relax(part.begin, part.end, k % 2);
    else if (k == half_sweeps)
      sweeps.residual(part.begin, part.end, 0);
    else
      restrict_residual(level, coarse, 0, part);
  });
  if (layout.odd) {
    exchange(layout, level.x, 0);
    in_turn(
        layout, 2, [](int) {},
        [=](int k, const Slices& part) {
          if (k == 0)
            sweeps.residual(part.begin, part.end, 1);
          else
            restrict_residual(level, coarse, 1, part);
        });
  }
  cycle(levels, i + 1);
  in_turn(layout, half_sweeps + 1, fetch, [=](int k, const Slices& part) {
    if (k == 0)
      prolong(coarse, level, part.begin, part.end);
    else
      sweeps.relax(part.begin, part.end, k % 2);
  });
}

}  // namespace houle::multigrid
