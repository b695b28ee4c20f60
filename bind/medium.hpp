// The medium as Python gives it: materials, and their numbers on the faces.
#pragma once

#include <houle/water/forces.hpp>

#include "arguments.hpp"

namespace houle {

using Mask = Array<std::uint8_t>;
using GivenMask = Array<const std::uint8_t>;
using GivenMasks = Arrays<const std::uint8_t>;   // empty: null
using FaceNumbers = Arrays<const std::int32_t>;  // empty: null

// The materials (K, 3) that the faces are numbered by.
inline Points<2, const Material> materials_of(const Given& table) {
  static_assert(sizeof(Material) == 3 * sizeof(double));
  const auto materials = rows<Material>(table, "table");
  if (materials.n == 0) refuse("table has no rows");
  return materials;
}

// The row of each face in the table of materials. none: there may be no arrays.
template <int D>
inline ConstFaces<D, std::int32_t> numbers_of(const Grid<D>& g, const FaceNumbers& number, index materials, bool none) {
  const auto f = faces(g, number, "number", none);
  for (std::size_t a = 0; a < number.size; ++a)
    require_table(number[a].view("number"), "number", Table::numbers, materials);
  return f;
}

}  // namespace houle
