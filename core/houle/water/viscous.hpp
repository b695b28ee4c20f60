// Viscous acceleration on the faces of the grid, with an optional Smagorinsky eddy viscosity.
#pragma once

#include <houle/grid/grid.hpp>

namespace houle {

// Viscosity at cell centres with the eddies of Smagorinsky (1963), nu (cells) = molecular + (constant Delta)^2 |S|
// [m2/s]: strain rate |S| = sqrt(2 S_ab S_ab), Delta the size of a cell.
template <int D>
void eddy_viscosity(const Grid<D>& g, ConstFaces<D> u, double molecular, double constant, double* nu) {
  const double filter = constant * std::pow(g.cell_volume(), 1.0 / D);
  parallel_for(g.cells(), [=](index c) {
    const auto i = Grid<D>::unflat(c, g.shape);
    double sum = 0.0;
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) {
        double slope[2];  // du_a/dx_b and du_b/dx_a
        for (int q = 0; q < 2; ++q) {
          const int of = q ? b : a, along = q ? a : b;
          const auto stride = Grid<D>::strides(g.face_shape(of));
          auto lo = i, hi = i;
          double span = g.h[along];
          if (of == along) {
            hi[of] += 1;
            slope[q] = (u[of][Grid<D>::flat(hi, stride)] - u[of][Grid<D>::flat(lo, stride)]) / span;
            continue;
          }
          lo[along] =
              g.periodic[along] ? (i[along] - 1 + g.shape[along]) % g.shape[along] : std::max<index>(i[along] - 1, 0);
          hi[along] = g.periodic[along] ? (i[along] + 1) % g.shape[along] : std::min(i[along] + 1, g.shape[along] - 1);
          span *= g.periodic[along] ? 2.0 : static_cast<double>(hi[along] - lo[along]);
          if (span <= 0.0) {
            slope[q] = 0.0;
            continue;
          }
          const index up = stride[of];
          const index l = Grid<D>::flat(lo, stride), h = Grid<D>::flat(hi, stride);
          slope[q] = 0.5 * (u[of][h] + u[of][h + up] - u[of][l] - u[of][l + up]) / span;
        }
        const double s = 0.5 * (slope[0] + slope[1]);
        sum += 2.0 * s * s;
      }
    nu[c] = molecular + filter * filter * std::sqrt(sum);
  });
}

// Viscous acceleration on the faces, nu lap(u_d) / n (13), of second order, with zero gradient towards empty faces and
// along walls, whose friction acts on particles (friction.hpp): out [m/s2]. nu (cells, null: `molecular`), porosity
// (cells, null: 1), mass (faces) and the least mass of a face that holds water.
template <int D>
void viscous_acceleration(const Grid<D>& g, ConstFaces<D> u, ConstFaces<D> mass, double least, double molecular,
                          const double* nu, const Listed& porosity, Faces<D> out) {
  constexpr int up = D - 1;
  const index nz = g.shape[up];
  each_of<D>([&](auto axis) {
    constexpr int a = decltype(axis)::value;
    const auto shape = g.face_shape(a);
    const index line = shape[up];
    const double *v = u[a], *m = mass[a];
    double* o = out[a];
    std::array<double, D> inverse_h2;
    for (int b = 0; b < D; ++b) inverse_h2[b] = 1.0 / (g.h[b] * g.h[b]);
    parallel_for(
        g.faces(a) / line,
        [=](index r) {
          const index row = r * line;
          std::fill(o + row, o + row + line, 0.0);
          const auto i = Grid<D>::unflat(r, rows_of<D>(shape));
          if (a != up && !g.periodic[a] && (i[a] == 0 || i[a] == g.shape[a])) return;
          const auto beside = rows_beside<D>(g, i, shape);
          const auto stride = Grid<D>::strides(g.shape);
          auto cell = i;
          if (a != up) cell[a] = inside(i[a] - 1, g.shape[a], true);
          const index low = Grid<D>::flat(cell, stride);
          if (a != up) cell[a] = inside(i[a], g.shape[a], true);
          const index high = Grid<D>::flat(cell, stride);
          for (index k = 0; k < line; ++k) {
            const index f = row + k;
            if (m[f] <= least || (a == up && !g.periodic[up] && (k == 0 || k == nz))) continue;
            const index cl = a == up ? low + inside(k - 1, nz, true) : low + k, ch = a == up ? high + k % nz : high + k;
            const double n = porosity ? 0.5 * (porosity[cl] + porosity[ch]) : 1.0;
            const double nu_f = nu ? 0.5 * (nu[cl] + nu[ch]) : molecular;
            double laplacian = 0.0;
            each_of<D>([&](auto axis_b) {
              constexpr int b = decltype(axis_b)::value;
              index near[2];
              for (int s = 0; s < 2; ++s) {
                bool end;  // the neighbour is a face of the wall across a
                if constexpr (b == up) {
                  const index j = g.periodic[up] ? inside(k + (s ? 1 : -1), nz, true) : k + (s ? 1 : -1);
                  near[s] = j < 0 || j >= line ? -1 : row + j;
                  end = a == up && !g.periodic[up] && (j == 0 || j == nz);
                } else {
                  near[s] = beside[2 * b + s] < 0 ? -1 : beside[2 * b + s] + k;
                  end = a == b && !g.periodic[b] && (s ? i[b] + 1 == g.shape[b] : i[b] == 1);
                }
                if (near[s] >= 0 && (m[near[s]] > least || end)) laplacian += (v[near[s]] - v[f]) * inverse_h2[b];
              }
            });
            o[f] = nu_f * laplacian / n;
          }
        },
        16);
  });
}

}  // namespace houle
