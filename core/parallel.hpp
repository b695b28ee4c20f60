// Parallel loops, on the threads of team.hpp; a GPU build replaces these bodies and nothing else.
//
// Loop bodies capture pointers and scalars by value, allocate nothing and throw nothing. Every result is bitwise the
// same for any number of threads: iterations are independent, and sums are formed over blocks of a fixed size, block
// by block in order.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "team.hpp"

#if defined(_MSC_VER)
#define HOULE_NOINLINE __declspec(noinline)
#else
#define HOULE_NOINLINE __attribute__((noinline))
#endif

// Before a loop whose iterations write nothing that others read.
#if defined(__clang__)
#define HOULE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define HOULE_INDEPENDENT _Pragma("GCC ivdep")
#elif defined(_MSC_VER)
#define HOULE_INDEPENDENT __pragma(loop(ivdep))
#else
#define HOULE_INDEPENDENT
#endif

namespace houle {

inline void set_threads(int threads) { Team::shared().resize(threads); }

inline int get_threads() { return Team::shared().size(); }

// Part of a loop. Not inlined: the same instructions run for any number of threads, where two
// compilations could contract multiply-adds differently. It works on a copy of the body that nothing else points to, so
// that the compiler keeps in registers what it captured.
template <class Body>
HOULE_NOINLINE inline void run_share(index begin, index end, const Body& shared) {
  const Body body(shared);
  for (index i = begin; i < end; ++i) body(i);
}

template <class Body>
inline Team::Loop loop_of(const Body& body, index chunk, int shares, int stages = 1) {
  return {[](const void* b, index begin, index end) { run_share(begin, end, *static_cast<const Body*>(b)); }, &body,
          chunk, shares, stages};
}

// The first of i = 0..n-1 that lies in a share or a later one. place(i) tells where in the work i lies, growing from 0
// to 1.
template <class Place>
inline index share_bound(index n, int shares, int share, Place place) {
  if (share == shares) return n;
  index low = 0, high = n;
  while (low < high) {
    const index middle = (low + high) / 2;
    if (place(middle) * shares < share)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

// Calls body(i) for i = 0..n-1, in any order. bound(s, shares): where share s begins. grain: fewer iterations than this
// per thread are not worth waking it.
template <class Bound, class Body>
inline void parallel_for_shares(index n, Bound bound, const Body& body, index grain) {
  constexpr index most = 16;  // chunks per share: what the other threads can take over
  Team& team = Team::shared();
  const int shares = static_cast<int>(std::min<index>(team.size(), n / grain));
  if (shares > 1) {
    const index chunk = std::max((n + most * shares - 1) / (most * shares), grain / 4);
    if (team.run(loop_of(body, chunk, shares), [=](int s) { return bound(s, shares); })) return;
  }
  run_share(0, n, body);
}

template <class Body>
inline void parallel_for(index n, const Body& body, index grain = 1024) {
  parallel_for_shares(n, [=](int s, int shares) { return n * s / shares; }, body, grain);
}

// Where share s of what lies along the first axis of the grid begins, n pieces in all: where the particles are cut.
inline index grid_bound(index n, int s, int shares) {
  const Team& team = Team::shared();
  if (s == 0 || s == shares) return s == 0 ? index{0} : n;
  const double share = static_cast<double>(s) / shares;
  int i = 1;
  while (i < Team::places && team.share_before(i) < share) ++i;
  const double low = team.share_before(i - 1), high = team.share_before(i);
  const double part = high > low ? std::clamp((share - low) / (high - low), 0.0, 1.0) : 0.0;
  return static_cast<index>(static_cast<double>(n) * (i - 1 + part) / Team::places);
}

// The same for what lies along the first axis of the grid: cells, faces, rows of them.
template <class Body>
inline void parallel_for_grid(index n, const Body& body, index grain = 1024) {
  parallel_for_shares(n, [n](int s, int shares) { return grid_bound(n, s, shares); }, body, grain);
}

// The same for iterations of unequal work.
template <class Place, class Body>
inline void parallel_for_placed(index n, Place place, const Body& body, index grain) {
  parallel_for_shares(n, [=](int s, int shares) { return share_bound(n, shares, s, place); }, body, grain);
}

// Calls body(i) for few and heavy i = 0..n-1 (slabs), colour by colour: an i begins when those beside it, around the
// end too, of the colours before its own are done. What is not beside it is not waited for.
template <class Colour, class Place, class Body>
inline void parallel_for_coloured(index n, int colours, Colour colour, Place place, const Body& body) {
  Team& team = Team::shared();
  const int shares = static_cast<int>(std::min<index>({team.size(), n, Team::most / colours}));
  Done all(n), *done = &all;
  const auto turn = [=](index k) {  // i in the pass of one colour
    const int now = static_cast<int>(k / n);
    const index i = k % n;
    if (colour(i) != now) return;
    for (const index beside : {(i + n - 1) % n, (i + 1) % n})
      if (colour(beside) < now) done->wait(beside);
    run_share(i, i + 1, body);
    done->set(i);
  };
  const auto bound = [=](int s) { return s / shares * n + share_bound(n, shares, s % shares, place); };
  if (shares < 2 || !team.run(loop_of(turn, 1, shares, colours), bound)) run_share(0, colours * n, turn);
}

// Operations 0 .. count - 1 on every slice: op(k, from, to), on the slices from .. to - 1, reads what operation k - 1
// has left in them and in those beside them; that k has been there as well must not matter. bound(s, shares): where the
// share s of the slices begins. work: of all operations together, in iterations of a small loop.
//
// A block of slices goes through all operations, one block per thread, without waiting for the others. With every
// operation it leaves out one slice more towards its neighbours: the wedge between two blocks is done when both are.
// Slices too few for that are gone through operation by operation.
template <class Bound, class Op>
inline void parallel_in_turn(index slices, int count, index work, Bound bound, const Op& op) {
  constexpr index enough = 2048, most = 64;  // work in a block; blocks
  const index narrowest = 2 * count, wanted = std::min<index>({get_threads(), most, work / enough});
  const index blocks = std::max<index>(1, std::min(wanted, slices / (2 * narrowest)));
  if (blocks < wanted && work > 64 * count * enough) {
    for (int k = 0; k < count; ++k) parallel_for_shares(slices, bound, [=](index i) { op(k, i, i + 1); }, 1);
    return;
  }
  if (blocks == 1) {
    for (int k = 0; k < count; ++k) op(k, 0, slices);
    return;
  }
  std::array<index, most + 1> start{};
  for (index b = 1; b < blocks; ++b)
    start[b] = std::clamp<index>(bound(static_cast<int>(b), static_cast<int>(blocks)), start[b - 1] + narrowest,
                                 slices - (blocks - b) * narrowest);
  start[blocks] = slices;
  const auto part = [=](index q) {  // even: block, odd: wedge; operation k on the slices from + k a .. to + k b - 1
    const bool wedge = q % 2 == 1;
    const index from = start[(q + 1) / 2], to = wedge ? from : start[q / 2 + 1];
    const index a = wedge ? -1 : from > 0, b = wedge ? 1 : -(to < slices);
    for (int k = 0; k < count; ++k) op(k, from + k * a, to + k * b);
  };
  const auto colour = [](index q) { return static_cast<int>(q % 2); };
  const auto place = [=](index q) { return static_cast<double>(q) / static_cast<double>(2 * blocks); };
  parallel_for_coloured(2 * blocks - 1, 2, colour, place, part);
}

// reduce over i of body(i) with `combine`, in blocks of fixed size: the same bits for any number of threads.
template <class Result, class Body, class Combine>
inline Result parallel_reduce(index n, Result start, Body body, Combine combine) {
  constexpr index block = 512;
  const index blocks = (n + block - 1) / block;
  if (blocks <= 1) {
    Result r = start;
    for (index i = 0; i < n; ++i) r = combine(r, body(i));
    return r;
  }
  std::vector<Result> part(static_cast<std::size_t>(blocks), start);
  Result* parts = part.data();
  parallel_for(
      blocks,
      [=](index b) {
        Result r = start;
        const index end = std::min(n, (b + 1) * block);
        for (index i = b * block; i < end; ++i) r = combine(r, body(i));
        parts[b] = r;
      },
      4);
  Result r = start;
  for (index b = 0; b < blocks; ++b) r = combine(r, parts[b]);
  return r;
}

// body(i) of few and heavy i = 0..n-1 along the grid, to be reduced in their order.
template <class Body>
inline std::vector<double> parallel_values(index n, Body body, index grain = 16) {
  std::vector<double> value(static_cast<std::size_t>(n));
  double* values = value.data();
  parallel_for_grid(n, [=](index i) { values[i] = body(i); }, grain);
  return value;
}

// The i = 0..n-1 for which test(i) holds, in order.
template <class Test>
inline std::vector<std::int32_t> parallel_where(index n, Test test) {
  constexpr index block = 2048;
  const index blocks = (n + block - 1) / block;
  std::vector<index> start(static_cast<std::size_t>(blocks) + 1, 0);
  index* starts = start.data();
  parallel_for(
      blocks,
      [=](index b) {
        index count = 0;
        for (index i = b * block; i < std::min(n, (b + 1) * block); ++i) count += test(i) ? 1 : 0;
        starts[b + 1] = count;
      },
      4);
  for (index b = 0; b < blocks; ++b) starts[b + 1] += starts[b];
  std::vector<std::int32_t> found(static_cast<std::size_t>(starts[blocks]));
  std::int32_t* to = found.data();
  parallel_for(
      blocks,
      [=](index b) {
        index k = starts[b];
        for (index i = b * block; i < std::min(n, (b + 1) * block); ++i)
          if (test(i)) to[k++] = static_cast<std::int32_t>(i);
      },
      4);
  return found;
}

// Stable counting sort of i = 0..n-1 by key[i] in 0..keys-1: order (n,) the i for each place, start (keys + 1,) the
// place of the first of each key. Each share of the keys counts and places what lies in it; the shares are equal if the
// keys are nearly sorted already.
inline void counting_sort(index n, index keys, const std::int32_t* key, std::int32_t* order, std::int32_t* start) {
  constexpr index most = 16, enough = 4096;  // shares; entries in one
  const index shares = std::clamp<index>(std::min<index>(get_threads(), n / enough), 1, most);
  std::array<index, most + 1> bound{};        // of the keys of each share
  std::array<std::int32_t, most + 1> held{};  // entries in the shares before it
  for (index s = 1; s < shares; ++s) bound[s] = std::max<index>(bound[s - 1], key[n * s / shares]);
  bound[shares] = keys;
  constexpr index block = 512;
  const index blocks = (n + block - 1) / block;
  std::vector<std::pair<std::int32_t, std::int32_t>> found(static_cast<std::size_t>(blocks), {0, keys});
  auto* range = found.data();  // least and largest key of each block
  if (shares > 1)
    parallel_for(
        blocks,
        [=](index b) {
          const auto ends = std::minmax_element(key + b * block, key + std::min(n, (b + 1) * block));
          range[b] = {*ends.first, *ends.second};
        },
        8);
  const auto meets = [=](index b, index first, index end) { return range[b].second >= first && range[b].first < end; };
  std::int32_t* in_share = held.data() + 1;
  parallel_for(
      shares,
      [=](index s) {
        const index first = bound[s], end = bound[s + 1];
        std::fill(start + first, start + end, 0);
        std::int32_t count = 0;
        for (index b = 0; b < blocks; ++b)
          for (index i = b * block; meets(b, first, end) && i < std::min(n, (b + 1) * block); ++i)
            if (key[i] >= first && key[i] < end) ++start[key[i]], ++count;
        in_share[s] = count;
      },
      1);
  for (index s = 0; s < shares; ++s) held[s + 1] += held[s];
  parallel_for(
      shares,
      [=](index s) {
        const index first = bound[s], end = bound[s + 1];
        std::int32_t next = held[s];
        for (index k = first; k < end; ++k) start[k] = next += start[k];  // end of the key, until it is filled
        for (index b = blocks - 1; b >= 0; --b)                           // from its end
          for (index i = std::min(n, (b + 1) * block) - 1; meets(b, first, end) && i >= b * block; --i)
            if (key[i] >= first && key[i] < end) order[--start[key[i]]] = static_cast<std::int32_t>(i);
      },
      1);
  start[keys] = static_cast<std::int32_t>(n);
}

template <class Body>
inline double parallel_sum(index n, Body body) {
  return parallel_reduce(n, 0.0, body, [](double a, double b) { return a + b; });
}

template <class Body>
inline double parallel_max(index n, Body body) {  // of non-negative values; NaN wins, so that it is seen
  return parallel_reduce(n, 0.0, body, [](double a, double b) { return (b > a || std::isnan(b)) ? b : a; });
}

}  // namespace houle
