#include "core/base/context.h"

#include <atomic>
#include <numeric>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/side_by_side.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(Context, WithoutLimitsNeverStopsTheWork) {
  const Context context;
  EXPECT_OK(context.check());
}

TEST(Context, ARaisedTokenStopsTheWorkInEveryCopy) {
  const CancelToken token;
  Context context;
  context.setCancelToken(token);
  EXPECT_OK(context.check());
  CancelToken copy = token;
  copy.cancel();
  EXPECT_THAT(context.check(), FailsWith(Reason::kCancelled));
}

TEST(Context, APassedDeadlineStopsTheWork) {
  Context context;
  context.setDeadline(Context::Clock::now() + std::chrono::hours(1));
  EXPECT_OK(context.check());
  context.setDeadline(Context::Clock::now());
  EXPECT_THAT(context.check(), FailsWith(Reason::kDeadlineExceeded));
}

TEST(Context, CancellationIsToldBeforeTheDeadline) {
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  context.setDeadline(Context::Clock::now());
  EXPECT_THAT(context.check(), FailsWith(Reason::kCancelled));
}

TEST(Context, StagesAreTimedAndReported) {
  std::vector<std::pair<std::string, double>> seen;
  Context context;
  context.setProgressSink(
      [&](const Progress& progress) { seen.emplace_back(progress.stage, progress.fraction); });
  {
    const Context::Stage stage(context, "factorize");
    context.report("factorize", 0.5);
  }
  { const Context::Stage again(context, "factorize"); }
  ASSERT_EQ(context.timing().size(), 1U);
  EXPECT_GE(context.timing().at("factorize"), 0.0);
  EXPECT_THAT(seen,
              testing::ElementsAre(testing::Pair("factorize", 0), testing::Pair("factorize", 0.5),
                                   testing::Pair("factorize", 1), testing::Pair("factorize", 0),
                                   testing::Pair("factorize", 1)));
}

TEST(SideBySide, WorksOnASilentCopyThatStopsWithIt) {
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  int reports = 0;
  context.setProgressSink([&](const Progress&) { ++reports; });
  Status first, second;
  sideBySide(
      context,
      [&](Context& own) {
        const Context::Stage stage(own, "work");
        token.cancel();
        first = own.check();
      },
      [&](Context& copy) {
        const Context::Stage stage(copy, "other work");
        while (copy.check().ok()) std::this_thread::yield();
        second = copy.check();
      });
  EXPECT_THAT(first, FailsWith(Reason::kCancelled));
  EXPECT_THAT(second, FailsWith(Reason::kCancelled));
  EXPECT_EQ(reports, 2);
  EXPECT_TRUE(context.timing().contains("work"));
  EXPECT_FALSE(context.timing().contains("other work"));
}

TEST(ParallelBlocks, CoverEveryElementOnce) {
  for (const std::size_t count : {0UL, 1UL, 7UL, 1000UL, 1001UL}) {
    std::vector<std::atomic<int>> visits(count);
    parallelBlocks(count, 10, [&](std::size_t begin, std::size_t end) {
      EXPECT_LE(end - begin, 10U);
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (const auto& visit : visits) EXPECT_EQ(visit, 1);
  }
}

}  // namespace
}  // namespace moduli
