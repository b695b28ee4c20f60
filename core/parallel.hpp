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
inline Team::Loop loop_of(const Body& body, index chunk, int shares) {
  return {[](const void* b, index begin, index end) { run_share(begin, end, *static_cast<const Body*>(b)); }, &body,
          chunk, shares};
}

// Calls body(i) for i = 0..n-1, in any order. grain: fewer iterations than this per thread are not worth waking it.
template <class Body>
inline void parallel_for(index n, const Body& body, index grain = 1024) {
  constexpr index chunks = 4;  // per share: what the other threads can take over
  Team& team = Team::shared();
  const index shares = std::min<index>(team.size(), n / grain);
  if (shares > 1) {
    const index chunk = (n + chunks * shares - 1) / (chunks * shares);
    if (team.run(loop_of(body, chunk, static_cast<int>(shares)), [=](index s) { return n * s / shares; })) return;
  }
  run_share(0, n, body);
}

// Calls body(i) for few and heavy i = 0..n-1 (slabs), colour by colour: no two of different colours at the same time.
// place(i), growing from 0 to 1, tells where in the work i lies; a thread begins with what lies in its share.
template <class Colour, class Place, class Body>
inline void parallel_for_coloured(index n, int colours, Colour colour, Place place, const Body& body) {
  Team& team = Team::shared();
  const int shares = static_cast<int>(std::min<index>(team.size(), n));
  const auto bound = [=](int s) {  // the first i that lies in share s or later
    index low = 0, high = s < shares ? n : 0;
    if (s == shares) return n;
    while (low < high) {
      const index middle = (low + high) / 2;
      (place(middle) * shares < s ? low : high) = middle + (place(middle) * shares < s);
    }
    return low;
  };
  for (int now = 0; now < colours; ++now) {
    const auto pass = [=](index i) {
      if (colour(i) == now) run_share(i, i + 1, body);
    };
    if (shares < 2 || !team.run(loop_of(pass, 1, shares), bound)) run_share(0, n, pass);
  }
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

template <class Body>
inline double parallel_sum(index n, Body body) {
  return parallel_reduce(n, 0.0, body, [](double a, double b) { return a + b; });
}

template <class Body>
inline double parallel_max(index n, Body body) {  // of non-negative values; NaN wins, so that it is seen
  return parallel_reduce(n, 0.0, body, [](double a, double b) { return (b > a || std::isnan(b)) ? b : a; });
}

}  // namespace houle
