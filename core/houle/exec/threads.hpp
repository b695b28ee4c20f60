// The threads that loops are shared among: those of oneTBB, which only threads.cpp knows.
#pragma once

#include <cstddef>

namespace houle {

// The signed integer with which cells, faces and particles are counted and numbered.
using index = std::ptrdiff_t;

// A loop whose iterations can run in any order and at the same time: run(body, begin, end) does those from begin to
// end - 1. All that they need is in the bytes of the body, which can be copied elsewhere, and in the arrays that these
// point to (core/tests/no_stack.cpp).
struct Loop {
  void (*run)(const void* body, index begin, index end);
  const void* body;
  std::size_t bytes;
};

// Sets how many threads loops are shared among, 1 to 256, the caller's among them. Where houle was built without
// oneTBB, and in the child of a fork, which has none of its parent's threads, that stays 1.
void set_threads(int threads);

// Returns how many threads loops are shared among. Until set_threads() is called it is the number in OMP_NUM_THREADS,
// else that of the machine's cores.
int get_threads();

// Runs iterations 0 .. n - 1 and returns when all are done. They are taken in parts of `part` iterations or fewer than
// twice as many.
void share(index n, index part, Loop loop);

}  // namespace houle
