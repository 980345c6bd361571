// Teams of threads that take each part of a step together.
//
// Every thread runs the same program on its own share: rows of cells, and whole bodies. A `wait`
// stands between what one thread writes and another reads. No sum depends on their number.
#pragma once
#if !defined(__wasm__)
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>
#endif

namespace microcosmos {

#if defined(__wasm__)

// One member: the page has no threads that share memory.
class Team {
 public:
  explicit Team(int) {}
  int size() const { return 1; }
  void run(void (*work)(void*, int), void* object) { work(object, 0); }
  void wait() {}
};

#else

class Team {
 public:
  // At most `size` members; fewer if the system has no more threads.
  explicit Team(int size) {
    threads_.reserve(size);
    try {
      while (int(threads_.size()) < size - 1)
        threads_.emplace_back(&Team::serve, this, threads_.size() + 1);
    } catch (const std::system_error&) {  // Results do not depend on the number: go on with fewer.
    }
    size_ = 1 + int(threads_.size());
  }
  ~Team() {
    work_ = nullptr;
    begun_.store(true, std::memory_order_release);
    for (std::thread& one : threads_) one.join();
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int size() const { return size_; }

  // Call work(object, member) on every member, once.
  void run(void (*work)(void*, int), void* object) {
    work_ = work, object_ = object;
    begun_.store(true, std::memory_order_release);
    work(object, 0);
    wait();
  }

  // Wait until all members have come here.
  void wait() {
    if (size_ == 1) return;
    const int turn = turn_.load(std::memory_order_acquire);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) == size_ - 1) {
      // Before the turn: whom it releases may arrive at the next `wait` at once.
      arrived_.store(0, std::memory_order_relaxed);
      turn_.store(turn + 1, std::memory_order_release);
    } else
      linger([&] { return turn_.load(std::memory_order_acquire) != turn; });
  }

 private:
  // Spin for some microseconds, then let other threads of the machine run.
  template <class Condition>
  static void linger(Condition met) {
    constexpr int SPINS = 4000;
    for (int n = 0; !met(); n++)
      if (n >= SPINS) std::this_thread::yield();
  }

  void serve(int member) {
    linger([&] { return begun_.load(std::memory_order_acquire); });
    if (!work_) return;
    work_(object_, member);
    wait();
  }

  std::vector<std::thread> threads_;
  int size_ = 1;
  std::atomic<bool> begun_{false};
  std::atomic<int> arrived_{0}, turn_{0};
  void (*work_)(void*, int) = nullptr;
  void* object_ = nullptr;
};

#endif

}  // namespace microcosmos
