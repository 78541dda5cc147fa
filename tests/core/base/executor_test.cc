#include "core/base/executor.h"

#include <atomic>
#include <future>
#include <mutex>
#include <vector>

#include "tests/core/testing.h"

namespace moduli {
namespace {

// Occupies one thread of an executor until it is opened.
class Gate {
 public:
  Executor::Task task() {
    return [this] {
      entered_.set_value();
      open_.get_future().wait();
    };
  }
  void waitUntilEntered() { entered_.get_future().wait(); }
  void open() { open_.set_value(); }

 private:
  std::promise<void> entered_, open_;
};

TEST(Executor, RunsEveryAcceptedTaskOnce) {
  std::atomic<int> runs{0};
  Executor executor({.threads = 4, .queue_limit = 10000});
  for (int i = 0; i < 5000; ++i) ASSERT_OK(executor.submit(Priority::kBulk, [&] { ++runs; }));
  EXPECT_EQ(executor.shutdown(Executor::Drain::kFinish), 0U);
  EXPECT_EQ(runs, 5000);
}

TEST(Executor, InteractiveWorkOvertakesBulkWorkThatWaits) {
  Gate gate;  // Outlives the threads that use it.
  Executor executor({.threads = 1, .queue_limit = 10});
  ASSERT_OK(executor.submit(Priority::kBulk, gate.task()));
  gate.waitUntilEntered();
  std::vector<int> order;
  ASSERT_OK(executor.submit(Priority::kBulk, [&] { order.push_back(3); }));
  ASSERT_OK(executor.submit(Priority::kBulk, [&] { order.push_back(4); }));
  ASSERT_OK(executor.submit(Priority::kInteractive, [&] { order.push_back(1); }));
  ASSERT_OK(executor.submit(Priority::kInteractive, [&] { order.push_back(2); }));
  gate.open();
  executor.shutdown(Executor::Drain::kFinish);
  EXPECT_THAT(order, testing::ElementsAre(1, 2, 3, 4));
}

TEST(Executor, AFullQueueRefusesAtOnce) {
  Gate gate;
  Executor executor({.threads = 1, .queue_limit = 2});
  ASSERT_OK(executor.submit(Priority::kBulk, gate.task()));
  gate.waitUntilEntered();
  EXPECT_EQ(executor.running(), 1U);
  ASSERT_OK(executor.submit(Priority::kBulk, [] {}));
  ASSERT_OK(executor.submit(Priority::kBulk, [] {}));
  EXPECT_EQ(executor.waiting(), 2U);
  EXPECT_THAT(executor.submit(Priority::kInteractive, [] {}), FailsWith(Reason::kQueueFull));
  gate.open();
}

TEST(Executor, ShutdownRefusesNewWorkAndDropsWhatWaitsIfTold) {
  Gate gate;
  std::atomic<int> runs{0};
  Executor executor({.threads = 1, .queue_limit = 10});
  ASSERT_OK(executor.submit(Priority::kBulk, gate.task()));
  gate.waitUntilEntered();
  for (int i = 0; i < 3; ++i) ASSERT_OK(executor.submit(Priority::kBulk, [&] { ++runs; }));
  // Discarding takes effect before the running task ends, so the gate opens from another thread.
  std::future<std::size_t> dropped =
      std::async(std::launch::async, [&] { return executor.shutdown(Executor::Drain::kDiscard); });
  while (executor.waiting() > 0) std::this_thread::yield();
  EXPECT_THAT(executor.submit(Priority::kBulk, [] {}), FailsWith(Reason::kServerDraining));
  gate.open();
  EXPECT_EQ(dropped.get(), 3U);
  EXPECT_EQ(runs, 0);
}

TEST(Executor, TakesWorkFromManyThreads) {
  std::atomic<int> runs{0}, accepted{0};
  {
    Executor executor({.threads = 3, .queue_limit = 50});
    std::vector<std::thread> senders;
    for (int s = 0; s < 4; ++s) {
      senders.emplace_back([&] {
        for (int i = 0; i < 1000; ++i) {
          if (executor
                  .submit(i % 2 == 0 ? Priority::kBulk : Priority::kInteractive, [&] { ++runs; })
                  .ok()) {
            ++accepted;
          }
        }
      });
    }
    for (std::thread& sender : senders) sender.join();
  }
  EXPECT_EQ(runs, accepted);
  EXPECT_GE(accepted, 50);
}

TEST(Executor, ATaskReleasesWhatItHoldsBeforeItCountsAsDone) {
  Executor executor({.threads = 1, .queue_limit = 4});
  auto held = std::make_shared<int>(1);
  const std::weak_ptr<int> watch = held;
  ASSERT_OK(executor.submit(Priority::kBulk, [held = std::move(held)] {}));
  executor.shutdown(Executor::Drain::kFinish);
  EXPECT_TRUE(watch.expired());
}

}  // namespace
}  // namespace moduli
