#include "server/service/call_registry.h"

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "tests/core/testing.h"

namespace moduli {
namespace {

using Clock = std::chrono::steady_clock;

class FakeCall : public LiveCall {
 public:
  void stop(const Status& why) override { stopped = why.reason(); }
  void drain() override { ++drains; }

  Reason stopped = Reason::kOk;
  int drains = 0;
};

TEST(CallRegistry, ItIsEmptyWhenTheLastTicketIsGone) {
  CallRegistry registry;
  EXPECT_TRUE(registry.waitUntilEmpty(Clock::now()));
  const auto call = std::make_shared<FakeCall>();
  {
    auto first = registry.enter(call);
    auto second = registry.enter(call);
    ASSERT_OK(first);
    ASSERT_OK(second);
    const CallRegistry::Ticket moved = *std::move(first);
    EXPECT_EQ(registry.size(), 2U);
    EXPECT_FALSE(registry.waitUntilEmpty(Clock::now()));
  }
  EXPECT_TRUE(registry.waitUntilEmpty(Clock::now()));
}

TEST(CallRegistry, ClosingRefusesNewCallsAndDrainsTheOthersOnce) {
  CallRegistry registry;
  const auto call = std::make_shared<FakeCall>();
  const auto ticket = registry.enter(call);
  registry.close();
  registry.close();
  EXPECT_EQ(call->drains, 1);
  EXPECT_THAT(registry.enter(call), FailsWith(Reason::kServerDraining));
}

TEST(CallRegistry, StoppingReachesLivingCallsOnly) {
  CallRegistry registry;
  const auto living = std::make_shared<FakeCall>();
  auto gone = std::make_shared<FakeCall>();
  const auto first = registry.enter(living);
  const auto second = registry.enter(gone);
  gone.reset();
  registry.stopAll({Reason::kCancelled, "enough"});
  EXPECT_EQ(living->stopped, Reason::kCancelled);
}

TEST(CallRegistry, ATicketMayOutliveTheRegistry) {
  CallRegistry::Ticket ticket;
  {
    CallRegistry registry;
    auto entered = registry.enter(std::make_shared<FakeCall>());
    ASSERT_OK(entered);
    ticket = *std::move(entered);
  }
  ticket = {};
}

TEST(CallRegistry, ManyThreadsComeAndGoUntilItCloses) {
  CallRegistry registry;
  std::atomic<int> inside = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (;;) {
        auto ticket = registry.enter(std::make_shared<FakeCall>());
        if (!ticket.ok()) return;
        ++inside;
        --inside;
      }
    });
  }
  registry.stopAll({Reason::kCancelled, "enough"});
  registry.close();
  EXPECT_TRUE(registry.waitUntilEmpty(Clock::now() + std::chrono::seconds(20)));
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(inside, 0);
}

}  // namespace
}  // namespace moduli
