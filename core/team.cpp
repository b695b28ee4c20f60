#include "team.hpp"

#include <chrono>
#include <cstdlib>
#include <system_error>
#include <thread>

#if defined(__x86_64__) || defined(_M_X64)
#include <immintrin.h>
#endif

namespace houle {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto AWAKE = std::chrono::microseconds(100);  // how long a thread without work stays: a few calls from Python
constexpr int PATIENCE = 4000;                          // looks at a chunk under way before the core is offered to it

inline void pause() {
#if defined(__x86_64__) || defined(_M_X64)
  _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
  asm volatile("yield");
#endif
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

Team::Team() { resize(wanted_threads()); }

void Team::resize(int threads) {
  const std::lock_guard<std::mutex> mine(busy_);
  threads = std::max(1, threads);
  if (threads > started_ || !share_) share_ = std::make_unique<Share[]>(static_cast<std::size_t>(threads));
  try {
    for (; started_ < threads; ++started_) std::thread(&Team::work, this, started_).detach();
  } catch (const std::system_error&) {  // the system gives no more
  }
  size_ = std::min(threads, started_);
  epoch_.fetch_add(2);
  epoch_.notify_all();
}

void Team::open() {
  epoch_.fetch_add(1);
  if (asleep_.load() > 0) epoch_.notify_all();
}

void Team::take(int self) {
  for (int k = 0; k < loop_.shares; ++k) {
    Share& share = share_[(self + k) % loop_.shares];
    while (share.next.load(std::memory_order_relaxed) < share.end) {
      const index begin = share.next.fetch_add(loop_.chunk, std::memory_order_relaxed);
      if (begin < share.end) loop_.run(loop_.body, begin, std::min(begin + loop_.chunk, share.end));
    }
  }
}

// All chunks are taken: nobody may come in any more, and who is inside finishes the one he has.
void Team::close() {
  epoch_.fetch_add(1);
  for (int looks = 0; inside_.load() > 0; ++looks)
    if (looks < PATIENCE)
      pause();
    else
      std::this_thread::yield();
}

void Team::work(int self) {
  int last = 0;
  auto since = Clock::now();
  for (unsigned looks = 1;; ++looks) {
    const int epoch = epoch_.load();
    if (epoch % 2 != 0 && epoch != last && self < size()) {
      last = epoch;
      inside_.fetch_add(1);
      const bool came = epoch_.load() == epoch;
      if (came && self < loop_.shares) take(self);
      inside_.fetch_sub(1);
      if (came) since = Clock::now();
      looks = 0;
    } else if (looks % 64 != 0 || (self < size() && Clock::now() - since < AWAKE)) {
      pause();
    } else {
      const bool needed = self < size();
      asleep_ += needed;
      epoch_.wait(epoch);
      asleep_ -= needed;
      since = Clock::now();
    }
  }
}

}  // namespace houle
