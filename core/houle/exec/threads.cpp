#include <houle/exec/threads.hpp>

#if defined(HOULE_TBB)

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <thread>

#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#endif

// ThreadSanitizer does not see what the library puts in order, and is told. This file itself is compiled without it.
#if defined(HOULE_THREAD_SANITIZER)
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
#else
static void __tsan_acquire(void*) {}
static void __tsan_release(void*) {}
#endif

namespace houle {

namespace {

constexpr int most = 256;

int wanted_threads() {
  const char* text = std::getenv("OMP_NUM_THREADS");
  const int wanted = text ? std::atoi(text) : 0;
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::atomic<bool> orphan{false};  // in the child of a fork

class Threads {
 public:
  using Arena = std::shared_ptr<tbb::task_arena>;

  static Threads& all() {
    static auto* const one = new Threads;  // never destroyed: a loop may still be under way when the process ends
    return *one;
  }
  int size() const { return orphan ? 1 : size_.load(std::memory_order_relaxed); }
  Arena arena() {  // lives as long as a loop is under way in it, whatever number is set meanwhile
    const std::lock_guard<std::mutex> lock(mutex_);
    return arena_;
  }
  void resize(int threads) {
    if (orphan) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    size_ = std::clamp(threads, 1, most);
    arena_ = std::make_shared<tbb::task_arena>(size_.load());
  }

 private:
  std::mutex mutex_;
  std::atomic<int> size_{1};
  Arena arena_;

  Threads() {
    resize(wanted_threads());
#if defined(__unix__) || defined(__APPLE__)
    pthread_atfork(nullptr, nullptr, [] { orphan = true; });
#endif
  }
};

}  // namespace

void set_threads(int threads) { Threads::all().resize(threads); }

int get_threads() { return Threads::all().size(); }

void share(index n, index part, Loop loop) {
  const auto arena = Threads::all().arena();
  alignas(8) char begun;  // before the first iteration
  alignas(8) char done;   // after the last
  __tsan_release(&begun);
  arena->execute([&] {
    tbb::parallel_for(tbb::blocked_range<index>(0, n, part), [&](const tbb::blocked_range<index>& range) {
      __tsan_acquire(&begun);
      loop.run(loop.body, range.begin(), range.end());
      __tsan_release(&done);
    });
  });
  __tsan_acquire(&done);
}

}  // namespace houle

#else

namespace houle {

void set_threads(int) {}

int get_threads() { return 1; }

void share(index n, index, Loop loop) { loop.run(loop.body, 0, n); }

}  // namespace houle

#endif
