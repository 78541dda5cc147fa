#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <queue>
#include <thread>
#include <vector>

#include "core/base/status.h"

namespace moduli {

/// Interactive work overtakes bulk work that has not started yet.
enum class Priority : std::uint8_t { kInteractive = 0, kBulk = 1 };

/// A fixed number of threads behind a bounded queue. Within one priority first come, first served.
///
///   Executor executor({.threads = 2, .queue_limit = 64});
///   RETURN_IF_ERROR(executor.submit(Priority::kBulk, [] { ... }));
///
/// A full queue refuses at once (kQueueFull) and never blocks the caller. Every accepted task runs
/// exactly once, unless shutdown(kDiscard) drops it. Tasks must not throw. Thread-safe.
class Executor {
 public:
  using Task = std::function<void()>;

  struct Options {
    std::size_t threads = 0;       ///< 0: one per processor.
    std::size_t queue_limit = 64;  ///< Tasks that may wait, both priorities together.
  };

  enum class Drain : std::uint8_t { kFinish, kDiscard };

  explicit Executor(const Options& options);
  ~Executor();  ///< As shutdown(kFinish).
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  /// Fails with kQueueFull when the queue is at its limit, kServerDraining after shutdown.
  Status submit(Priority priority, Task task);

  /// Refuses new tasks, runs (or drops) those that wait, and joins the threads. Returns the number
  /// of dropped tasks. Later calls do nothing.
  std::size_t shutdown(Drain drain);

  std::size_t waiting() const;
  std::size_t running() const;
  std::size_t threads() const { return thread_count_; }

 private:
  struct Entry {
    Priority priority;
    std::uint64_t order;
    Task task;
  };
  struct Later {
    bool operator()(const Entry& a, const Entry& b) const {
      return a.priority != b.priority ? a.priority > b.priority : a.order > b.order;
    }
  };

  void run();

  const std::size_t queue_limit_;
  std::size_t thread_count_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::priority_queue<Entry, std::vector<Entry>, Later> queue_;
  std::uint64_t next_order_ = 0;
  std::size_t running_ = 0;
  bool closed_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace moduli
