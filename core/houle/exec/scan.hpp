// Selections: the numbers for which a test holds, in order.
#pragma once

#include <cstdint>
#include <vector>

#include <houle/exec/loop.hpp>

namespace houle {

// Returns the i = 0..n-1 for which test(i) holds, in order.
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

}  // namespace houle
