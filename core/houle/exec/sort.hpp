// Sorting by small whole numbers, such as the cell of each particle.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <houle/exec/loop.hpp>

namespace houle {

// Stable counting sort of i = 0..n-1 by key[i] in 0..keys-1. On return order (n,) has the i in the sorted order, start
// (keys + 1,) the place of the first of each key. The keys are cut into ranges (shares), and each share counts and
// places the entries whose key lies in it. The shares have equal work if the keys are nearly sorted already.
inline void counting_sort(index n, index keys, const std::int32_t* key, std::int32_t* order, std::int32_t* start) {
  constexpr index most = 16, enough = 4096;  // shares at most; entries at least in each
  const index shares = std::clamp<index>(std::min<index>(get_threads(), n / enough), 1, most);
  std::array<index, most + 1> bound{};         // first key of each share, then the end
  std::vector<std::int32_t> before(most + 1);  // [s]: entries in the shares before s; a vector, as loops write to it
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
  std::int32_t* in_share = before.data() + 1;
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
  for (index s = 0; s < shares; ++s) before[s + 1] += before[s];
  parallel_for(
      shares,
      [=](index s) {
        const index first = bound[s], end = bound[s + 1];
        std::int32_t next = in_share[s - 1];
        for (index k = first; k < end; ++k) start[k] = next += start[k];  // end of the key, until it is filled
        for (index b = blocks - 1; b >= 0; --b)                           // from its end
          for (index i = std::min(n, (b + 1) * block) - 1; meets(b, first, end) && i >= b * block; --i)
            if (key[i] >= first && key[i] < end) order[--start[key[i]]] = static_cast<std::int32_t>(i);
      },
      1);
  start[keys] = static_cast<std::int32_t>(n);
}

}  // namespace houle
