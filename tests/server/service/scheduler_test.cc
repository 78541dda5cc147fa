#include "server/service/scheduler.h"

#include <atomic>
#include <condition_variable>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/core/testing.h"

namespace moduli {
namespace {

/// Keeps tasks waiting until it is opened.
class Gate {
 public:
  void open() { promise_.set_value(); }
  void pass() const { future_.wait(); }

 private:
  std::promise<void> promise_;
  std::shared_future<void> future_ = promise_.get_future().share();
};

TEST(Scheduler, InteractiveWorkIsRefusedWhenTheQueueIsFull) {
  Scheduler scheduler({.threads = 1, .queue_limit = 1});
  Gate gate;
  std::promise<void> started;
  ASSERT_OK(scheduler.submit([&] {
    started.set_value();
    gate.pass();
  }));
  started.get_future().wait();
  EXPECT_OK(scheduler.submit([] {}));
  EXPECT_THAT(scheduler.submit([] {}), FailsWith(Reason::kQueueFull));
  gate.open();
  scheduler.shutdown();
  EXPECT_THAT(scheduler.submit([] {}), FailsWith(Reason::kServerDraining));
}

TEST(Scheduler, BulkWorkBeyondTheQueueIsAllDoneInOrder) {
  Scheduler scheduler({.threads = 1, .queue_limit = 1});
  constexpr int kTasks = 1000;
  std::vector<int> order;
  std::promise<void> all;
  for (int i = 0; i < kTasks; ++i) {
    scheduler.submitWhenRoom([&, i] {
      order.push_back(i);
      if (i + 1 == kTasks) all.set_value();
    });
  }
  all.get_future().wait();
  scheduler.shutdown();
  ASSERT_EQ(order.size(), static_cast<std::size_t>(kTasks));
  for (int i = 0; i < kTasks; ++i) ASSERT_EQ(order[static_cast<std::size_t>(i)], i);
}

TEST(Scheduler, BulkWorkWaitsThroughAQueueFullOfInteractiveWork) {
  Scheduler scheduler({.threads = 1, .queue_limit = 2});
  Gate gate;
  std::promise<void> started, bulk_done;
  ASSERT_OK(scheduler.submit([&] {
    started.set_value();
    gate.pass();
  }));
  started.get_future().wait();
  std::atomic<int> interactive = 0;
  int seen_by_bulk = -1;
  ASSERT_OK(scheduler.submit([&] { ++interactive; }));
  ASSERT_OK(scheduler.submit([&] { ++interactive; }));
  scheduler.submitWhenRoom([&] {
    seen_by_bulk = interactive;
    bulk_done.set_value();
  });
  gate.open();
  bulk_done.get_future().wait();
  scheduler.shutdown();
  EXPECT_EQ(seen_by_bulk, 2) << "interactive work comes first";
}

TEST(Scheduler, InteractiveWorkOvertakesBulkWork) {
  Scheduler scheduler({.threads = 1, .queue_limit = 8});
  Gate gate;
  std::promise<void> started, last_done;
  std::string order;
  scheduler.submitWhenRoom([&] {
    started.set_value();
    gate.pass();
  });
  started.get_future().wait();
  scheduler.submitWhenRoom([&] { order += 'b'; });
  scheduler.submitWhenRoom([&] {
    order += 'b';
    last_done.set_value();
  });
  ASSERT_OK(scheduler.submit([&] { order += 'i'; }));
  gate.open();
  last_done.get_future().wait();
  scheduler.shutdown();
  EXPECT_EQ(order, "ibb");
}

TEST(Scheduler, BulkWorkNeverFillsTheQueue) {
  Scheduler scheduler({.threads = 1, .queue_limit = 2});
  Gate gate;
  std::promise<void> started;
  scheduler.submitWhenRoom([&] {
    started.set_value();
    gate.pass();
  });
  started.get_future().wait();
  for (int i = 0; i < 100; ++i) scheduler.submitWhenRoom([] {});
  EXPECT_OK(scheduler.submit([] {}));
  gate.open();
  scheduler.shutdown();
}

TEST(Scheduler, ShutdownDropsWhatWaitsBeforeTheDoor) {
  Scheduler scheduler({.threads = 1, .queue_limit = 1});
  Gate gate;
  std::promise<void> started;
  const auto kept = std::make_shared<int>(0);
  scheduler.submitWhenRoom([&] {
    started.set_value();
    gate.pass();
  });
  started.get_future().wait();
  for (int i = 0; i < 10; ++i) scheduler.submitWhenRoom([kept] {});
  std::thread opener([&] { gate.open(); });
  scheduler.shutdown();
  opener.join();
  EXPECT_EQ(kept.use_count(), 1) << "dropped tasks let go of what they hold";
}

}  // namespace
}  // namespace moduli
