// Stress test of parallel loops: every iteration of every loop runs exactly once, with the body of its own loop, and is
// done when the loop returns; slabs of a later colour find those beside them done; sums have the same bits; loops of
// two callers at once and loops in loops do not meet, nor do they mind that the number of threads is set meanwhile.
//
//     loops THREADS LOOPS [SEED]      exit status 0 if no loop was wrong
//
// The core is taken from iterations now and then, for up to 0.2 ms. That is what a busy machine does once in ten
// thousand loops.
#include <tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <thread>
#include <vector>

#include <houle/exec/reduce.hpp>
#include <houle/exec/scan.hpp>
#include <houle/exec/sort.hpp>
#include <houle/exec/turn.hpp>

using namespace houle;

namespace {

std::atomic<std::uint64_t> seed{1};

void preempt() {
  thread_local std::uint64_t state = seed.fetch_add(0x9e3779b97f4a7c15u) | 1;
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  if (state % 512 == 0)
    std::this_thread::sleep_for(std::chrono::microseconds(state / 512 % 200));
  else if (state % 64 == 1)
    std::this_thread::yield();
}

constexpr index MOST = 512;

struct Found {
  long loops = 0, wrong = 0, late = 0, out_of_order = 0, sums = 0;
  long all() const { return wrong + late + out_of_order + sums; }
};

// A loop of n iterations, each counted in its own place. `current` names the loop under way: an iteration that finds
// another name there ran after its loop had returned.
void plain_loop(index n, std::vector<std::atomic<unsigned>>& count, Found& found) {
  static thread_local std::atomic<long> current{0}, late{0};
  const long mine = ++current;
  for (index i = 0; i < n; ++i) count[i].store(0, std::memory_order_relaxed);
  auto* counts = count.data();
  auto *now = &current, *missed = &late;
  parallel_for(
      n,
      [=](index i) {
        preempt();
        counts[i].fetch_add(1, std::memory_order_relaxed);
        if (now->load(std::memory_order_relaxed) != mine) missed->fetch_add(1);
      },
      4);
  bool good = true;
  for (index i = 0; i < n; ++i) good = good && count[i].load(std::memory_order_relaxed) == 1;
  found.wrong += !good;
  found.late += late.exchange(0);
}

// Slabs in two colours, plain memory: an odd slab reads what the even ones beside it have written in this loop.
void coloured_loop(index n, long name, std::vector<long>& written, Found& found) {
  std::vector<char> bad(static_cast<std::size_t>(n), 0);
  long* value = written.data();
  char* wrong = bad.data();
  parallel_for_coloured(
      n, 2, [](index i) { return static_cast<int>(i % 2); },
      [=](index i) {
        preempt();
        if (i % 2 == 1) wrong[i] = value[i - 1] != name || value[i + 1] != name;
        value[i] = name;
      });
  for (index i = 0; i < n; ++i) found.out_of_order += bad[i] != 0 || written[i] != name;
}

void sum(index n, double expected, Found& found) {
  const double total = parallel_reduce(n, 0.0, [](index i) { return 1.0 / static_cast<double>(i + 1); }, std::plus<>());
  found.sums += total != expected;
}

// Each iteration of the outer loop has a loop of its own.
void nested_loop(index n, Found& found) {
  std::vector<double> inner(static_cast<std::size_t>(n), 0.0);
  double* sums = inner.data();
  parallel_for(
      n, [=](index i) { sums[i] = parallel_sum(2000, [=](index j) { return static_cast<double>(i * j); }); }, 1);
  for (index i = 0; i < n; ++i) found.sums += inner[i] != static_cast<double>(i) * 1999.0 * 1000.0;
}

constexpr index SUMMED = 20000, SLABS = 33;

// One caller's loops of all kinds.
void stress(long loops, double expected, Found& found) {
  constexpr index lengths[] = {16, 512, 24, 256};
  std::vector<std::atomic<unsigned>> count(MOST);
  std::vector<long> written(SLABS, 0);
  while (found.loops < loops) {
    const long k = ++found.loops;
    if (k % 8 == 0)
      coloured_loop(SLABS, k, written, found);
    else if (k % 16 == 4)
      nested_loop(8, found);
    else if (k % 8 == 4)
      sum(SUMMED, expected, found);
    else
      plain_loop(lengths[k % 4], count, found);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: loops THREADS LOOPS [SEED]\n"), 2;
  const int threads = std::atoi(argv[1]);
  const long loops = std::atol(argv[2]);
  if (argc > 3) seed = static_cast<std::uint64_t>(std::atoll(argv[3]));

  set_threads(1);
  const double expected =
      parallel_reduce(SUMMED, 0.0, [](index i) { return 1.0 / static_cast<double>(i + 1); }, std::plus<>());
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads) + 1);
  set_threads(threads);
  if (get_threads() != threads) return std::printf("no %d threads\n", threads), 1;

  Found found, other;
  std::thread second([&] { stress(loops - loops / 2, expected, other); });
  stress(loops / 2, expected, found);
  for (int k = 0; k < 20; ++k) {  // the other may still be at work
    set_threads(1 + k % threads);
    stress(found.loops + 1, expected, found);
  }
  second.join();
  found.loops += other.loops, found.wrong += other.wrong, found.late += other.late;
  found.out_of_order += other.out_of_order, found.sums += other.sums;
  std::printf("threads %d, loops %ld: wrong %ld, late %ld, out of order %ld, other sums %ld\n", threads, found.loops,
              found.wrong, found.late, found.out_of_order, found.sums);
  return found.all() == 0 ? 0 : 1;
}
