#include "core/base/executor.h"

#include <algorithm>
#include <string>
#include <utility>

namespace moduli {

Executor::Executor(const Options& options) : queue_limit_(options.queue_limit) {
  thread_count_ = options.threads != 0
                      ? options.threads
                      : std::max<std::size_t>(1, std::thread::hardware_concurrency());
  threads_.reserve(thread_count_);
  for (std::size_t i = 0; i < thread_count_; ++i) threads_.emplace_back([this] { run(); });
}

Executor::~Executor() {
  shutdown(Drain::kFinish);
}

Status Executor::submit(Priority priority, Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) {
      return {Reason::kServerDraining, "the server is shutting down and takes no new work",
              "retry against another server, or when it is back"};
    }
    if (queue_.size() >= queue_limit_) {
      return {Reason::kQueueFull, "all " + std::to_string(queue_limit_) + " places are taken",
              "retry after a pause, or raise --queue-limit"};
    }
    queue_.push({priority, next_order_++, std::move(task)});
  }
  wake_.notify_one();
  return {};
}

void Executor::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return closed_ || !queue_.empty(); });
    if (queue_.empty()) return;
    // top() is const only to protect the order, which pop() is about to restore.
    Task task = std::move(const_cast<Entry&>(queue_.top()).task);
    queue_.pop();
    ++running_;
    lock.unlock();
    task();
    task = nullptr;  // Whatever the task holds is released before it counts as done.
    lock.lock();
    --running_;
  }
}

std::size_t Executor::shutdown(Drain drain) {
  std::size_t dropped = 0;
  std::vector<std::thread> threads;
  decltype(queue_) discarded;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    threads.swap(threads_);
    if (drain == Drain::kDiscard) {
      dropped = queue_.size();
      queue_.swap(discarded);
    }
  }
  wake_.notify_all();
  for (std::thread& thread : threads) thread.join();
  return dropped;
}

std::size_t Executor::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

std::size_t Executor::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

}  // namespace moduli
