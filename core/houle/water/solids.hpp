// The solids as particles meet them: their exact outline, edge by edge, so that no particle is left inside at a corner.
#pragma once

#include <limits>
#include <vector>

#include <houle/exec/reduce.hpp>
#include <houle/grid/gates.hpp>
#include <houle/water/transfer.hpp>

namespace houle {

// An edge of the section (x, z) of the solids, which lie on its left: its two ends [m], and at each end the outward
// direction (mean normal of the two edges that meet there). That tells inside from outside for points whose nearest
// point is a corner.
struct SolidEdge {
  double end[2][2], outward[2][2];
};

// The solids of a tank, as sections (x, z) of layers of y, inside which they do not change; one layer in 2D.
template <int D>
struct Solids {
  const std::int64_t* start = nullptr;   // (layers nx nz + 1): where in `number` the list of a cell of a section begins
  const std::int32_t* number = nullptr;  // the edges among which is the one nearest to any point of the cell
  const SolidEdge* edge = nullptr;       // null: no solids. The list of a cell is empty where no solid reaches into it
  const double* top = nullptr;           // (layers) largest y of each [m]
  int layers = 0;
};

// Brings a position x (D,) [m] into the tank: around periodic axes, and back between the walls.
template <int D>
inline void bring_into_tank(const Grid<D>& g, double* x) {
  for (int a = 0; a < D; ++a) {
    const double length = g.shape[a] * g.h[a];
    if (g.periodic[a]) {
      x[a] -= length * std::floor(x[a] / length);
      if (x[a] >= length) x[a] = 0.0;
    } else {
      const double margin = 1e-9 * g.h[a];
      x[a] = std::min(std::max(x[a], margin), length - margin);  // in this order NaN stays
    }
  }
}

// The way out of the solids from a point of a section: its depth in them [m], 0 outside, and the nearest point outside,
// `margin` beyond the edge.
struct WayOut {
  double depth = 0.0, to[2] = {};
};

// The way out of the solids from the point `at` (x, z) [m] of a section.
template <int D>
inline WayOut way_out(const Grid<D>& g, const Solids<D>& solids, int layer, const double (&at)[2], double margin) {
  constexpr int up = D - 1;
  const index i = std::clamp<index>(floor_index(at[0] / g.h[0]), 0, g.shape[0] - 1),
              k = std::clamp<index>(floor_index(at[1] / g.h[up]), 0, g.shape[up] - 1),
              list = (layer * g.shape[0] + i) * g.shape[up] + k;
  double nearest = std::numeric_limits<double>::infinity(), outward[2] = {};
  WayOut found;
  for (std::int64_t e = solids.start[list]; e < solids.start[list + 1]; ++e) {
    const SolidEdge& edge = solids.edge[solids.number[e]];
    const double along[2] = {edge.end[1][0] - edge.end[0][0], edge.end[1][1] - edge.end[0][1]},
                 from[2] = {at[0] - edge.end[0][0], at[1] - edge.end[0][1]},
                 length2 = along[0] * along[0] + along[1] * along[1],
                 share = (from[0] * along[0] + from[1] * along[1]) / length2, s = std::clamp(share, 0.0, 1.0);
    const double off[2] = {from[0] - s * along[0], from[1] - s * along[1]},
                 distance2 = off[0] * off[0] + off[1] * off[1];
    if (!(distance2 < nearest)) continue;
    nearest = distance2;
    const double length = std::sqrt(length2);
    for (int a = 0; a < 2; ++a)
      outward[a] = s <= 0.0   ? edge.outward[0][a]
                   : s >= 1.0 ? edge.outward[1][a]
                              : (a == 0 ? along[1] : -along[0]) / length;
    const bool inside = off[0] * outward[0] + off[1] * outward[1] < 0.0;
    found.depth = inside ? std::sqrt(distance2) : 0.0;
    for (int a = 0; a < 2; ++a) found.to[a] = at[a] - off[a] + margin * outward[a];
  }
  return found;
}

// The layer that holds a point.
template <int D>
inline int layer_of(const Solids<D>& solids, const double* x) {
  int layer = 0;
  if constexpr (D == 3)
    while (layer + 1 < solids.layers && x[1] >= solids.top[layer]) ++layer;
  return layer;
}

// True if a point in the tank lies in a solid.
template <int D>
inline bool in_solid(const Grid<D>& g, const Solids<D>& solids, const double* x) {
  if (!solids.edge) return false;
  const double at[2] = {x[0], x[D - 1]};
  return way_out(g, solids, layer_of(solids, x), at, 0.0).depth > 0.0;
}

// Takes a point in the tank that lies in a solid to the nearest place outside: in its section, or, in 3D, across the
// ends of the layers.
template <int D>
inline void leave_solids(const Grid<D>& g, const Solids<D>& solids, double* x) {
  constexpr int up = D - 1;
  constexpr double beyond = 1e-9;  // cells
  const double at[2] = {x[0], x[up]}, margin = beyond * g.h[0];
  const int layer = layer_of(solids, x);
  const WayOut out = way_out(g, solids, layer, at, margin);
  if (out.depth == 0.0) return;
  if constexpr (D == 3) {
    const double width = solids.top[solids.layers - 1];
    double least = out.depth, y = 0.0;
    for (int way = -1; way <= 1; way += 2) {
      double turned = 0.0;  // around a periodic axis
      int l = layer;
      for (int passed = 0; passed < solids.layers; ++passed) {
        const double end = turned + (way > 0 ? solids.top[l] : l > 0 ? solids.top[l - 1] : 0.0);
        if (std::abs(end - x[1]) >= least) break;
        l += way;
        if (l < 0 || l == solids.layers) {
          if (!g.periodic[1]) break;  // the wall: the solid goes on behind it
          turned += way * width;
          l = l < 0 ? solids.layers - 1 : 0;
        }
        if (way_out(g, solids, l, at, margin).depth > 0.0) continue;
        least = std::abs(end - x[1]);
        y = end + way * beyond * g.h[1];
        break;
      }
    }
    if (least < out.depth) {
      x[1] = y;
      return;
    }
  }
  x[0] = out.to[0];
  x[up] = out.to[1];
}

// Takes a particle at x that came from `from` to the nearest place outside the solids on its side of the gates: in the
// corner between a gate and a solid to and fro. If that leads nowhere, it stays where it was.
template <int D>
inline void leave_solids(const Grid<D>& g, const Solids<D>& solids, const Gates& gates, const double* from, double* x) {
  leave_solids(g, solids, x);
  for (int turn = 0; stop_at_gates(g, gates, from, x); ++turn) {
    if (turn == 4)
      std::copy(from, from + D, x);
    else
      leave_solids(g, solids, x);
  }
}

// Takes all particles that lie in a solid to the nearest place outside.
template <int D>
void all_leave_solids(const Grid<D>& g, index n, const Solids<D>& solids, double* x) {
  parallel_for(n, [=](index p) {
    leave_solids(g, solids, x + D * p);
    bring_into_tank(g, x + D * p);
  });
}

// A face in the solids near the water, from which particles in the water interpolate.
template <int D>
struct ClosedFace {
  double normal[D];   // outwards from the solid
  double outside[D];  // point in the water, one spacing from where that normal leaves the solid
  double depth;       // depth of the face's centre in the solid [spacings]
};

// The closed faces of each axis: their numbers in the field, and what stands there.
template <int D>
struct ClosedFaces {
  index count[D] = {};
  const std::int64_t* face[D] = {};
  const ClosedFace<D>* at[D] = {};
};

// Stops the velocity u on the closed faces at the outline of the solids, in place. Along the normal of a solid it is
// linear, from that in the water one spacing away to 0 on the outline, and goes on so behind it: else the velocity
// carried into the solid from the water would drive particles onto it. Along the outline the values of the closed faces
// stay.
template <int D>
void stop_at_solids(const Grid<D>& g, const ClosedFaces<D>& closed, Faces<D> u) {
  const auto stride = face_strides(g);
  const ConstFaces<D> now = u;
  const auto across = [=](const double* x, const double* normal) {
    Stencil<LinearKernel, D> st;
    st.set(g, x);
    double sum = 0.0;
    each_of<D>([&](auto b) { sum += normal[b] * st.template gather<b>(stride[b], now[b]); });
    return sum;
  };
  std::array<std::vector<double>, D> stopped;
  for (int a = 0; a < D; ++a) {
    const std::int64_t* face = closed.face[a];
    const ClosedFace<D>* at = closed.at[a];
    const auto shape = g.face_shape(a);
    stopped[a] = parallel_values(
        closed.count[a],
        [=](index k) {
          const auto i = Grid<D>::unflat(face[k], shape);
          double x[D];
          for (int b = 0; b < D; ++b) x[b] = (static_cast<double>(i[b]) + (b == a ? 0.0 : 0.5)) * g.h[b];
          const ClosedFace<D>& f = at[k];
          return now[a][face[k]] - f.normal[a] * (across(x, f.normal) + f.depth * across(f.outside, f.normal));
        },
        256);
  }
  for (int a = 0; a < D; ++a) {
    const std::int64_t* face = closed.face[a];
    const double* value = stopped[a].data();
    double* ua = u[a];
    parallel_for(closed.count[a], [=](index k) { ua[face[k]] = value[k]; });
  }
  close_periodic(g, u);
}

}  // namespace houle
