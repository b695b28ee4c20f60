// Gates: plates across the tank, on faces of the first axis, open below their lower edges.
#pragma once

#include <algorithm>

#include "grid.hpp"

namespace houle {

struct Gate {
  double x;
  double bottom;  // height of its lower edge, on a grid line [m]
};

struct Gates {
  const Gate* gate = nullptr;
  int count = 0;
};

// Stops a particle that went from `from` to x at gates that it would cross above their lower edges. Returns whether it
// would.
template <int D>
inline bool stop_at_gates(const Grid<D>& g, const Gates& gates, const double* from, double* x) {
  const double height = std::max(x[D - 1], 1e-9 * g.h[D - 1]);  // where the floor will stop it: not under a shut gate
  bool stopped = false;
  for (int k = 0; k < gates.count; ++k) {
    const Gate& gate = gates.gate[k];
    const bool left = from[0] < gate.x;
    if (left == (x[0] < gate.x) || !(height > gate.bottom)) continue;
    x[0] = gate.x + (left ? -1e-9 : 1e-9) * g.h[0];
    stopped = true;
  }
  return stopped;
}

}  // namespace houle
