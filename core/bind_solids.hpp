// The outline of the solids, and the gates, as Python passes them.
#pragma once

#include <optional>
#include <tuple>

#include "bind.hpp"
#include "solids.hpp"

namespace houle {

// start, number, edges (E, 8), tops of the layers: houle.solids.Outline
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

// x and lower edge of each, in the tank.
template <int D>
inline Gates gates_of(const Grid<D>& g, const Given& table) {
  static_assert(sizeof(Gate) == 2 * sizeof(double));
  const auto all = rows<Gate>(table, "gates");
  for (index k = 0; k < all.n; ++k)
    if (!(all.data[k].x >= 0.0 && all.data[k].x <= g.h[0] * static_cast<double>(g.shape[0]) && all.data[k].bottom >= 0))
      refuse("gates: one stands outside the tank, or its lower edge is below the floor");
  return {all.data, static_cast<int>(all.n)};
}

template <int D>
inline Gates gates_of(const Grid<D>& g, const OptionalGiven& table) {
  return table ? gates_of(g, *table) : Gates{};
}

}  // namespace houle
