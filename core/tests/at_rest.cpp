// Water at rest in 2D and in 3D, on two threads. Exit status 0 if it stays at rest.
#include "rest.hpp"

int main() {
  houle::set_threads(2);
  std::printf("threads: %d\n", houle::get_threads());
  const bool flat = rest::at_rest(houle::Grid<2>{{40, 24}, {0.05, 0.04}, {}}, 0.71);
  const bool deep = rest::at_rest(houle::Grid<3>{{12, 7, 16}, {0.05, 0.06, 0.04}, {false, true, false}}, 0.433);
  return flat && deep ? 0 : 1;
}
