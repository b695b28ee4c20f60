// Functions that the library houle_core holds in compiled form, for grids of 2 and 3 dimensions. Who includes this
// header calls them there, and compiles only what is not in these lists. Each list is compiled by one of the source
// files beside this header. What is listed must not be `inline`, nor defined in its class: else each caller compiles it
// again.
//
// The other headers do without it: then the caller compiles the templates that it uses.
#pragma once

#include <houle/pressure/poisson.hpp>
#include <houle/pressure/projection.hpp>
#include <houle/water/advect.hpp>
#include <houle/water/columns.hpp>
#include <houle/water/crossing.hpp>
#include <houle/water/energy.hpp>
#include <houle/water/forces.hpp>
#include <houle/water/friction.hpp>
#include <houle/water/held.hpp>
#include <houle/water/mass_matrix.hpp>
#include <houle/water/remesh.hpp>
#include <houle/water/sph.hpp>
#include <houle/water/surface.hpp>
#include <houle/water/transfer.hpp>
#include <houle/water/viscous.hpp>

// I(function): the function template with 2 and 3 in place of its dimension.
// clang-format off
#define HOULE_PRESSURE(I) I(pressure_system) I(project) I(extrapolate) I(continue_upwards) I(stop_at_solids)
#define HOULE_FLOW(I)                                                                                       \
  I(column_heights) I(column_levels) I(find_surface) I(water_above) I(water_held) I(density_excess)         \
  I(apply_forces) I(drag_work) I(eddy_viscosity) I(viscous_acceleration) I(rub) I(face_kinetic_energy)      \
  I(face_power) I(kinetic_energy) I(max_speed) I(move) I(travel) I(drift) I(displace) I(all_leave_solids)
#define HOULE_CROSSING(I)                                                                                   \
  I(sample_medium) I(hold_faces) I(carry) I(fall_behind) I(settle) I(cell_energy) I(scale_by_cell)          \
  I(remesh_conservative) I(remesh_paper)
#define HOULE_CELLS(I) I(cell_sort) I(sort_particles) I(scatter_cells) I(gather_cells)
#define HOULE_BESIDE(I) I(give_beside) I(give_residual_beside) I(take_beside) I(affine_beside)
// I(kernel, function): the same for each transfer kernel, or kernel of smoothed particles.
#define HOULE_TRANSFER(I, K) I(K, to_faces) I(K, add_residual) I(K, to_particles) I(K, affine_from)
#define HOULE_WIDE(I)                                                                                       \
  HOULE_TRANSFER(I, QuadraticKernel) HOULE_TRANSFER(I, M4PrimeKernel) HOULE_TRANSFER(I, GaussianKernel)
#define HOULE_OF_SPH(I, K) I(K, density_sum) I(K, sph_viscous_acceleration) I(K, velocity_gradient)
#define HOULE_SPH(I) HOULE_OF_SPH(I, WendlandC2) HOULE_OF_SPH(I, TruncatedGaussian)
// clang-format on

// In place of I: HOULE_HAS... declares that the library has a function, HOULE_COMPILE... compiles it.
#define HOULE_HAS(f)                   \
  extern template decltype(f<2>) f<2>; \
  extern template decltype(f<3>) f<3>;
#define HOULE_HAS_OF(K, f)                   \
  extern template decltype(f<K, 2>) f<K, 2>; \
  extern template decltype(f<K, 3>) f<K, 3>;
#define HOULE_HAS_SPH(K, f)                  \
  extern template decltype(f<2, K>) f<2, K>; \
  extern template decltype(f<3, K>) f<3, K>;
#define HOULE_COMPILE(f)        \
  template decltype(f<2>) f<2>; \
  template decltype(f<3>) f<3>;
#define HOULE_COMPILE_OF(K, f)        \
  template decltype(f<K, 2>) f<K, 2>; \
  template decltype(f<K, 3>) f<K, 3>;
#define HOULE_COMPILE_SPH(K, f)       \
  template decltype(f<2, K>) f<2, K>; \
  template decltype(f<3, K>) f<3, K>;

namespace houle {

HOULE_PRESSURE(HOULE_HAS)
HOULE_FLOW(HOULE_HAS)
HOULE_CROSSING(HOULE_HAS)
HOULE_CELLS(HOULE_HAS)
HOULE_BESIDE(HOULE_HAS)
HOULE_TRANSFER(HOULE_HAS_OF, LinearKernel)
HOULE_WIDE(HOULE_HAS_OF)
HOULE_SPH(HOULE_HAS_SPH)
extern template class MassMatrix<2>;
extern template class MassMatrix<3>;
extern template class PressureSolver<2>;
extern template class PressureSolver<3>;

}  // namespace houle
