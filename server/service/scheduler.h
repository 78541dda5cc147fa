#pragma once

#include <cstddef>
#include <deque>
#include <mutex>

#include "core/base/executor.h"

namespace moduli {

/// An executor with two doors. Interactive work is taken or refused at once; bulk work, whose
/// senders bound it themselves, waits before the door until the executor has room, and never takes
/// more than one place per thread, so that it cannot crowd out interactive work. Thread-safe.
class Scheduler {
 public:
  explicit Scheduler(const Executor::Options& options);

  /// Fails with kQueueFull, and with kServerDraining after shutdown. Never blocks.
  Status submit(Executor::Task task);

  /// Runs the task later, in the order of the calls. After shutdown it is dropped.
  void submitWhenRoom(Executor::Task task);

  /// Runs what the executor has taken, drops what waits before the door, joins the threads.
  void shutdown();

  std::size_t waiting() const { return executor_.waiting(); }
  std::size_t running() const { return executor_.running(); }
  std::size_t threads() const { return executor_.threads(); }

 private:
  void feed();

  std::mutex mutex_;
  std::deque<Executor::Task> before_the_door_;
  std::size_t bulk_inside_ = 0;  ///< Bulk tasks that the executor has taken and not started.
  Executor executor_;            ///< Last: its threads use the others.
};

}  // namespace moduli
