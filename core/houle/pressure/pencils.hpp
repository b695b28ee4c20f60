// Fields of the pressure solver: cells stored by pencil and colour, and sweeps over those of one colour.
//
// A pencil is a column of cells along the last axis. Its cell j = 2 m + s is entry m of one of two arrays, one per
// colour of the checkerboard: all neighbours of a cell are then contiguous in the other array, and half sweeps
// vectorise. Only pencils with active cells are visited, and of each only the range of entries that holds its active
// cells.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include <houle/exec/turn.hpp>
#include <houle/grid/grid.hpp>

namespace houle::multigrid {

// Ranges are whole multiples of this many entries: no loop needs a remainder.
constexpr int width = 8;

// A pencil: the place of its cells in memory, and the range of the active ones.
struct Pencil {
  index at;                 // entry m = 0 in every array of the level
  index child;              // entry m = 0 of its first pencil on the finer level
  index parent;             // entry m = 0 of the pencil on the coarser level that it is part of
  std::int32_t begin, end;  // its active cells are among the entries [begin, end) ...
  std::int32_t lo, hi;      // ... and these are inside [lo, hi), whole vectors
  std::int32_t parity;      // cell j = 2 m + s is of colour (parity + s) % 2
  std::int32_t parent_parity;
};

// A pencil at one end of a periodic axis and the ghost pencil beyond the other end.
struct Seam {
  index from, to;     // first entries
  std::int32_t swap;  // an odd number of cells: equal colours meet
  std::int32_t axis;
};

// A field, as pointers to its numbers, one per cell, split by colour: entry m of a pencil is c[colour][pencil.at + m].
template <class Real>
struct Field {
  std::array<Real*, 2> c{};
};

// A field and its memory.
template <class Real>
struct OwnField : Field<Real> {
  std::vector<Real> store;

  // Takes memory and sets it to zero. Colours and fields are staggered so that streams do not share cache sets. only:
  // the one colour that is wanted; the other, null, has no memory.
  void allocate(index size, int only = -1) {
    static int stagger = 0;
    const index line = 64 / sizeof(Real);
    store.assign(static_cast<std::size_t>((only < 0 ? 2 : 1) * size + 132 * line), Real(0));
    auto address = reinterpret_cast<std::uintptr_t>(store.data());
    Real* base = store.data() + (64 - address % 64) % 64 / sizeof(Real) + line;
    auto& c = this->c;
    c = {};
    for (int i = 0; i < 2; ++i) {
      if (only >= 0 && i != only) continue;
      c[i] = base + line * (stagger = (stagger + 5) % 64);
      base += size;
    }
    if (only < 0 && c[1] < c[0] + size) c[1] += 64 * line;
  }
};

// The pencils of a level as loops know them: numbers, and pointers to the tables of a Layout.
template <int D>
struct Pencils {
  std::array<index, D> n{};
  std::array<bool, D> wrap{};
  index half = 0;                     // entries per pencil and colour
  index shift = 0;                    // entries before m = 0: the ghost of a periodic last axis
  std::array<index, D> step{};        // entries between neighbouring pencils along each axis but the last
  index size = 0;                     // entries per colour, ghost pencils included
  index pencils = 0;                  // pencils inside the grid
  std::int32_t *first, *last;         // active cells of every pencil inside: j in [first, last)
  std::int32_t *old_begin, *old_end;  // active entries at the last setup
  const Pencil* row;                  // the pencils with active cells
  const index* slices;                // first row of each slice across the first axis, and the end
  index grain = 1;
  bool odd = false;  // an odd periodic axis: there cells of one colour meet, and relaxing one leaves residuals in it

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
      if (!f.c[c]) continue;
      Real* row = f.c[c] + now.at;
      for (index m = old_begin[p]; m < std::min(now.begin, old_end[p]); ++m) row[m] = 0;
      for (index m = std::max(now.end, old_begin[p]); m < old_end[p]; ++m) row[m] = 0;
    }
  }
  bool shrinks(const Pencil& now, index p) const {
    return old_begin[p] < old_end[p] && (old_begin[p] < now.begin || old_end[p] > now.end);
  }
};

// The pencils of a level and the memory of their tables.
template <int D>
struct Layout : Pencils<D> {
  using Base = Pencils<D>;
  using Base::n, Base::wrap, Base::half, Base::shift, Base::step, Base::size, Base::pencils, Base::first, Base::last,
      Base::old_begin, Base::old_end, Base::row, Base::slices, Base::grain, Base::odd, Base::place, Base::offset,
      Base::pencil;
  std::vector<std::int32_t> ranges;  // first, last, old_begin, old_end of every pencil
  std::vector<Pencil> rows;          // target of `row`, never moved to other memory
  std::vector<index> slice;          // target of `slices`
  std::vector<index> load;           // entries in the slices before each, and in all
  std::vector<Seam> seams;

  Layout(const std::array<index, D>& shape, const std::array<bool, D>& periodic) {
    n = shape;
    wrap = periodic;
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
    ranges.assign(4 * pencils, 0);
    std::int32_t** const range[] = {&first, &last, &old_begin, &old_end};
    for (int k = 0; k < 4; ++k) *range[k] = ranges.data() + k * pencils;
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
    slice.assign(n[0] + 1, 0);
    load.assign(n[0] + 1, 0);
    row = rows.data();
    slices = slice.data();
  }

  Layout(Layout&&) = default;  // a copy would point to the tables of another

