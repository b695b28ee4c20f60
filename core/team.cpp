#include "team.hpp"

#include <chrono>
#include <cstdlib>
#include <system_error>
#include <thread>

#if defined(__x86_64__) || defined(_M_X64)
#include <immintrin.h>
#endif
#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#endif

// Where a thread that loses its core does most harm; tests/stress makes it lose it there.
#ifndef HOULE_PREEMPT
#define HOULE_PREEMPT()
#endif

namespace houle {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto AWAKE = std::chrono::milliseconds(1);  // how long a thread without work stays: Python between two loops
constexpr int PATIENCE = 4000;                        // looks at a chunk under way before the core is offered to it

inline void pause() {
#if defined(__x86_64__) || defined(_M_X64)
  _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
  asm volatile("yield");
#endif
}

template <class Test>
inline void wait_until(Test test) {
  for (int looks = 0; !test(); ++looks)
    if (looks < PATIENCE)
      pause();
    else
      std::this_thread::yield();
}

int wanted_threads() {
  const char* text = std::getenv("OMP_NUM_THREADS");
  const int wanted = text ? std::atoi(text) : 0;
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

Team& Team::shared() {
  static Team* const team = new Team;  // never destroyed: its threads sleep until the process ends
  return *team;
}

Team::Team() {
  for (int i = 0; i <= places; ++i) tell(i, static_cast<double>(i) / places);
  resize(wanted_threads());
#if defined(__unix__) || defined(__APPLE__)
  pthread_atfork([] { shared().busy_.lock(); }, [] { shared().busy_.unlock(); }, [] { shared().orphan(); });
#endif
}

// In the child of a fork, where no thread lives but the one that forked. It waited for the loop under way, so that all
// is as between two loops; the others are started again when the child asks for them (resize).
void Team::orphan() {
  started_ = 1;
  size_ = 1;
  asleep_ = 0;
  busy_.unlock();
}

void Team::resize(int threads) {
  const std::lock_guard<std::mutex> mine(busy_);
  threads = std::clamp(threads, 1, most);
  try {
    for (; started_ < threads; ++started_) std::thread(&Team::work, this, started_).detach();
  } catch (const std::system_error&) {  // the system gives no more
  }
  size_ = std::min(threads, started_);
  bell_.fetch_add(1);
  bell_.notify_all();
}

// The share is closed before its fields change: a thread that has read one of the new fields finds the count of its own
// loop gone (release here, acquire in `take`) and claims nothing.
index Team::post(int s, const Loop& loop, index begin, index end) {
  constexpr auto release = std::memory_order_release;
  Share& share = share_[s];
  share.next.store(Count{CLOSED} << 32, std::memory_order_relaxed);
  share.run.store(loop.run, release);
  share.body.store(loop.body, release);
  share.begin.store(begin, release);
  share.end.store(end, release);
  share.chunk.store(loop.chunk, release);
  HOULE_PREEMPT();
  share.parts.store({static_cast<std::int16_t>(loop.shares), static_cast<std::int16_t>(loop.stages)}, release);
  share.next.store(Count{number_} << 32, release);
  return end > begin ? (end - begin + loop.chunk - 1) / loop.chunk : 0;
}

// A thread that goes to sleep at this very moment may be missed: then it comes to the next loop.
void Team::wake() {
  if (asleep_.load(std::memory_order_relaxed) == 0) return;
  bell_.fetch_add(1);
  bell_.notify_all();
}

// A chunk is claimed by counting it in the very word that `post` changes first. So whoever claims one has read the
// fields of its loop: a field of a later loop is seen only after that word has changed, and then the exchange fails.
index Team::take(int s, std::uint32_t number) {
  constexpr auto acquire = std::memory_order_acquire;
  Share& share = share_[s];
  index taken = 0;
  for (Count next = share.next.load(acquire); next >> 32 == number;) {
    const auto run = share.run.load(acquire);
    const void* body = share.body.load(acquire);
    HOULE_PREEMPT();
    const index chunk = share.chunk.load(acquire), end = share.end.load(acquire);
    const index begin = share.begin.load(acquire) + static_cast<index>(next & 0xffffffffu) * chunk;
    if (begin >= end) break;
    HOULE_PREEMPT();
    if (!share.next.compare_exchange_strong(next, next + 1, std::memory_order_acq_rel)) continue;
    run(body, begin, std::min(begin + chunk, end));
    ++taken;
    next = share.next.load(acquire);
  }
  return taken;
}

// The caller's own share, what has not been taken of the others', and the wait for the chunks that are under way.
void Team::finish(index chunks) {
  const Parts parts = share_[0].parts.load(std::memory_order_relaxed);
  index left = chunks - take(0, number_);
  const auto others = [&] {
    index done = 0;
    for (int s = 1; s < parts.all(); ++s) {
      const Count count = tally_[s].done.load(std::memory_order_acquire);
      if (count >> 32 == number_) done += static_cast<index>(count & 0xffffffffu);
    }
    return done;
  };
  if (others() == left) return;
  for (int k = 1; k < parts.all(); ++k) left -= take(parts.of(0, k), number_);
  wait_until([&] { return others() == left; });
}

void Done::wait(index part) const {
  wait_until([&] { return done_[part].load(std::memory_order_acquire); });
}

void Team::work(int self) {
  std::uint32_t last = 0;
  auto since = Clock::now();
  for (unsigned looks = 1;; ++looks) {
    const auto number = static_cast<std::uint32_t>(share_[self].next.load(std::memory_order_acquire) >> 32);
    if (number != last && number != CLOSED) {
      last = number;
      const Parts parts = share_[self].parts.load(std::memory_order_relaxed);
      Count done = 0;
      for (int k = 0; k < parts.all(); ++k) {
        const index taken = take(parts.of(self, k), number);
        if (taken == 0) continue;
        done += static_cast<Count>(taken);
        tally_[self].done.store(Count{number} << 32 | done, std::memory_order_release);
      }
      if (done > 0) since = Clock::now();
      looks = 0;
    } else if (looks % 64 != 0 || (self < size() && Clock::now() - since < AWAKE)) {
      pause();
    } else {
      const bool needed = self < size();
      const int bell = bell_.load();
      asleep_ += needed;
      if (share_[self].next.load() >> 32 == last) bell_.wait(bell);
      asleep_ -= needed;
      since = Clock::now();
    }
  }
}

}  // namespace houle
