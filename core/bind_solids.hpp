// The outline of the solids as Python passes it.
#pragma once

#include <optional>
#include <tuple>

#include "bind.hpp"
#include "solids.hpp"

namespace houle {

// start, number, edges (E, 8), tops of the layers: houle.solids.Outline
using Outline = std::optional<std::tuple<Array<std::int64_t>, Array<std::int32_t>, Field, Field>>;

template <int D>
inline Solids<D> solids_of(const Grid<D>& g, const Outline& outline) {
  static_assert(sizeof(SolidEdge) == 8 * sizeof(double));
  if (!outline) return {};
  const auto& [start, number, edge, top] = *outline;
  const index lists = static_cast<index>(top.size()) * g.shape[0] * g.shape[D - 1];
  require_size(start.size(), lists + 1, "start");
  require_size(number.size(), start.data()[lists], "number");
  if (edge.ndim() != 2 || edge.shape(1) != 8) throw std::invalid_argument("the edges must have shape (E, 8)");
  return {start.data(), number.data(), reinterpret_cast<const SolidEdge*>(edge.data()), top.data(),
          static_cast<int>(top.size())};
}

}  // namespace houle