  bool wrapped() const { return shift > 0 || !seams.empty(); }

  // Lists the non-empty pencils, once first and last are known. finer, coarser: the levels beside, null if none.
  void list(const Layout* finer, const Layout* coarser) {
    rows.clear();
    for (index p = 0; p < pencils; ++p) {
      const auto i = place(p);
      slice[i[0] + 1] = static_cast<index>(rows.size());
      if (p % (pencils / n[0]) == 0) load[i[0] + 1] = load[i[0]];
      if (first[p] < last[p]) {
        Pencil r = pencil(p);
        auto fine = i, coarse = i;
        for (int a = 0; a < D - 1; ++a) {
          fine[a] *= 2;
          coarse[a] /= 2;
          r.parent_parity ^= static_cast<std::int32_t>(coarse[a] & 1);
        }
        if (finer) r.child = finer->offset(fine);
        if (coarser) r.parent = coarser->offset(coarse);
        rows.push_back(r);
        load[i[0] + 1] += r.hi - r.lo;
      }
      slice[i[0] + 1] = static_cast<index>(rows.size());
    }
  }
};

// The active cells, with a layer of ghosts around: empty at walls, wrapped on periodic axes.
template <int D>
struct Mask {
  std::array<index, D> step{};  // to the neighbour along each axis
  std::uint8_t* flags = nullptr;

  std::uint8_t* pencil(const std::array<index, D>& i) const {  // cell 0 of the pencil at i
    index at = 1;
    for (int a = 0; a < D - 1; ++a) at += (i[a] + 1) * step[a];
    return flags + at;
  }
};

// A mask and its memory.
template <int D>
class OwnMask : public Mask<D> {
 public:
  explicit OwnMask(const std::array<index, D>& shape) {
    const index row = shape[D - 1] + 2;
    index rows = 1;
    for (int a = D - 2; a >= 0; --a) {
      this->step[a] = rows * row;
      rows *= shape[a] + 2;
    }
    this->step[D - 1] = 1;
    store_.assign(static_cast<std::size_t>(rows * row), 0);
    this->flags = store_.data();
  }
  OwnMask(OwnMask&&) = default;

 private:
  std::vector<std::uint8_t> store_;
};

// Copies active (cells, 0 or 1) into the mask and finds the active range of every pencil.
template <int D>
inline void copy_active(const Pencils<D>& l, const Mask<D>& mask, const std::uint8_t* active) {
  const index n = l.n[D - 1];
  parallel_for(
      l.pencils,
      [=](index p) {
        const auto i = l.place(p);
        const std::uint8_t* from = active + p * n;
        std::uint8_t* to = mask.pencil(i);
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
          if (i[a] == 0) std::memcpy(to + l.n[a] * mask.step[a], to, n);
          if (i[a] == l.n[a] - 1) std::memcpy(to - l.n[a] * mask.step[a], to, n);
        }
      },
      l.grain);
}

// Calls body(pencil) for every pencil with active cells. weight: work on one entry, that of a sweep being 1.
template <int D, class Body>
inline void for_rows(const Layout<D>& l, Body body, index weight = 1) {
  const Pencil* rows = l.row;
  parallel_for(
      static_cast<index>(l.rows.size()), [=](index i) { body(rows[i]); }, std::max<index>(1, l.grain / weight));
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

// Calls body(s, i, n), as with_entries does, for the cells of one colour in all pencils.
template <int D, class Body>
inline void sweep(const Layout<D>& l, int colour, Body body) {
  for_rows(l, [=](const Pencil& row) { with_entries(row, colour, body); });
}

// Neighbouring slices across the first axis, from .. to - 1.
struct Slices {
  index from, to;
  const Pencil *begin, *end;  // the pencils in them
};

// Runs operations 0 .. count - 1, one after the other, on all pencils: op(k, slices) reads what operation k - 1 has
// left in these slices and in those beside them. before(k) is called before operation k where pencils meet across a
// periodic end.
template <int D, class Before, class Op>
inline void in_turn(const Layout<D>& l, int count, Before before, Op op) {
  const Pencil* rows = l.row;
  const index* slice = l.slices;
  const auto run = [=](int k, index from, index to) { op(k, Slices{from, to, rows + slice[from], rows + slice[to]}); };
  const index slices = l.n[0], entries = l.load[slices];
  const auto bound = [&](int s, int shares) {  // equal work
    return std::lower_bound(l.load.begin(), l.load.end(), entries * s / shares) - l.load.begin();
  };
  if (!l.wrapped()) return parallel_in_turn(slices, count, count * entries, bound, run);
  const index grain = std::max<index>(1, l.grain * slices / l.pencils);
  for (int k = 0; k < count; ++k) {
    before(k);
    parallel_for(slices, [=](index i) { run(k, i, i + 1); }, grain);
  }
}

// Fills the ghost entries of one colour from the other ends of the periodic axes (of one axis, or of all).
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

// The coupling of the cells of one colour to their neighbours: star(s, i) = sum of k_f p_nb over the faces of entry i.
template <int D, class Real>
struct Star {
  std::array<const Real*, D> own, other;  // coefficients of the lower faces of this and of the other colour
  const Real* x;                          // the other colour
  std::array<index, D> step;

  template <class Coefficients>
  Star(const Pencils<D>& l, const Coefficients& k, const Field<Real>& f, int colour)
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

}  // namespace houle::multigrid
