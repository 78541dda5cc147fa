#include <atomic>
#include <set>
#include <thread>

#include "server/service/backend.h"
#include "server/store/store.h"
#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

using Outcome = v1::IngestShapesResponse;
using Request = v1::IngestShapesRequest;

class IngestTest : public ServiceTest {
 protected:
  Outcome one(const Request::Header& header, const Request::Item& item) {
    const auto outcomes = peer_->ingest(header, {item});
    EXPECT_OK(outcomes);
    if (!outcomes.ok() || !outcomes->contains(item.index())) return {};
    return outcomes->at(item.index());
  }
};

TEST_F(IngestTest, EveryItemGetsItsOutcome) {
  std::vector<Request::Item> items;
  for (int i = 0; i < 30; ++i) {
    items.push_back(ingestItemOf(i, numbered("s", i), smallMesh(i)));
  }
  const auto outcomes = peer_->ingest(ingestHeader("c"), items);
  ASSERT_OK(outcomes);
  ASSERT_EQ(outcomes->size(), 30U);
  for (const auto& [index, outcome] : *outcomes) {
    EXPECT_EQ(outcome.outcome(), Outcome::ADDED) << outcome.message();
    EXPECT_EQ(outcome.name(), numbered("collections/c/shapes/s", index));
  }
  EXPECT_EQ(peer_->listShapes("c")->size(), 30U);
}

TEST_F(IngestTest, AFailedItemStopsNoOther) {
  auto bad_name = ingestItemOf(1, "a/b", smallMesh(1));
  auto bad_mesh = ingestItemOf(2, "broken", "OFF\n3 1 0\n0 0 0\n");
  auto no_source = ingestItemOf(3, "nothing", "");
  no_source.clear_source();
  auto not_uploaded = ingestItemOf(4, "lost", "");
  *not_uploaded.mutable_source() = digestSource(sha256Hex("never sent"));
  const auto outcomes = peer_->ingest(
      ingestHeader("c"), {ingestItemOf(0, "good", smallMesh(0)), bad_name, bad_mesh, no_source,
                          not_uploaded, ingestItemOf(5, "fine", smallMesh(5))});
  ASSERT_OK(outcomes);
  EXPECT_EQ(outcomes->at(0).outcome(), Outcome::ADDED);
  EXPECT_EQ(outcomes->at(1).reason(), "INVALID_NAME");
  EXPECT_EQ(outcomes->at(2).reason(), "TRUNCATED_FILE");
  EXPECT_THAT(outcomes->at(2).message(), testing::HasSubstr("broken.off"));
  EXPECT_FALSE(outcomes->at(2).hint().empty());
  EXPECT_EQ(outcomes->at(3).reason(), "INVALID_REQUEST");
  EXPECT_EQ(outcomes->at(4).reason(), "UPLOAD_NOT_FOUND");
  EXPECT_EQ(outcomes->at(5).outcome(), Outcome::ADDED);
  for (int i = 1; i < 5; ++i) EXPECT_EQ(outcomes->at(i).outcome(), Outcome::FAILED);
  EXPECT_EQ(peer_->listShapes("c")->size(), 2U);
}

TEST_F(IngestTest, WhatHappensToAnExistingNameIsTheCallersChoice) {
  ASSERT_EQ(one(ingestHeader("c"), ingestItemOf(0, "s", smallMesh(1))).outcome(), Outcome::ADDED);
  for (const auto on_exists : {Request::SKIP, Request::REPLACE, Request::ERROR}) {
    EXPECT_EQ(one(ingestHeader("c", on_exists), ingestItemOf(0, "s", smallMesh(1))).outcome(),
              Outcome::SKIPPED)
        << "the same file is always skipped";
  }
  const auto other = ingestItemOf(0, "s", smallMesh(2));
  EXPECT_EQ(one(ingestHeader("c", Request::SKIP), other).outcome(), Outcome::SKIPPED);
  const Outcome error = one(ingestHeader("c", Request::ERROR), other);
  EXPECT_EQ(error.outcome(), Outcome::FAILED);
  EXPECT_EQ(error.reason(), "SHAPE_EXISTS");
  EXPECT_EQ(peer_->getShape("collections/c/shapes/s")->digest(), sha256Hex(smallMesh(1)));
  EXPECT_EQ(one(ingestHeader("c", Request::REPLACE), other).outcome(), Outcome::REPLACED);
  EXPECT_EQ(peer_->getShape("collections/c/shapes/s")->digest(), sha256Hex(smallMesh(2)));
}

