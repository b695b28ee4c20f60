// The outline of the solids as Python passes it.
#pragma once

#include <optional>
#include <tuple>

#include <houle/water/solids.hpp>

#include "arguments.hpp"

namespace houle {

// start, number, edges (E, 8), tops of the layers: houle.medium.solids.Outline
using Outline = std::optional<std::tuple<LongNumbers, Numbers, Given, Given>>;

template <int D>
inline Solids<D> solids_of(const Grid<D>& g, const Outline& outline) {
  static_assert(sizeof(SolidEdge) == 8 * sizeof(double));
  if (!outline) return {};
  const auto& [start, number, edge, top] = *outline;
  const auto tops = top.view("solids: top");
  if (tops.size < 1) refuse("solids: top has no layers");
  const auto edges = rows<SolidEdge>(edge, "solids: edge");
  const auto starts = start.view("solids: start");
  const index lists = tops.size * g.shape[0] * g.shape[D - 1];
  if (starts.size != lists + 1) wrong_size(starts, "solids: start", std::to_string(lists + 1));
  const auto all = number.view("solids: number");
  require_table(starts, "solids: start", Table::starts, all.size);
  require_table(all, "solids: number", Table::numbers, edges.n);
  return {starts.data, all.data, edges.data, tops.data, static_cast<int>(tops.size)};
}

}  // namespace houle
