// Threads that take parts of a loop. Portable C++: no OpenMP, whose barriers spin for milliseconds when one of the
// threads has lost its core to another program.
//
// A loop is cut into one share per thread, a share into chunks. A thread takes the chunks of its own share, always the
// same, which so stays in its cache, then what is left of the others'. The thread that calls never waits for one that
// has not come: it does the work itself. So a busy machine costs little.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>

namespace houle {

using index = std::ptrdiff_t;

class Team {
 public:
  struct Loop {
    void (*run)(const void* body, index begin, index end);
    const void* body;
    index chunk;  // iterations taken at a time
    int shares;
  };

  static Team& shared();  // one per process, as many threads as OMP_NUM_THREADS says, else as the machine has
  int size() const { return size_.load(std::memory_order_relaxed); }
  void resize(int threads);

  // Runs the loop, share s being [bound(s), bound(s + 1)). False: the team is at work (another Python thread, a loop
  // in a loop), and the caller has to run the loop itself.
  template <class Bound>
  bool run(const Loop& loop, Bound bound) {
    std::unique_lock<std::mutex> mine(busy_, std::try_to_lock);
    if (!mine) return false;
    loop_ = loop;
    for (int s = 0; s < loop.shares; ++s) {
      share_[s].next.store(bound(s), std::memory_order_relaxed);
      share_[s].end = bound(s + 1);
    }
    open();
    take(0);
    close();
    return true;
  }

 private:
  struct alignas(64) Share {
    std::atomic<index> next{0};
    index end = 0;
  };

  std::mutex busy_;
  std::atomic<int> size_{1};
  int started_ = 1;  // threads there are, the caller's among them
  Loop loop_{};
  std::unique_ptr<Share[]> share_;
  alignas(64) std::atomic<int> epoch_{0};   // odd: a loop is open
  alignas(64) std::atomic<int> inside_{0};  // workers that may touch the loop
  std::atomic<int> asleep_{0};

  Team();
  void open();
  void take(int self);
  void close();
  void work(int self);
};

}  // namespace houle
