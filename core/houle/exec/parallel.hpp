// Parallel loops, reductions and sorts: the only code of the core that shares work among the threads of threads.hpp.
//
// Loop bodies capture pointers and scalars by value, allocate nothing and throw nothing. Every result is bitwise the
// same for any number of threads: iterations are independent, and sums are formed over blocks of a fixed size, block
// by block in order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <houle/exec/threads.hpp>

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

// Part of a loop. Not inlined: the same instructions run for any number of threads, where two
// compilations could contract multiply-adds differently. It works on a copy of the body that nothing else points to, so
// that the compiler keeps in registers what it captured.
template <class Body>
HOULE_NOINLINE inline void run_share(index begin, index end, const Body& shared) {
  const Body body(shared);
  for (index i = begin; i < end; ++i) body(i);
}

// Calls body(i) for i = 0..n-1, in any order. grain: fewer iterations than this are not worth waking a thread.
template <class Body>
inline void parallel_for(index n, const Body& body, index grain = 1024) {
  constexpr index parts = 16;  // for each thread: what others can take over
  const index threads = std::min<index>(get_threads(), n / grain);
  if (threads < 2) return run_share(0, n, body);
  const index part = std::max<index>({n / (parts * threads), grain / 4, 1});
  share(n, part,
        {[](const void* b, index begin, index end) { run_share(begin, end, *static_cast<const Body*>(b)); }, &body});
}

// Calls body(i) for few and heavy i = 0..n-1 (slabs), one colour after the other.
template <class Colour, class Body>
inline void parallel_for_coloured(index n, int colours, Colour colour, const Body& body) {
  for (int now = 0; now < colours; ++now)
    parallel_for(
        n,
        [=](index i) {
          if (colour(i) == now) body(i);
        },
        1);
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
    for (int k = 0; k < count; ++k) parallel_for(slices, [=](index i) { op(k, i, i + 1); }, 1);
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
  parallel_for_coloured(2 * blocks - 1, 2, colour, part);
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
  parallel_for(n, [=](index i) { values[i] = body(i); }, grain);
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
