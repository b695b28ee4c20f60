// Threads that take parts of a loop. Portable C++: no OpenMP, whose barriers spin for milliseconds when one of the
// threads has lost its core to another program.
//
// A loop is cut into one share per thread, a share into chunks. A thread takes the chunks of its own share, always the
// same, which so stays in its cache, then what is left of the others'. The thread that calls never waits for one that
// has not come: it does the work itself. So a busy machine costs little.
//
// What costs is the journey of a cache line from core to core, 0.1 us. So a share and all that is to be known of its
// loop are one line; its thread watches that line, and claims a chunk by counting in it. A chunk can be claimed only
// while the loop is open: the count carries the number of the loop. What a thread has done it tells in a line of its
// own.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

namespace houle {

using index = std::ptrdiff_t;

// Which parts of a loop are done, for those that must come after.
class Done {
 public:
  explicit Done(index parts) : done_(static_cast<std::size_t>(parts)) {}
  void set(index part) { done_[part].store(true, std::memory_order_release); }
  void wait(index part) const;  // for one that a running thread has begun, or the caller is about to

 private:
  std::vector<std::atomic<bool>> done_;
};

class Team {
 public:
  static constexpr int most = 256;  // threads

  struct Loop {
    void (*run)(const void* body, index begin, index end);
    const void* body;
    index chunk;     // iterations taken at a time
    int shares;      // in each of the
    int stages = 1;  // whose shares are all taken before one of the next
  };

  static Team& shared();  // one per process, as many threads as OMP_NUM_THREADS says, else as the machine has
  int size() const { return size_.load(std::memory_order_relaxed); }
  void resize(int threads);

  // Where on the first axis of the grid the particles are: of them share_before(i) lie before the fraction i / places.
  // A hint for those who cut loops over the grid: what a thread's particles meet there is then in its own cache.
  static constexpr int places = 64;
  void tell(int place, double share) {
    share_before_[place].store(static_cast<float>(share), std::memory_order_relaxed);
  }
  double share_before(int place) const { return share_before_[place].load(std::memory_order_relaxed); }

  // Runs the loop, share s of all stages being [bound(s), bound(s + 1)). False: the team is at work (another Python
  // thread, a loop in a loop), and the caller has to run the loop itself.
  template <class Bound>
  bool run(const Loop& loop, Bound bound) {
    std::unique_lock<std::mutex> mine(busy_, std::try_to_lock);
    if (!mine) return false;
    if (++number_ == CLOSED) ++number_;
    const int all = loop.shares * loop.stages;
    index end = bound(all), chunks = 0;
    for (int s = all - 1; s >= 0; --s) {  // the first last: who has seen his finds those of the later stages
      const index begin = bound(s);
      chunks += post(s, loop, begin, end);
      end = begin;
    }
    wake();
    finish(chunks);
    return true;
  }

 private:
  using Count = std::uint64_t;                // number of the loop, then of chunks in it
  static constexpr std::uint32_t CLOSED = 0;  // the number of no loop: nothing can be claimed

  struct Parts {  // read at once: all of one loop
    std::int16_t shares = 1, stages = 1;
    int all() const { return shares * stages; }
    int of(int self, int k) const { return k / shares * shares + (self + k) % shares; }  // which a thread takes as k-th
  };
  struct alignas(64) Share {
    std::atomic<Count> next{0};  // chunk
    std::atomic<void (*)(const void*, index, index)> run{nullptr};
    std::atomic<const void*> body{nullptr};
    std::atomic<index> begin{0}, end{0}, chunk{0};
    std::atomic<Parts> parts{Parts{}};
  };
  struct alignas(64) Tally {
    std::atomic<Count> done{0};  // chunks that this thread has taken from others than the caller knows of
  };

  std::mutex busy_;
  std::atomic<int> size_{1};
  int started_ = 1;           // threads there are, the caller's among them
  std::uint32_t number_ = 0;  // of the present loop
  std::array<std::atomic<float>, places + 1> share_before_{};
  std::array<Share, most> share_;
  std::array<Tally, most> tally_;
  alignas(64) std::atomic<int> asleep_{0};
  std::atomic<int> bell_{0};

  Team();
  void orphan();
  index post(int s, const Loop& loop, index begin, index end);  // returns the chunks of the share
  void wake();
  index take(int s, std::uint32_t number);  // chunks of share s, as long as there are any; returns how many
  void finish(index chunks);
  void work(int self);
};

}  // namespace houle
