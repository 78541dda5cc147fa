#include <cmath>
#include <limits>
#include <map>

#include "client/cpp/client.h"
#include "core/signature/distance.h"
#include "tests/server/service/search_fixture.h"

/// Many searches at once, collections of all sizes, and those that want a recall.
namespace moduli {
namespace {

using testing::HasSubstr;

TEST_F(SearchServiceTest, ManyQueriesAreAnsweredInOrderAndAsOne) {
  for (const auto space : {v1::Signature::SHAPE, v1::Signature::METRIC, v1::Signature::CONFORMAL}) {
    for (const char* filter : {"", "label = \"odd\""}) {
      auto request = batch(7);
      request.set_space(space);
      request.set_filter(filter);
      request.set_explain(true);
      for (int i = 0; i < kShapes; ++i) {
        const int number = (i * 77) % kShapes;
        if (i % 3 == 0) {
          *request.add_queries()->mutable_signature() = toProto(madeUp(number));
        } else {
          request.add_queries()->set_shape(numbered("collections/c/shapes/n", number));
        }
      }
      const auto results = peer_->searchMany(request);
      ASSERT_OK(results);
      ASSERT_EQ(results->size(), static_cast<std::size_t>(kShapes));
      for (int i = 0; i < kShapes; ++i) {
        const v1::QueryResult& result = (*results)[static_cast<std::size_t>(i)];
        auto one = query((i * 77) % kShapes, 7);
        one.set_space(space);
        one.set_filter(filter);
        one.set_explain(true);
        const auto single = peer_->search(one);
        ASSERT_OK(single);
        v1::SearchResult same;
        *same.mutable_hits() = result.hits();
        same.set_exact(result.exact());
        EXPECT_EQ(same.SerializeAsString(), single->SerializeAsString());
        EXPECT_EQ(result.query(), i % 3 == 0 ? "" : one.shape());
        EXPECT_FALSE(result.has_failure());
      }
    }
  }
}

// A search that kept less of a signature than its distance looks at would be wrong in silence.
TEST_F(SearchServiceTest, DistancesAreThoseOfWholeSignatures) {
  server_.reset();
  {
    const auto catalog = open(options_);
    ASSERT_OK(catalog->createCollection("pretzels", ""));
    for (int number = 0; number < 12; ++number) {
      ShapeRecord record = recordOf("pretzels", number);
      fillRecord({madeUpPretzel(number), {}}, record);
      ASSERT_OK(catalog->putShape(record, OnExists::kError));
    }
  }
  restart();
  for (const auto space : {Space::kConformal, Space::kMetric, Space::kShape}) {
    auto request = query(0, 100);
    request.set_parent("collections/pretzels");
    *request.mutable_signature() = toProto(madeUpPretzel(3));
    request.set_space(toProto(space));
    const auto found = peer_->search(request);
    ASSERT_OK(found);
    ASSERT_EQ(found->hits_size(), 12);
    for (const v1::SearchHit& hit : found->hits()) {
      const Signature other = madeUpPretzel(std::stoi(hit.name().substr(1)));
      EXPECT_EQ(hit.distance(), signatureDistance(madeUpPretzel(3), other, space));
    }
    auto many = batch(100);
    many.set_parent("collections/pretzels");
    many.set_space(toProto(space));
    many.add_queries()->set_shape("collections/pretzels/shapes/n3");
    const auto results = peer_->searchMany(many);
    ASSERT_OK(results);
    for (int i = 0; i < 12; ++i) {
      EXPECT_EQ(results->front().hits(i).SerializeAsString(), found->hits(i).SerializeAsString());
    }
  }
}

TEST_F(SearchServiceTest, AQueryThatFailsDoesNotStopTheOthers) {
  auto request = batch(3);
  request.add_queries()->set_shape("collections/c/shapes/nobody");
  request.add_queries()->set_shape("collections/c/shapes/n1");
  v1::Signature other = toProto(madeUp(2));
  other.set_descriptor_version(kDescriptorVersion + 1);
  *request.add_queries()->mutable_signature() = other;
  other = toProto(madeUp(2));
  other.mutable_vectors()->clear_shape();
  *request.add_queries()->mutable_signature() = other;
  other.mutable_vectors()->add_shape(1);
  *request.add_queries()->mutable_signature() = other;
  request.add_queries()->set_shape("collections/none/shapes/n1");
  *request.add_queries()->mutable_signature() = toProto(madeUp(2));
  const auto results = peer_->searchMany(request);
  ASSERT_OK(results);
  ASSERT_EQ(results->size(), 7U);
  const std::vector<std::string> reasons = {"SHAPE_NOT_FOUND",
                                            "",
                                            "INCOMPARABLE_SIGNATURES",
                                            "INCOMPARABLE_SIGNATURES",
                                            "INCOMPARABLE_SIGNATURES",
                                            "COLLECTION_NOT_FOUND",
                                            ""};
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    const v1::QueryResult& result = (*results)[i];
    EXPECT_EQ(result.failure().reason(), reasons[i]) << i;
    EXPECT_EQ(result.hits_size(), reasons[i].empty() ? 3 : 0);
    EXPECT_EQ(result.failure().message().empty(), reasons[i].empty());
  }
  EXPECT_THAT((*results)[4].failure().message(),
              HasSubstr("1 numbers of the asked space, not 251"));
}

TEST_F(SearchServiceTest, BatchesOfNothingTooMuchOrNonsenseAreRefused) {
  auto request = batch();
  expectBatchRefused(request, "queries", "nothing to search for");
  request.add_queries()->set_shape("collections/c/shapes/n1");
  request.add_queries();
  expectBatchRefused(request, "queries[1]", "empty");
  request.mutable_queries(1)->set_shape("n1");
  expectBatchRefused(request, "queries[1].shape", "not the name of a shape");
  v1::Signature broken = toProto(madeUp(0));
  broken.mutable_vectors()->set_shape(3, std::numeric_limits<float>::quiet_NaN());
  *request.mutable_queries(1)->mutable_signature() = broken;
  expectBatchRefused(request, "queries[1].signature", "not finite");
  request.mutable_queries(1)->set_shape("collections/c/shapes/n2");
  EXPECT_OK(peer_->searchMany(request));
  request.set_k(1001);
  expectBatchRefused(request, "k", "not in 1 to 1000");
  request.set_k(-1);
  expectBatchRefused(request, "k", "k is -1");
  request.set_k(1000);
  for (int i = 2; i < 1001; ++i) *request.add_queries() = request.queries(0);
  expectBatchRefused(request, "queries", "1001 queries of 1000 hits");
  request.set_k(1);
  EXPECT_EQ(peer_->searchMany(request)->size(), 1001U);
  for (int i = 1001; i < 10'001; ++i) *request.add_queries() = request.queries(0);
  expectBatchRefused(request, "queries", "10001 queries");
  request.mutable_queries()->DeleteSubrange(5, 9996);
  request.set_filter("colour = 3");
  expectBatchRefused(request, "filter", "column 1");
  request.clear_filter();
  request.set_space(static_cast<v1::Signature::Space>(9));
  expectBatchRefused(request, "space", "none of ours");
  request.clear_space();
  request.set_parent("collections/none");
  EXPECT_THAT(peer_->searchMany(request), FailsWith(Reason::kCollectionNotFound));
}

TEST_F(SearchServiceTest, ABatchEndsWithItsDeadline) {
  auto request = batch(100);
  for (int i = 0; i < 10'000; ++i) {
    request.add_queries()->set_shape(numbered("collections/c/shapes/n", i % kShapes));
  }
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(50));
  const auto reader = peer_->catalog().BatchSearchShapes(&context, request);
  v1::BatchSearchShapesResponse event;
  while (reader->Read(&event)) {
  }
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
}

TEST_F(SearchServiceTest, CollectionsOfNothingOneOrTheSameAreSearched) {
  server_.reset();
  {
    const auto catalog = open(options_);
    for (const char* name : {"none", "one", "same"}) ASSERT_OK(catalog->createCollection(name, ""));
    ASSERT_OK(catalog->putShape(recordOf("one", 0), OnExists::kError));
    for (int i = 0; i < 70; ++i) {
      ShapeRecord record = recordOf("same", 0);
      record.name = numbered("s", i);
      ASSERT_OK(catalog->putShape(record, OnExists::kError));
    }
  }
  restart();
  for (const auto space : {v1::Signature::SHAPE, v1::Signature::METRIC, v1::Signature::CONFORMAL}) {
    for (const auto& [name, count] :
         std::map<std::string, int>{{"none", 0}, {"one", 1}, {"same", 70}}) {
      auto one = query(0, 100);
      one.set_parent("collections/" + name);
      one.set_space(space);
      const auto found = peer_->search(one);
      ASSERT_OK(found);
      EXPECT_TRUE(found->exact());
      EXPECT_EQ(found->hits_size(), count) << name;
      auto many = batch(100);
      many.set_parent("collections/" + name);
      many.set_space(space);
      for (int i = 0; i < 70; ++i) many.add_queries()->set_shape(one.shape());
      const auto results = peer_->searchMany(many);
      ASSERT_OK(results);
      EXPECT_EQ(results->back().hits_size(), count);
      if (count > 0) {
        EXPECT_EQ(paged(one, 9).SerializeAsString(), found->SerializeAsString());
      }
    }
  }
}

TEST_F(SearchServiceTest, ALargeCollectionThatWantsARecallIsSearchedApproximately) {
  fillLarge(0.9);
  auto request = query(17);
  request.set_parent("collections/large");
  const auto found = peer_->search(request);
  ASSERT_OK(found);
  EXPECT_FALSE(found->exact());
  EXPECT_GE(found->recall(), 0.9);
  EXPECT_EQ(found->hits(0).distance(), 0);
  const auto shown = get("collections/large");
  ASSERT_OK(shown);
  EXPECT_EQ(shown->wanted_recall(), 0.9);
  EXPECT_GE(shown->recall(), 0.9);
  EXPECT_EQ(paged(request, 3).hits_size(), 10);
  auto many = batch();
  many.set_parent("collections/large");
  many.add_queries()->set_shape(request.shape());
  const auto results = peer_->searchMany(many);
  ASSERT_OK(results);
  EXPECT_FALSE(results->front().exact());
  EXPECT_EQ(results->front().recall(), found->recall());

  request.set_filter("label = \"odd\"");
  EXPECT_TRUE(peer_->search(request)->exact());
  EXPECT_FALSE(peer_->search(request)->has_recall());
  request.clear_filter();
  request.set_space(v1::Signature::CONFORMAL);
  EXPECT_TRUE(peer_->search(request)->exact());
  request.clear_space();
  EXPECT_TRUE(peer_->search(query(17))->exact()) << "of the other collection";

  const auto updated = update("collections/large", {});
  ASSERT_OK(updated);
  EXPECT_FALSE(updated->has_wanted_recall());
  EXPECT_TRUE(eventually([&] { return peer_->search(request)->exact(); }));
  EXPECT_FALSE(get("collections/large")->has_recall());
}

TEST_F(SearchServiceTest, TheClientCollectsAllPagesAndSplitsLargeBatches) {
  fillLarge({});
  Client client(server_->inProcessChannel());
  auto request = query(17, 2500);
  request.set_parent("collections/large");
  const auto all = client.search(request);
  ASSERT_OK(all);
  EXPECT_TRUE(all->exact());
  EXPECT_EQ(all->hits_size(), 2500);
  EXPECT_EQ(all->SerializeAsString(), paged(request, 999).SerializeAsString());
  request.set_k(1'000'000);
  EXPECT_EQ(client.search(request)->hits_size(), kMany);
  // A mesh, which is signed once.
  *request.mutable_source() = inlineSource(sampleFile("torus", {{"resolution", 8}}));
  const auto of_mesh = client.search(request);
  ASSERT_OK(of_mesh);
  EXPECT_EQ(of_mesh->hits_size(), kMany);
  request.set_k(10);
  EXPECT_EQ(client.search(request)->hits(9).SerializeAsString(),
            of_mesh->hits(9).SerializeAsString());

  auto many = batch(1);
  for (int i = 0; i < 10'500; ++i) {
    many.add_queries()->set_shape(numbered("collections/c/shapes/n", i % (kShapes + 1)));
  }
  const auto results = client.searchMany(many);
  ASSERT_OK(results);
  ASSERT_EQ(results->size(), 10'500U);
  for (std::size_t i = 0; i < results->size(); ++i) {
    EXPECT_EQ((*results)[i].query(), many.queries(static_cast<int>(i)).shape());
    EXPECT_EQ((*results)[i].has_failure(), i % (kShapes + 1) == kShapes);
  }
  many.clear_queries();
  EXPECT_TRUE(client.searchMany(many)->empty());
}

TEST_F(SearchServiceTest, RecallsThatMakeNoSenseAreRefused) {
  for (const double bad : {0.0, 1.0, -0.5, 7.0, std::nan("")}) {
    v1::CreateCollectionRequest create;
    create.set_collection_id("bad");
    create.set_wanted_recall(bad);
    grpc::ClientContext context;
    v1::Collection response;
    const auto status = peer_->catalog().CreateCollection(&context, create, &response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_details(), HasSubstr("wanted_recall"));
    EXPECT_THAT(update("collections/c", bad), FailsWith(Reason::kInvalidOption));
  }
  EXPECT_THAT(update("collections/c", 0.5, "name"), FailsWith(Reason::kInvalidRequest));
  EXPECT_THAT(update("collections/none", 0.5), FailsWith(Reason::kCollectionNotFound));
  EXPECT_THAT(update("c", 0.5), FailsWith(Reason::kInvalidName));
  const auto updated = update("collections/c", 0.5);
  ASSERT_OK(updated);
  EXPECT_EQ(updated->wanted_recall(), 0.5);
  EXPECT_EQ(updated->shape_count(), kShapes);
  EXPECT_TRUE(peer_->search(query(1))->exact()) << "it is small";
  restart();
  EXPECT_EQ(get("collections/c")->wanted_recall(), 0.5);
}

}  // namespace
}  // namespace moduli
