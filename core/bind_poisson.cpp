#include "bind.hpp"
#include "poisson.hpp"

namespace houle {

template <int D>
static void bind_solver(nb::module_& m, const char* name) {
  using Solver = PressureSolver<D>;
  nb::class_<Solver>(m, name,
                     "Solves sum_f k_f (p_c - p_nb) + e_c p_c = rhs_c in the active cells of a grid, by conjugate "
                     "gradients preconditioned with multigrid.")
      .def(nb::init<const Grid<D>&>(), "grid"_a)
      .def(
          "setup",
          [](Solver& s, Array<const std::uint8_t> active, std::vector<Array<double>> k, Array<const double> e) {
            require_cells(s.grid(), active.size(), "active");
            require_cells(s.grid(), e.size(), "e");
            s.setup(active.data(), faces_of(s.grid(), k, "k"), e.data());
          },
          "active"_a, "k"_a, "e"_a)
      .def(
          "solve",
          [](Solver& s, Array<const double> rhs, Array<double> p, double tolerance, int max_iterations,
             std::optional<Array<float>> guess) {
            require_cells(s.grid(), rhs.size(), "rhs");
            require_cells(s.grid(), p.size(), "p");
            if (guess) require_cells(s.grid(), guess->size(), "guess");
            const SolveResult r =
                s.solve(rhs.data(), p.data(), tolerance, max_iterations, guess ? guess->data() : nullptr);
            return std::pair(r.iterations, r.residual);
          },
          "rhs"_a, "p"_a, "tolerance"_a, "max_iterations"_a, "guess"_a = nb::none())
      .def_prop_ro("buffers", &Solver::buffers, "Addresses and sizes of the work arrays: they never change.")
      .def_prop_ro("closed_components", &Solver::closed_components);
}

void bind_poisson(nb::module_& m) {
  bind_solver<2>(m, "PressureSolver2");
  bind_solver<3>(m, "PressureSolver3");
}

}  // namespace houle
