// Operations that follow one another over the same slices, each of which reads what the one before left beside it.
#pragma once

#include <array>

#include <houle/exec/scatter.hpp>

namespace houle {

// Runs operations 0 .. count - 1, one after the other, on all slices (planes of cells across the first axis). op(k,
// from, to) does operation k on the slices from .. to - 1. It reads what operation k - 1 has left in them and in those
// beside them, and must find the same there if operation k has been there as well. bound(s, shares): first slice of
// share s of the work. work: of all operations together, in iterations of a small loop.
//
// A block of slices goes through all operations, one block per thread, without waiting for the others. With each
// operation it does one slice fewer at either end, where the neighbouring block may not be so far. The slices left out
// form a wedge between the two blocks, which is done when both are. If there are too few slices for that, all of them
// go through one operation before the next.
template <class Bound, class Op>
inline void parallel_in_turn(index slices, int count, index work, Bound bound, const Op& op) {
  constexpr index enough = 2048, most = 64;  // least work in a block; most blocks
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

}  // namespace houle
