// Loops that are shared among threads: parallel_for, on which the other verbs (sums, selections, sorts) of exec/ are
// built.
//
// A loop body is a copy of numbers and pointers. It captures them by value, holds nothing that has to be destroyed,
// reads nothing of its caller, allocates nothing and throws nothing. So its bytes can be taken elsewhere: a build for
// another kind of machine, with memory that both reach, replaces the verbs of exec/ and nothing else.
//
// Every result is bitwise the same for any number of threads: iterations are independent of each other.
#pragma once

#include <algorithm>
#include <type_traits>

#include <houle/exec/threads.hpp>

#if defined(_MSC_VER)
#define HOULE_NOINLINE __declspec(noinline)
#else
#define HOULE_NOINLINE __attribute__((noinline))
#endif

// HOULE_INDEPENDENT stands before a loop whose iterations write nothing that others read: the compiler may vectorise
// it.
#if defined(__clang__)
#define HOULE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define HOULE_INDEPENDENT _Pragma("GCC ivdep")
#elif defined(_MSC_VER)
#define HOULE_INDEPENDENT __pragma(loop(ivdep))
#else
#define HOULE_INDEPENDENT
#endif

namespace houle {

// Runs the iterations begin .. end - 1 of a loop. It is not inlined: one compilation serves any number of threads. The
// body is copied, and nothing else points to the copy: the compiler can keep in registers the numbers that it captured.
template <class Body>
HOULE_NOINLINE inline void run_share(index begin, index end, const Body& shared) {
  const Body body(shared);
  for (index i = begin; i < end; ++i) body(i);
}

// Calls body(i) for i = 0..n-1, in any order. grain: fewer iterations than this are not worth waking a thread.
template <class Body>
inline void parallel_for(index n, const Body& body, index grain = 1024) {
  static_assert(std::is_trivially_copyable_v<Body>, "a loop body captures numbers and pointers, by value");
  constexpr index parts = 16;  // parts of the loop for each thread: idle threads take over some
  const index threads = std::min<index>(get_threads(), n / grain);
  if (threads < 2) return run_share(0, n, body);
  const index part = std::max<index>({n / (parts * threads), grain / 4, 1});
  share(n, part,
        {[](const void* b, index begin, index end) { run_share(begin, end, *static_cast<const Body*>(b)); }, &body,
         sizeof(Body)});
}

}  // namespace houle
