// Loop bodies read nothing of the one who calls: while a loop runs, its caller's stack can neither be read nor written.
//
// This file takes the place of threads.cpp, as a build for another machine would: it copies the bytes of a body to
// memory of its own, takes the stack of the program away, and runs the loop on another stack. A reference to a local
// variable, or a pointer to a local object, ends in a fault. Exit status 0 if there is none.
#include <signal.h>
#include <sys/mman.h>
#include <ucontext.h>
#include <unistd.h>

#include <cstring>

#include <houle/water/energy.hpp>
#include <houle/water/mass_matrix.hpp>
#include <houle/water/remesh.hpp>
#include <houle/water/sph.hpp>
#include <houle/water/viscous.hpp>

#include "rest.hpp"

namespace {

constexpr std::size_t stack_bytes = std::size_t{64} << 20;
alignas(64) unsigned char body[1 << 16];  // copy of the loop body that runs now
unsigned char handler_stack[1 << 16];
void* stack;
ucontext_t program_side, machine_side;
houle::Loop loop;
houle::index iterations;
long loops;
bool running, finished, good;

}  // namespace

namespace houle {

void set_threads(int) {}

int get_threads() { return 256; }  // so that short loops are shared, too

void share(index n, index, Loop given) {
  if (running || given.bytes > sizeof body) {
    constexpr char text[] = "a loop in a loop, or a body too large for this test\n";
    if (write(2, text, sizeof text - 1) < 0) _exit(3);
    _exit(2);
  }
  std::memcpy(body, given.body, given.bytes);
  loop = given;
  iterations = n;
  swapcontext(&program_side, &machine_side);
}

}  // namespace houle

namespace {

void on_fault(int) {
  constexpr char text[] = "a loop body read the stack of its caller\n";
  if (running && write(2, text, sizeof text - 1) < 0) _exit(3);
  _exit(1);
}

// Everything that can be done with a pool of water in clear tank: remeshing, transfers, viscosity, sums.
template <int D>
bool work(const houle::Grid<D>& g, double level) {
  rest::Pool<D> water(g, level);
  const houle::index n = water.count();
  std::vector<double> spare(water.x.size());
  std::vector<std::int32_t> order(water.volume.size()), start(static_cast<std::size_t>(g.cells()) + 1);
  houle::sort_particles(g, n, water.x.data(), water.u.data(), water.volume.data(), spare.data(), order.data(),
                        start.data());
  rest::FaceFields<double, D> velocity(g, 0.0), mass(g, 0.0), next(g, 0.0);
  const houle::Cloud<D> cloud{n, water.x.data(), nullptr, water.volume.data(), start.data(), {}};
  houle::MassMatrix<D> matrix(g);
  matrix.transfer(cloud, water.u.data(), 3, velocity.all(), mass.all(), next.all(), {});
  std::vector<double> nu(static_cast<std::size_t>(g.cells())), sums(water.volume.size());
  houle::eddy_viscosity<D>(g, velocity.all(), 1e-6, 0.1, nu.data());
  houle::viscous_acceleration<D>(g, velocity.all(), mass.all(), 0.0, 1e-6, nu.data(), {}, next.all());
  houle::Neighbours<D> near{g, {}, n, water.x.data(), start.data()};
  houle::density_sum(near, houle::WendlandC2(D, 2.0 * g.h[0]), water.volume.data(), sums.data());
  houle::velocity_gradient(near, houle::WendlandC2(D, 2.0 * g.h[0]), water.u.data(), water.volume.data(),
                           std::vector<double>(water.x.size() * D).data());
  const houle::ParticleView<D> old{n, water.x.data(), water.u.data(), water.volume.data(), nullptr};
  const std::vector<std::int8_t> half_cells(static_cast<std::size_t>(g.cells()) << D, 0);
  const houle::Pores<D> pores{{}, half_cells.data()};
  const auto made = houle::remesh_conservative<D>(g, pores, {}, {}, old, 0, 2 * g.shape[0]);
  const auto paper = houle::remesh_paper<D>(g, {}, old, 0.25);
  const double before = houle::total(n, water.volume.data()),
               after = houle::total(static_cast<houle::index>(made.volume.size()), made.volume.data());
  return !paper.volume.empty() && std::abs(after - before) < 1e-12 * before &&
         houle::kinetic_energy<D>(n, water.volume.data(), nullptr, water.u.data()) == 0.0;
}

void program() {
  const houle::Grid<2> flat{{200, 60}, {0.05, 0.04}, {}};
  const houle::Grid<3> deep{{24, 14, 20}, {0.05, 0.06, 0.04}, {false, true, false}};
  good = rest::at_rest(flat, 1.71) & rest::at_rest(deep, 0.533) & work(flat, 1.71) & work(deep, 0.533);
  finished = true;
  swapcontext(&program_side, &machine_side);
}

}  // namespace

int main() {
  stack = mmap(nullptr, stack_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (stack == MAP_FAILED) return 3;
  stack_t other{};
  other.ss_sp = handler_stack;
  other.ss_size = sizeof handler_stack;
  sigaltstack(&other, nullptr);
  struct sigaction action{};
  action.sa_handler = on_fault;
  action.sa_flags = SA_ONSTACK;
  sigaction(SIGSEGV, &action, nullptr);
  sigaction(SIGBUS, &action, nullptr);
  getcontext(&program_side);
  program_side.uc_stack.ss_sp = stack;
  program_side.uc_stack.ss_size = stack_bytes;
  makecontext(&program_side, program, 0);
  while (true) {
    swapcontext(&machine_side, &program_side);
    if (finished) break;
    running = true;
    mprotect(stack, stack_bytes, PROT_NONE);
    loop.run(body, 0, iterations);
    mprotect(stack, stack_bytes, PROT_READ | PROT_WRITE);
    running = false;
    ++loops;
  }
  std::printf("%ld loops ran without the stack of their caller\n", loops);
  return good && loops > 100 ? 0 : 1;
}
