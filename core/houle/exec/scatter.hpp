// Loops whose iterations write to places that others write to as well: neighbours never run at the same time.
#pragma once

#include <houle/exec/loop.hpp>

namespace houle {

// Calls body(i) for few and heavy i = 0..n-1 (slabs), one colour after the other. colour(i), in 0 .. colours - 1, must
// differ for two i that write to the same place.
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

}  // namespace houle
