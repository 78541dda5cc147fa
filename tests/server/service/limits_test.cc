#include <optional>
#include <thread>

#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// One computing thread and one place in the queue.
class LimitsTest : public ServiceTest {
 protected:
  void configure(ServerOptions& options) override {
    options.threads = 1;
    options.queue_limit = 1;
  }

  void SetUp() override {
    ServiceTest::SetUp();
    const auto digest = peer_->upload(largeMesh());
    ASSERT_OK(digest);
    large_ = digestSource(*digest);
  }

  /// A call under way that computes for seconds.
  struct Running {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::ComputeSignatureResponse>> reader;

    /// Reads on to a stage other than "queued"; false if the call ends before.
    bool waitUntilComputing() {
      v1::ComputeSignatureResponse event;
      while (reader->Read(&event)) {
        if (event.has_progress() && event.progress().stage() != "queued") return true;
      }
      return false;
    }
    Status end() {
      v1::ComputeSignatureResponse event;
      while (reader->Read(&event)) {
      }
      return fromGrpcStatus(reader->Finish());
    }
  };

  std::unique_ptr<Running> start(const v1::MeshSource& source,
                                 std::optional<milliseconds> deadline = {}) {
    auto running = std::make_unique<Running>();
    if (deadline) running->context.set_deadline(std::chrono::system_clock::now() + *deadline);
    v1::ComputeSignatureRequest request;
    *request.mutable_source() = source;
    running->reader = peer_->geometry().ComputeSignature(&running->context, request);
    return running;
  }

  /// A call that needs a computing thread is answered with success, so that the one thread is free.
  bool computingThreadIsFree() {
    return eventually([&] { return peer_->sign(inlineSource(smallMesh(1))).ok(); },
                      std::chrono::seconds(10));
  }

  v1::MeshSource large_;
};

// A loaded test machine may let a thread wait this long; the promise itself is 100 ms.
constexpr milliseconds kSlack(400);

TEST_F(LimitsTest, ADeadlineIsAnsweredInTimeAndStopsTheSolver) {
  const auto begin = Clock::now();
  const auto call = start(large_, milliseconds(300));
  EXPECT_THAT(call->end(), FailsWith(Reason::kDeadlineExceeded));
  EXPECT_LT(Clock::now() - begin, milliseconds(300 + 100) + kSlack);
  EXPECT_TRUE(computingThreadIsFree());
}

TEST_F(LimitsTest, CancellationIsAnsweredInTimeAndStopsTheSolver) {
  const auto call = start(large_);
  ASSERT_TRUE(call->waitUntilComputing());
  const auto begin = Clock::now();
  call->context.TryCancel();
  EXPECT_THAT(call->end(), FailsWith(Reason::kCancelled));
  EXPECT_LT(Clock::now() - begin, milliseconds(100) + kSlack);
  EXPECT_TRUE(computingThreadIsFree());
}

TEST_F(LimitsTest, AFullQueueRefusesAtOnceAndSaysWhenToRetry) {
  const auto computing = start(large_);
  ASSERT_TRUE(computing->waitUntilComputing());
  const auto waiting = start(large_);
  v1::ComputeSignatureResponse queued;
  ASSERT_TRUE(waiting->reader->Read(&queued));
  EXPECT_EQ(queued.progress().stage(), "queued");

  // "queued" is sent before the place is taken, so the refusal may need a second look.
  grpc::Status refusal;
  const auto begin = Clock::now();
  ASSERT_TRUE(eventually([&] {
    const auto refused = start(inlineSource(smallMesh(1)), milliseconds(200));
    v1::ComputeSignatureResponse event;
    while (refused->reader->Read(&event)) {
    }
    refusal = refused->reader->Finish();
    return refusal.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED;
  }));
  EXPECT_LT(Clock::now() - begin, milliseconds(300) + kSlack);
  EXPECT_THAT(fromGrpcStatus(refusal), FailsWith(Reason::kQueueFull));
  EXPECT_GT(retryDelay(refusal).count(), 0);
  computing->context.TryCancel();
  waiting->context.TryCancel();
  EXPECT_THAT(computing->end(), FailsWith(Reason::kCancelled));
  EXPECT_THAT(waiting->end(), FailsWith(Reason::kCancelled));
  EXPECT_TRUE(computingThreadIsFree());
}

TEST_F(LimitsTest, ADeadlineThatPassesInTheQueueIsAnsweredWithoutRunning) {
  const auto computing = start(large_);
  ASSERT_TRUE(computing->waitUntilComputing());
  const auto begin = Clock::now();
  const auto waiting = start(inlineSource(smallMesh(1)), milliseconds(200));
  EXPECT_THAT(waiting->end(), FailsWith(Reason::kDeadlineExceeded));
  EXPECT_LT(Clock::now() - begin, milliseconds(300) + kSlack);
  computing->context.TryCancel();
  EXPECT_THAT(computing->end(), FailsWith(Reason::kCancelled));
}

TEST_F(LimitsTest, HealthAndCatalogueAnswerWhileEveryComputingThreadIsBusy) {
  const auto computing = start(large_);
  ASSERT_TRUE(computing->waitUntilComputing());
  const auto waiting = start(large_);
  for (const char* service :
       {"", "moduli.v1.GeometryService", "moduli.v1.CatalogService", "moduli.v1.OptimizeService"}) {
    const auto healthy = peer_->healthy(service, milliseconds(100) + kSlack);
    ASSERT_OK(healthy);
    EXPECT_TRUE(*healthy) << service;
  }
  EXPECT_OK(peer_->createCollection("c"));
  EXPECT_OK(peer_->listShapes("c"));
  computing->context.TryCancel();
  waiting->context.TryCancel();
  EXPECT_THAT(computing->end(), FailsWith(Reason::kCancelled));
  EXPECT_THAT(waiting->end(), FailsWith(Reason::kCancelled));
}

TEST_F(LimitsTest, IngestWaitsWhereInteractiveWorkIsRefused) {
  const auto computing = start(large_);
  ASSERT_TRUE(computing->waitUntilComputing());
  const auto waiting = start(large_);
  std::vector<v1::IngestShapesRequest::Item> items;
  for (int i = 0; i < 20; ++i) {
    items.push_back(ingestItemOf(i, numbered("s", i), smallMesh(i)));
  }
  std::thread canceller([&] {
    // When the collection is there, the stream is open and its items wait.
    eventually([&] { return peer_->listShapes("c").ok(); });
    computing->context.TryCancel();
    waiting->context.TryCancel();
  });
  const auto outcomes = peer_->ingest(ingestHeader("c"), items);
  canceller.join();
  ASSERT_OK(outcomes);
  EXPECT_EQ(outcomes->size(), 20U);
  for (const auto& [index, outcome] : *outcomes) {
    EXPECT_EQ(outcome.outcome(), v1::IngestShapesResponse::ADDED) << outcome.message();
  }
  EXPECT_THAT(computing->end(), FailsWith(Reason::kCancelled));
  EXPECT_THAT(waiting->end(), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
