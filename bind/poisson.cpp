#include <houle/compiled/lists.hpp>
#include <houle/pressure/poisson.hpp>

#include "arguments.hpp"

namespace houle {

template <int D>
static void bind_solver(nb::module_& m, const char* name) {
  using Solver = PressureSolver<D>;
  nb::class_<Solver> solver(m, name,
                            "Solves sum_f k_f (p_c - p_nb) + e_c p_c = rhs_c in the active cells of a grid, by "
                            "conjugate gradients preconditioned with multigrid.");
  solver.def(nb::init<const Grid<D>&>(), "grid"_a)
      .def_prop_ro("buffers", &Solver::buffers, "Addresses and sizes of the work arrays: they never change.")
      .def_prop_ro("closed_components", &Solver::closed_components);
  define(
      solver, "setup",
      [](Solver& s, Array<const std::uint8_t> active, Givens k, Given e) {
        const std::uint8_t* wet = cells(s.grid(), active, "active");
        const auto kk = faces(s.grid(), k, "k");
        s.setup(wet, kk, cells(s.grid(), e, "e"));
      },
      "active"_a, "k"_a, "e"_a);
  define(
      solver, "solve",
      [](Solver& s, Given rhs, Field p, double tolerance, int max_iterations, std::optional<Array<float>> guess) {
        const double* source = cells(s.grid(), rhs, "rhs");
        double* pressure = cells(s.grid(), p, "p");
        float* first = cells(s.grid(), guess, "guess");
        const SolveResult r = s.solve(source, pressure, tolerance, max_iterations, first);
        return std::pair(r.iterations, r.residual);
      },
      "rhs"_a, "p"_a, "tolerance"_a, "max_iterations"_a, "guess"_a = nb::none());
}

void bind_poisson(nb::module_& m) {
  bind_solver<2>(m, "PressureSolver2");
  bind_solver<3>(m, "PressureSolver3");
}

}  // namespace houle