TEST_F(IngestTest, AProbeTellsWhetherTheMeshHasToBeSent) {
  ASSERT_EQ(one(ingestHeader("c"), ingestItemOf(0, "s", smallMesh(1))).outcome(), Outcome::ADDED);
  const auto same = probeItemOf(0, "s", smallMesh(1));
  const auto other = probeItemOf(0, "s", smallMesh(2));
  const auto unknown = probeItemOf(0, "t", smallMesh(1));
  EXPECT_EQ(one(ingestHeader("c"), same).outcome(), Outcome::SKIPPED);
  EXPECT_EQ(one(ingestHeader("c"), unknown).outcome(), Outcome::MISSING);
  EXPECT_EQ(one(ingestHeader("c", Request::SKIP), other).outcome(), Outcome::SKIPPED);
  EXPECT_EQ(one(ingestHeader("c", Request::REPLACE), other).outcome(), Outcome::MISSING);
  EXPECT_EQ(one(ingestHeader("c", Request::ERROR), other).reason(), "SHAPE_EXISTS");
  auto bad_digest = same;
  bad_digest.set_probe_digest("12");
  EXPECT_EQ(one(ingestHeader("c"), bad_digest).reason(), "INVALID_REQUEST");
}

TEST_F(IngestTest, TwoItemsOfOneNameLeaveOneShape) {
  std::vector<Request::Item> items;
  for (int i = 0; i < 16; ++i) items.push_back(ingestItemOf(i, "s", smallMesh(i)));
  const auto outcomes = peer_->ingest(ingestHeader("c"), items);
  ASSERT_OK(outcomes);
  int added = 0;
  for (const auto& [index, outcome] : *outcomes) added += outcome.outcome() == Outcome::ADDED;
  EXPECT_EQ(added, 1);
  EXPECT_EQ(peer_->listShapes("c")->size(), 1U);
}

