// The threads that loops are shared among: those of oneTBB, which only threads.cpp knows.
#pragma once

#include <cstddef>

namespace houle {

using index = std::ptrdiff_t;

// A loop whose iterations can run in any order and at the same time: run(body, begin, end) does those from begin to
// end - 1.
struct Loop {
  void (*run)(const void* body, index begin, index end);
  const void* body;
};

// How many threads loops are shared among, 1 to 256, the caller's among them. Where houle was built without oneTBB, and
// in the child of a fork, which has none of its parent's threads, that is 1.
void set_threads(int threads);
int get_threads();  // as OMP_NUM_THREADS says, else as many as the machine has, until it is set

// Runs iterations 0 .. n - 1 and returns when all are done. They are taken in parts of `part` iterations or fewer than
// twice as many.
void share(index n, index part, Loop loop);

}  // namespace houle
