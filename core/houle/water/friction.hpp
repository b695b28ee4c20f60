// Friction of the water along walls and solids of any outline, smooth or rough, by the law of the wall.
#pragma once

#include <houle/exec/reduce.hpp>
#include <houle/grid/grid.hpp>

namespace houle {

// Shear stress over density [m2/s2] of a wall on water that runs along it with speed v at distance y. In the viscous
// sublayer it is nu v / y. Above it, it follows from the law of the wall, v / v_* = ln(9.8 s / (1 + 0.327 s k_s/y)) /
// 0.41 with s = y v_*/nu: that of smooth walls for k_s = 0 (Nikuradse 1932; as in Launder & Spalding 1974, Comput.
// Methods Appl. Mech. Eng. 3, 269), ln(30 y/k_s) on rough ones (Nikuradse 1933), between them as Colebrook (1939, J.
// Inst. Civ. Eng. 11, 133) found for pipes. roughness: k_s [m]; y counts as half of it at least.
inline double wall_shear(double v, double y, double nu, double roughness = 0.0) {
  constexpr double karman = 0.41, smooth = 9.8, rough = 30.0;
  constexpr double sublayer = 11.53;  // y v_*/nu where both laws of a smooth wall meet
  constexpr double least = 36.0;      // v y/nu below which the sublayer has the larger shear on any wall
  y = std::max(y, 0.5 * roughness);
  if (nu <= 0.0) {
    const double friction = roughness > 0.0 ? karman / std::log(rough * y / roughness) : 0.0;
    return v * std::abs(v) * friction * friction;
  }
  const double re = std::abs(v) * y / nu;
  if (!(re > (roughness > 0.0 ? least : sublayer * sublayer))) return nu * v / y;
  const double c = smooth / rough * roughness / y;
  double s = sublayer;  // root of s ln(9.8 s / (1 + c s)) = karman re, convex, by Newton's method
  for (int k = 0; k < 8; ++k) {
    const double covered = c * s, l = std::log(smooth * s / (1.0 + covered));
    s = (karman * re + s / (1.0 + covered)) / (l + 1.0 / (1.0 + covered));
  }
  if (!(s * s > re)) return nu * v / y;
  return v * std::abs(v) * (s / re) * (s / re);
}

// The least thickness [cells] of a sheet of water that runs along a wall: thinner ones count as this.
constexpr double thinnest_sheet = 0.25;

// A plane that stands for the wall near a cell: the water is where normal . x is above the offset.
template <int D>
struct WallPlane {
  double normal[D];
  double offset;     // normal . x on it [m]
  double roughness;  // k_s [m]
};

// The cells near walls that rub, and the planes that stand for these walls (houle.medium.rough_walls.RoughWalls).
template <int D>
struct RoughWalls {
  index count = 0;
  const std::int64_t* cell = nullptr;   // (count,)
  const std::int64_t* first = nullptr;  // (count + 1,) first plane of each cell
  const std::int64_t* front = nullptr;  // planes: the cell whose fill tells how thick the water on the plane is
  const WallPlane<D>* plane = nullptr;
};

// The particles of a flow, sorted by cell.
template <int D>
struct Rubbed {
  const std::int32_t* start;  // first particle of each cell
  const double *x, *volume;   // position; water
  const double* bulk;         // V/n
  const float* inertia;       // C_r/n (n, D); null: 1
  const double* fill;         // cells
};

// The share of the shear that particles at distance d from a wall take [1 over the mean share]. The water of the first
// layer of cells takes it, as when the faces half a cell from the wall are slowed down: the share is that of the linear
// kernel, folded at the wall, and its integral over d is one cell.
inline double wall_share(double d, double h) { return std::clamp(1.5 - d / h, 0.0, 1.0); }

// Slows particles near walls down over dt by the shear of the wall, in place: their velocity u along the wall falls by
// the factor 1 / (1 + r dt), r = tau / (v s) times wall_share(), in a layer as thick as a cell or the thinner sheet s
// that there is. So no velocity turns around, and the water only loses energy. tau is the shear at the distance of the
// particle, but no nearer than s/2: there the velocity of faces, which particles have, changes no more. So it is exact
// in a profile that follows the law, be it linear or logarithmic.
// Particles in pores are left alone: there the grains rub. impulse (planes, D): what the walls got over density [m^d
// m/s]. Returns the energy taken over density.
template <int D>
double rub(const Grid<D>& g, const RoughWalls<D>& walls, const Rubbed<D>& water, double nu, double dt, double* u,
           double* impulse) {
  constexpr double behind = 0.25, clear = 0.999;
  const auto taken = parallel_values(walls.count, [=](index row) {
    double sum = 0.0;
    const index c = walls.cell[row];
    for (index k = walls.first[row]; k < walls.first[row + 1]; ++k) {
      const WallPlane<D>& wall = walls.plane[k];
      double h = 0.0;
      for (int a = 0; a < D; ++a) h += wall.normal[a] * wall.normal[a] * g.h[a];
      const double sheet = h * std::clamp(water.fill[walls.front[k]], thinnest_sheet, 1.0);
      double push[D] = {};
      for (index p = water.start[c]; p < water.start[c + 1]; ++p) {
        const double *x = water.x + D * p, bulk = water.bulk[p];
        double *up = u + D * p, d = -wall.offset, across = 0.0, along[D], v2 = 0.0;
        for (int a = 0; a < D; ++a) {
          d += wall.normal[a] * x[a];
          across += wall.normal[a] * up[a];
        }
        const double share = wall_share(std::max(d, 0.0), h);
        if (share <= 0.0 || d < -behind * h || water.volume[p] < clear * bulk) continue;
        for (int a = 0; a < D; ++a) {
          along[a] = up[a] - across * wall.normal[a];
          v2 += along[a] * along[a];
        }
        const double v = std::sqrt(v2);
        if (!(v > 0.0)) continue;
        const double rate = share * wall_shear(v, std::max(d, 0.5 * sheet), nu, wall.roughness) / (v * sheet),
                     lost = rate * dt / (1.0 + rate * dt);
        for (int a = 0; a < D; ++a) {
          const double change = lost * along[a], mass = bulk * (water.inertia ? water.inertia[D * p + a] : 1.0);
          sum += mass * change * (up[a] - 0.5 * change);
          push[a] += mass * change;
          up[a] -= change;
        }
      }
      for (int a = 0; a < D; ++a) impulse[D * k + a] = push[a];
    }
    return sum;
  });
  return parallel_sum(walls.count, [each = taken.data()](index row) { return each[row]; });
}

}  // namespace houle
