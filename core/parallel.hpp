// Parallel loops. The only file that names OpenMP; a GPU build replaces these bodies and nothing else.
//
// Loop bodies capture pointers and scalars by value, allocate nothing and throw nothing. Every result is bitwise the
// same for any number of threads: iterations are independent, and sums are formed over blocks of a fixed size, block
// by block in order.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

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

using index = std::ptrdiff_t;

inline void set_threads([[maybe_unused]] int threads) {
#ifdef _OPENMP
  omp_set_num_threads(threads);
#endif
}

inline int get_threads() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

// The share [begin, end) of one thread. Not inlined: the same instructions run for any number of threads, where two
// compilations could contract multiply-adds differently. It works on a copy of the body that nothing else points to, so
// that the compiler keeps in registers what it captured.
template <class Body>
HOULE_NOINLINE inline void run_share(index begin, index end, const Body& shared) {
  const Body body(shared);
  for (index i = begin; i < end; ++i) body(i);
}

// Calls body(i) for i = 0..n-1, in any order. grain: fewer iterations than this per thread are not worth waking it.
// A thread always has the same share, which stays in its cache.
template <class Body>
inline void parallel_for(index n, const Body& body, [[maybe_unused]] index grain = 1024) {
#ifdef _OPENMP
  if (n >= 2 * grain && get_threads() > 1) {
#pragma omp parallel
    {
      const index thread = omp_get_thread_num(), threads = omp_get_num_threads();
      run_share(n * thread / threads, n * (thread + 1) / threads, body);
    }
    return;
  }
#endif
  run_share(0, n, body);
}

// Calls body(i) for few and heavy i = 0..n-1 (slabs), colour by colour: no two of different colours at the same time.
// place(i), growing from 0 to 1, tells where in the work i lies; a thread takes what lies in its share, always the
// same.
template <class Colour, class Place, class Body>
inline void parallel_for_coloured(index n, int colours, Colour colour, Place place, const Body& body) {
  const auto pass = [&](int now, index thread, index threads) {
    for (index i = 0; i < n; ++i)
      if (colour(i) == now &&
          std::min(static_cast<index>(place(i) * static_cast<double>(threads)), threads - 1) == thread)
        run_share(i, i + 1, body);
  };
#ifdef _OPENMP
  if (n > 1 && get_threads() > 1) {
#pragma omp parallel
    for (int now = 0; now < colours; ++now) {
      pass(now, omp_get_thread_num(), omp_get_num_threads());
#pragma omp barrier
    }
    return;
  }
#endif
  for (int now = 0; now < colours; ++now) pass(now, 0, 1);
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
