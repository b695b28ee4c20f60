// Sums, maxima and other reductions, formed over blocks of a fixed size, block by block in order: the same bits for any
// number of threads.
#pragma once

#include <cmath>
#include <vector>

#include <houle/exec/loop.hpp>

namespace houle {

// Combines body(i) for i = 0..n-1, starting from `start`, in blocks of a fixed size whose results are combined in
// order. `combine(result, value)` must be associative but for round-off.
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

// Returns body(i) for few and heavy i = 0..n-1. The caller reduces them, in their order.
template <class Body>
inline std::vector<double> parallel_values(index n, Body body, index grain = 16) {
  std::vector<double> value(static_cast<std::size_t>(n));
  double* values = value.data();
  parallel_for(n, [=](index i) { values[i] = body(i); }, grain);
  return value;
}

// Returns the sum of body(i) over i = 0..n-1.
template <class Body>
inline double parallel_sum(index n, Body body) {
  return parallel_reduce(n, 0.0, body, [](double a, double b) { return a + b; });
}

// Returns the largest body(i), i = 0..n-1, of values that are not negative. NaN wins, so that it is seen.
template <class Body>
inline double parallel_max(index n, Body body) {
  return parallel_reduce(n, 0.0, body, [](double a, double b) { return (b > a || std::isnan(b)) ? b : a; });
}

}  // namespace houle
