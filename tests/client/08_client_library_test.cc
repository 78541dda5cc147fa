#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "client/cpp/client.h"
#include "client/cpp/connect.h"
#include "core/base/digest.h"
#include "tests/client/fake_server.h"
#include "tests/core/testing.h"

/// The client library against a scripted server: retries, resumed uploads, broken streams.
namespace moduli {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

std::unique_ptr<Client> clientOf(const FakeServer& server, ClientOptions options = {}) {
  auto channel = connectTo({.server = server.address()});
  EXPECT_OK(channel);
  return std::make_unique<Client>(*channel, options);
}

Status refused() {
  return {Reason::kQueueFull, "no room"};
}

TEST(ClientRetry, ARefusedCallIsTriedAgainNotBeforeTheServerSaidSo) {
  const FakeServer server({.refusals = {refused()}});
  const auto client = clientOf(server);
  const auto begin = Clock::now();
  const auto result = client->computeSignature({});
  ASSERT_OK(result);
  EXPECT_EQ(result->descriptor_version(), 7);
  EXPECT_EQ(server.record().signature_calls, 2);
  EXPECT_GE(Clock::now() - begin, std::chrono::seconds(1));  // The server's RetryInfo.
}

TEST(ClientRetry, WaitingEndsWithTheDeadline) {
  const FakeServer server({.refusals = std::vector<Status>(10, refused())});
  const auto begin = Clock::now();
  const auto client = clientOf(server, {.deadline = begin + milliseconds(500)});
  EXPECT_THAT(client->computeSignature({}), FailsWith(Reason::kQueueFull));
  EXPECT_EQ(server.record().signature_calls, 1);
  EXPECT_LT(Clock::now() - begin, milliseconds(1000));
}

TEST(ClientRetry, WhatCannotSucceedIsNotTriedAgain) {
  const FakeServer server({.refusals = {Status(Reason::kNonManifoldEdge, "edge 3", "mend it")}});
  const auto client = clientOf(server);
  const auto result = client->computeSignature({});
  EXPECT_THAT(result, FailsWith(Reason::kNonManifoldEdge));
  EXPECT_EQ(result.status().message(), "edge 3");
  EXPECT_EQ(result.status().hint(), "mend it");
  EXPECT_EQ(server.record().signature_calls, 1);
}

TEST(ClientCancel, EndsARunningCallAndRefusesLaterOnes) {
  const FakeServer server({.hang = true});
  const auto client = clientOf(server);
  std::thread other([&] {
    while (server.record().signature_calls == 0) std::this_thread::sleep_for(milliseconds(2));
    client->cancel();
  });
  EXPECT_THAT(client->computeSignature({}), FailsWith(Reason::kCancelled));
  other.join();
  EXPECT_THAT(client->computeSignature({}), FailsWith(Reason::kCancelled));
}

TEST(ClientProgress, IsToldWhileTheCallRuns) {
  const FakeServer server({});
  std::vector<std::string> stages;
  const auto client = clientOf(server, {.progress = [&](const v1::Progress& progress) {
                                 stages.push_back(progress.stage());
                               }});
  ASSERT_OK(client->computeSignature({}));
  EXPECT_THAT(stages, testing::ElementsAre("factorize"));
}

TEST(ClientUpload, ABrokenUploadGoesOnWhereItBroke) {
  constexpr std::size_t kMiB = 1 << 20;
  const FakeServer server({.break_upload_after = 2 * kMiB});
  const auto client = clientOf(server);
  std::string bytes(6 * kMiB + 5, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i >> 7);
  const auto source = client->sendMesh(MeshBytes::ofMemory(bytes), "large.off");
  ASSERT_OK(source);
  EXPECT_EQ(source->digest(), sha256Hex(bytes));
  const FakeRecord record = server.record();
  EXPECT_TRUE(record.uploaded == bytes);
  EXPECT_EQ(record.upload_bytes_sent, bytes.size());  // Not a byte was kept twice.
  EXPECT_THAT(record.upload_starts, testing::ElementsAre(0, 2 * kMiB));

  ASSERT_OK(client->sendMesh(MeshBytes::ofMemory(bytes), "large.off"));
  EXPECT_EQ(server.record().upload_starts.size(), 2U) << "what is there was sent again";
}

TEST(ClientUpload, ASmallMeshTravelsWithinTheRequest) {
  const FakeServer server({});
  const auto client = clientOf(server);
  const auto source = client->sendMesh(MeshBytes::ofMemory("OFF"), "a.off", v1::MeshSource::OFF);
  ASSERT_OK(source);
  EXPECT_EQ(source->inline_(), "OFF");
  EXPECT_EQ(source->file_name(), "a.off");
  EXPECT_TRUE(server.record().upload_starts.empty());
}

TEST(ClientIngest, ABrokenStreamLosesNothingAndStoresNothingTwice) {
  constexpr std::size_t kItems = 300;
  const FakeServer server({.break_ingest_after = 100});
  const auto client = clientOf(server);
  std::string folder = std::filesystem::temp_directory_path().string() + "/moduli_lib.XXXXXX";
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  for (std::size_t i = 0; i < kItems; ++i) {
    std::ofstream(folder + "/" + std::to_string(i)) << "mesh " << i;
  }
  IngestOptions options;
  options.jobs = 5;
  std::size_t next = 0;
  const IngestSource source = [&]() -> std::optional<IngestItem> {
    if (next == kItems) return std::nullopt;
    IngestItem item;
    item.order = next;
    item.path = folder + "/" + std::to_string(next);
    item.shape_id = "s" + std::to_string(next++);
    return item;
  };
  std::map<std::size_t, int> answers;
  const Status status =
      client->ingest(options, source,
                     [&](const IngestItem& item, const IngestOutcome&) { ++answers[item.order]; });
  std::filesystem::remove_all(folder);
  ASSERT_OK(status);
  EXPECT_EQ(answers.size(), kItems);
  for (const auto& [order, count] : answers) EXPECT_EQ(count, 1) << order;
  const FakeRecord record = server.record();
  EXPECT_EQ(record.ingest_streams, 2);
  EXPECT_EQ(record.stored.size(), kItems);
  for (const auto& [name, count] : record.stored) EXPECT_EQ(count, 1) << name;
}

}  // namespace
}  // namespace moduli
