// The headers of every room in one program that is not houle's, with one call into each. Exit status 0 if all is right.
#include <cmath>
#include <cstdint>
#include <vector>

// every header of houle_core, by tests/core/test_library.py

namespace {

// Steady conduction along a bar of n cells, 1 at one end, closed at the other, fed with 1 per cell.
bool bar() {
  const houle::Grid<2> g{{1, 16}, {1.0, 1.0}, {}};
  std::vector<std::uint8_t> active(16, 1);
  std::vector<double> across(32, 0.0), along(17, 1.0), end(16, 0.0), fed(16, 1.0), p(16, 0.0);
  along.front() = along.back() = 0.0;
  end[0] = 2.0;  // half a cell from the centre
  houle::ConstFaces<2> k;
  k.data = {across.data(), along.data()};
  houle::PressureSolver<2> solver(g);
  solver.setup(active.data(), k, end.data());
  const auto solved = solver.solve(fed.data(), p.data(), 1e-10, 100);
  double worst = 0.0;
  for (int i = 0; i < 16; ++i) {
    const double exact = 8.0 + i * 16.0 - 0.5 * i * (i + 1.0);  // fluxes 16, 15, ...
    worst = std::max(worst, std::abs(p[static_cast<std::size_t>(i)] - exact));
  }
  return solved.iterations > 0 && worst < 1e-7;
}

// A sum over a loop that is shared among threads.
bool sum() {
  const double found = houle::parallel_sum(1000, [](houle::index i) { return static_cast<double>(i); });
  return found == 499500.0;
}

}  // namespace

int main() {
  houle::set_threads(2);
  return bar() && sum() ? 0 : 1;
}
