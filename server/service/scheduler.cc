#include "server/service/scheduler.h"

#include <algorithm>
#include <utility>

namespace moduli {
namespace {

Executor::Options withRoom(Executor::Options options) {
  // A task that waits before the door is let in when another one leaves the queue: without any
  // place in the queue that would never happen.
  options.queue_limit = std::max<std::size_t>(1, options.queue_limit);
  return options;
}

}  // namespace

Scheduler::Scheduler(const Executor::Options& options) : executor_(withRoom(options)) {}

Status Scheduler::submit(Executor::Task task) {
  return executor_.submit(Priority::kInteractive, [this, task = std::move(task)] {
    feed();
    task();
  });
}

void Scheduler::submitWhenRoom(Executor::Task task) {
  {
    const std::lock_guard lock(mutex_);
    before_the_door_.push_back(std::move(task));
  }
  feed();
}

void Scheduler::feed() {
  const std::lock_guard lock(mutex_);
  while (!before_the_door_.empty() && bulk_inside_ < executor_.threads()) {
    // Copied, because a refused task must not be lost.
    const Status taken = executor_.submit(Priority::kBulk, [this, task = before_the_door_.front()] {
      {
        const std::lock_guard started(mutex_);
        --bulk_inside_;
      }
      feed();
      task();
    });
    // The queue is full, so a task is in it that feeds again when it starts.
    if (!taken.ok()) return;
    before_the_door_.pop_front();
    ++bulk_inside_;
  }
}

void Scheduler::shutdown() {
  std::deque<Executor::Task> dropped;
  {
    const std::lock_guard lock(mutex_);
    dropped.swap(before_the_door_);
  }
  executor_.shutdown(Executor::Drain::kFinish);
  const std::lock_guard lock(mutex_);
  before_the_door_.clear();
}

}  // namespace moduli
