#include <signal.h>

#include <set>
#include <thread>

#include "tests/server/service/daemon_process.h"
#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

constexpr int kItems = 60;

std::string nameOf(int index) {
  return numbered("s", index);
}

/// Ingests everything and kills the server after `acknowledgements` outcomes. Returns the names
/// that were acknowledged, among them those whose outcomes were on their way.
std::set<std::string> ingestAndKill(DaemonProcess& daemon, Peer& peer,
                                    std::size_t acknowledgements) {
  grpc::ClientContext context;
  const auto stream = peer.catalog().IngestShapes(&context);
  std::thread sender([&] {
    v1::IngestShapesRequest request;
    *request.mutable_header() = ingestHeader("c");
    bool open = stream->Write(request);
    for (int i = 0; open && i < kItems; ++i) {
      *request.mutable_item() = ingestItemOf(i, nameOf(i), smallMesh(i));
      open = stream->Write(request);
    }
  });
  std::set<std::string> acknowledged;
  for (v1::IngestShapesResponse outcome; stream->Read(&outcome);) {
    EXPECT_EQ(outcome.outcome(), v1::IngestShapesResponse::ADDED) << outcome.message();
    acknowledged.insert(outcome.name());
    if (acknowledged.size() == acknowledgements) daemon.signal(SIGKILL);
  }
  sender.join();
  EXPECT_FALSE(stream->Finish().ok());
  return acknowledged;
}

/// Every acknowledged shape is there, and every shape that is there is whole.
void expectWholeStore(Peer& peer, const std::set<std::string>& acknowledged) {
  const auto shapes = peer.listShapes("c");
  ASSERT_OK(shapes);
  std::set<std::string> stored;
  for (const v1::Shape& summary : *shapes) stored.insert(summary.name());
  for (const std::string& name : acknowledged) EXPECT_TRUE(stored.contains(name)) << name;
  for (const std::string& name : stored) {
    const auto shape = peer.getShape(name);
    ASSERT_OK(shape);
    EXPECT_EQ(shape->signature().topology().faces(), 320);
    const auto bytes = peer.download(name);
    ASSERT_OK(bytes);
    EXPECT_EQ(sha256Hex(*bytes), shape->digest());
  }
  if (stored.empty()) return;
  v1::SearchShapesRequest request;
  request.set_parent("collections/c");
  request.set_shape(*stored.begin());
  request.set_k(1000);
  const auto found = peer.search(request);
  ASSERT_OK(found);
  EXPECT_EQ(static_cast<std::size_t>(found->hits_size()), stored.size());
}

TEST(KilledServer, KeepsEveryAcknowledgedShapeAndNoHalfOne) {
  for (const std::size_t acknowledgements : {std::size_t{1}, std::size_t{9}, std::size_t{30}}) {
    const TemporaryFolder folder;
    const std::vector<std::string> arguments = {"--listen", "127.0.0.1:0", "--data",
                                                folder.path() + "/store"};
    std::set<std::string> acknowledged;
    {
      DaemonProcess daemon(arguments);
      const std::string address = daemon.waitUntilListening();
      ASSERT_NE(address, "");
      Peer peer = Peer::at(address);
      acknowledged = ingestAndKill(daemon, peer, acknowledgements);
      EXPECT_EQ(daemon.wait(), -SIGKILL);
    }
    EXPECT_GE(acknowledged.size(), acknowledgements);
    EXPECT_LT(acknowledged.size(), static_cast<std::size_t>(kItems));

    DaemonProcess daemon(arguments);
    const std::string address = daemon.waitUntilListening();
    ASSERT_NE(address, "");
    Peer peer = Peer::at(address);
    expectWholeStore(peer, acknowledged);
    // The same ingest again does the rest.
    std::vector<v1::IngestShapesRequest::Item> items;
    for (int i = 0; i < kItems; ++i) items.push_back(ingestItemOf(i, nameOf(i), smallMesh(i)));
    const auto outcomes = peer.ingest(ingestHeader("c"), items);
    ASSERT_OK(outcomes);
    for (const auto& [index, outcome] : *outcomes) {
      const bool was_there = acknowledged.contains(outcome.name());
      if (was_there) {
        EXPECT_EQ(outcome.outcome(), v1::IngestShapesResponse::SKIPPED);
      }
      EXPECT_NE(outcome.outcome(), v1::IngestShapesResponse::FAILED) << outcome.message();
    }
    EXPECT_EQ(peer.listShapes("c")->size(), static_cast<std::size_t>(kItems));
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(), 0);
  }
}

}  // namespace
}  // namespace moduli
