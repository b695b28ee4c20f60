// Gates: plates across the tank, on faces of the first axis, open below their lower edges.
#pragma once

#include <algorithm>
#include <limits>

#include <houle/grid/grid.hpp>

namespace houle {

// A plate across the first axis, on a face, shut above its lower edge.
struct Gate {
  double x;       // [m]
  double bottom;  // height of its lower edge, on a grid line [m]
};

// All gates of a tank; none: count 0.
struct Gates {
  const Gate* gate = nullptr;
  int count = 0;
};

// The cells or nodes low .. high - 1 along the first axis, between two gates. One that lies behind a gate has a mirror
// image in front of it.
struct Compartment {
  index low = std::numeric_limits<index>::min() / 4, high = std::numeric_limits<index>::max() / 4;

  index image(index i) const { return i < low ? 2 * low - 1 - i : (i >= high ? 2 * high - 1 - i : i); }
};

// The compartment of a point at x [m] along the first axis: its cells between the gates on both sides. Only gates that
// reach down to row `top` part the water there. h: size of a cell [m]; count: cells of the tank along the first axis.
template <int D>
inline Compartment compartment_beside(const Gates& gates, const std::array<double, D>& h, index count, bool periodic,
                                      double x, index top) {
  Compartment between;
  for (int k = 0; k < gates.count; ++k) {
    const Gate& gate = gates.gate[k];
    if (top < floor_index(gate.bottom / h[D - 1] + 0.5)) continue;
    const index at = floor_index(gate.x / h[0] + 0.5);  // the first behind it
    const bool front = x < gate.x;
    if (!front || periodic) between.low = std::max(between.low, front ? at - count : at);
    if (front || periodic) between.high = std::min(between.high, front ? at : at + count);
  }
  return between;
}

// Stops a particle that went from `from` to x at gates that it would cross above their lower edges. Returns whether it
// would.
template <int D>
inline bool stop_at_gates(const Grid<D>& g, const Gates& gates, const double* from, double* x) {
  const double height = std::max(x[D - 1], 1e-9 * g.h[D - 1]);  // the floor stops it: it passes under no shut gate
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