TEST_F(IngestTest, ADrillWithoutAHeaderOrCollectionIsRefused) {
  grpc::ClientContext context;
  const auto stream = peer_->catalog().IngestShapes(&context);
  Request request;
  *request.mutable_item() = ingestItemOf(0, "s", smallMesh(0));
  stream->Write(request);
  EXPECT_THAT(fromGrpcStatus(stream->Finish()), FailsWith(Reason::kInvalidRequest));

  auto header = ingestHeader("none");
  header.set_create_collection(false);
  EXPECT_THAT(peer_->ingest(header, {}), FailsWith(Reason::kCollectionNotFound));
  header.set_parent("none");
  EXPECT_THAT(peer_->ingest(header, {}), FailsWith(Reason::kInvalidName));
  header = ingestHeader("c");
  header.mutable_prepare()->set_component("biggest");
  EXPECT_THAT(peer_->ingest(header, {}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(peer_->listShapes("c"), FailsWith(Reason::kCollectionNotFound));
}

TEST_F(IngestTest, NothingSentMakesAnEmptyCollection) {
  const auto outcomes = peer_->ingest(ingestHeader("c"), {});
  ASSERT_OK(outcomes);
  EXPECT_TRUE(outcomes->empty());
  EXPECT_EQ(peer_->listShapes("c")->size(), 0U);
}

TEST_F(IngestTest, AFastSenderIsSlowedDownWhenNobodyReadsOutcomes) {
  grpc::ClientContext context;
  const auto stream = peer_->catalog().IngestShapes(&context);
  constexpr int kItems = 50;
  std::atomic<int> sent = 0;
  // 1 MiB each, so that what gRPC's own windows swallow is a small part of the whole.
  const std::string padding = std::string("\n#").append(1 << 20, ' ');
  std::thread sender([&] {
    Request request;
    *request.mutable_header() = ingestHeader("c");
    stream->Write(request);
    for (int i = 0; i < kItems; ++i) {
      *request.mutable_item() = ingestItemOf(i, numbered("s", i), smallMesh(i) + padding);
      if (!stream->Write(request)) return;
      ++sent;
    }
    stream->WritesDone();
  });
  // Nobody reads meanwhile. The few outcomes fit into the way back, so that all items get stored in
  // the end, but the sender is never far ahead of the store.
  const auto stored = [&] {
    const auto shapes = peer_->listShapes("c");
    return shapes.ok() ? static_cast<int>(shapes->size()) : 0;
  };
  int largest_lead = 0;
  while (sent < kItems) {
    const int sent_now = sent;
    largest_lead = std::max(largest_lead, sent_now - stored());
  }
  // A sender that nothing slows down has sent all of them before the store has the fifth. gRPC's
  // windows grow with the time that answers take, up to half of all on a machine that is busy.
  EXPECT_LT(largest_lead, 40) << "items were buffered without bound";
  std::set<int> answered;
  for (Outcome outcome; stream->Read(&outcome);) answered.insert(outcome.index());
  sender.join();
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(answered.size(), static_cast<std::size_t>(kItems));
}

TEST_F(IngestTest, ACancelledStreamStoresWholeShapesOnlyAndGoesOnLater) {
  std::vector<Request::Item> items;
  for (int i = 0; i < 30; ++i) {
    items.push_back(ingestItemOf(i, numbered("s", i), smallMesh(i)));
  }
  std::set<std::string> acknowledged;
  {
    grpc::ClientContext context;
    const auto stream = peer_->catalog().IngestShapes(&context);
    std::thread sender([&] {
      Request request;
      *request.mutable_header() = ingestHeader("c");
      stream->Write(request);
      for (const auto& item : items) {
        *request.mutable_item() = item;
        if (!stream->Write(request)) return;
      }
    });
    for (Outcome outcome; acknowledged.size() < 10 && stream->Read(&outcome);) {
      acknowledged.insert(outcome.name());
    }
    context.TryCancel();
    sender.join();
    for (Outcome outcome; stream->Read(&outcome);) {
    }
    EXPECT_THAT(fromGrpcStatus(stream->Finish()), FailsWith(Reason::kCancelled));
  }
  const auto shapes = peer_->listShapes("c");
  ASSERT_OK(shapes);
  EXPECT_LT(shapes->size(), 30U);
  std::set<std::string> stored;
  for (const v1::Shape& shape : *shapes) stored.insert(shape.name());
  for (const std::string& name : acknowledged) EXPECT_TRUE(stored.contains(name)) << name;
  const auto outcomes = peer_->ingest(ingestHeader("c"), items);
  ASSERT_OK(outcomes);
  std::size_t skipped = 0;
  for (const auto& [index, outcome] : *outcomes) skipped += outcome.outcome() == Outcome::SKIPPED;
  EXPECT_GE(skipped, acknowledged.size());
  EXPECT_EQ(peer_->listShapes("c")->size(), 30U);
}

TEST_F(IngestTest, SignaturesOfAnOldVersionAreMadeAnewFromTheStoredMeshes) {
  ASSERT_OK(peer_->ingest(ingestHeader("c"), {ingestItemOf(0, "old", smallMesh(0)),
                                              ingestItemOf(1, "new", smallMesh(50))}));
  const auto before = peer_->getShape("collections/c/shapes/old");
  ASSERT_OK(before);
  peer_.reset();
  server_.reset();
  {
    auto store = Store::open({.folder = options_.data_dir});
    ASSERT_OK(store);
    Catalog& catalog = *(*store)->catalog();
    auto record = catalog.getShape("c", "old", ShapeView::kFull);
    ASSERT_OK(record);
    record->descriptor_version = 0;
    record->vectors.shape = {1.0F};
    ASSERT_OK(catalog.putShape(*record, OnExists::kReplace));
  }
  restart();
  const auto current = [&] {
    v1::SearchShapesRequest request;
    request.set_parent("collections/c");
    request.set_shape("collections/c/shapes/new");
    const auto found = peer_->search(request);
    return found.ok() && found->hits_size() == 2;
  };
  EXPECT_TRUE(eventually(current)) << "the old shape is searched again once it is signed anew";
  const auto after = peer_->getShape("collections/c/shapes/old");
  ASSERT_OK(after);
  EXPECT_EQ(after->create_time().seconds(), before->create_time().seconds());
  auto expected = before->signature(), actual = after->signature();
  expected.clear_timing();
  actual.clear_timing();
  EXPECT_EQ(actual.SerializeAsString(), expected.SerializeAsString());
}

}  // namespace
}  // namespace moduli
