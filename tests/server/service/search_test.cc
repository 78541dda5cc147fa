#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "client/cpp/client.h"
#include "core/signature/conformal_vector.h"
#include "core/signature/descriptor.h"
#include "core/signature/distance.h"
#include "server/rpc/convert.h"
#include "server/service/stored_shape.h"
#include "server/store/sqlite_catalog.h"
#include "tests/server/service/fixture.h"

/// Pages, batches, approximate collections and what is refused of them, over the wire. The shapes
/// are tori whose numbers are made up.
namespace moduli {
namespace {

using testing::HasSubstr;

constexpr int kShapes = 120;

// Around some centres; every fifth number like the one before, so that distances are equal.
std::vector<float> numbers(int number, std::size_t length) {
  const auto seed = static_cast<unsigned>(number - (number % 5 == 4 ? 1 : 0));
  std::mt19937 centre(seed % 7), own(seed);
  std::normal_distribution<float> far(0, 1), near(0, 0.2F);
  std::vector<float> values(length);
  for (float& value : values) value = far(centre) + near(own);
  return values;
}

Signature madeUp(int number) {
  Signature signature;
  signature.topology = {.vertices = 100, .faces = 200, .components = 1, .genus = 1, .area = 1};
  ConformalBlock& block = signature.conformal.emplace();
  block.type = ConformalType::kTorus;
  block.tau = {0.01 * (number % 40), 1.5 + number % 11};
  const std::vector<double> conformal = conformalVector(block, signature.topology, {});
  signature.vectors.conformal.assign(conformal.begin(), conformal.end());
  signature.vectors.metric = numbers(number, kMetricLength);
  signature.vectors.shape = numbers(number, kShapeLength);
  return signature;
}

// Of genus 2, with all that a conformal distance may look at.
Signature madeUpPretzel(int number) {
  Signature signature = madeUp(number);
  signature.topology.genus = 2;
  ConformalBlock block;
  block.type = ConformalType::kHyperbolic;
  std::mt19937 random(static_cast<unsigned>(number));
  std::uniform_real_distribution<double> step(0.01, 0.3);
  double energy = 0.5, length = 1;
  for (int i = 0; i < 32; ++i) block.energy_spectrum.push_back(energy += step(random));
  for (int i = 0; i < 20; ++i) block.length_spectrum.push_back(length += step(random));
  signature.certificate.spectrum_complete_to = length;
  const std::vector<double> first(block.length_spectrum.begin(),
                                  block.length_spectrum.begin() + kFirstLengths);
  const std::vector<double> conformal = conformalVector(block, signature.topology, first);
  signature.conformal = block;
  signature.vectors.conformal.assign(conformal.begin(), conformal.end());
  return signature;
}

ShapeRecord recordOf(const std::string& collection, int number) {
  ShapeRecord record;
  record.collection = collection;
  record.name = numbered("n", number);
  record.label = number % 2 == 0 ? "even" : "odd";
  record.digest = sha256Hex(record.name);
  fillRecord({madeUp(number), {}}, record);
  return record;
}

class SearchServiceTest : public ServiceTest {
 protected:
  void configure(ServerOptions& options) override {
    options.data_dir = memory_.path();
    std::unique_ptr<Catalog> catalog = open(options);
    ASSERT_OK(catalog->createCollection("c", ""));
    for (int number = 0; number < kShapes; ++number) {
      ASSERT_OK(catalog->putShape(recordOf("c", number), OnExists::kError));
    }
  }

  static std::unique_ptr<Catalog> open(const ServerOptions& options) {
    auto catalog = SqliteCatalog::open(options.data_dir + "/catalog.sqlite");
    EXPECT_OK(catalog);
    return *std::move(catalog);
  }

  static v1::SearchShapesRequest query(int number, int k = 10) {
    v1::SearchShapesRequest request;
    request.set_parent("collections/c");
    request.set_shape(numbered("collections/c/shapes/n", number));
    request.set_k(k);
    return request;
  }

  static v1::BatchSearchShapesRequest batch(int k = 10) {
    v1::BatchSearchShapesRequest request;
    request.set_parent("collections/c");
    request.set_k(k);
    return request;
  }

  // All pages of this size as one result.
  v1::SearchResult paged(v1::SearchShapesRequest request, int size) {
    v1::SearchResult all;
    request.set_page_size(size);
    do {
      const auto page = peer_->searchPage(request);
      EXPECT_OK(page);
      if (!page.ok()) break;
      EXPECT_LE(page->result().hits_size(), size);
      EXPECT_GT(page->result().hits_size(), 0);
      all.set_exact(page->result().exact());
      all.mutable_hits()->MergeFrom(page->result().hits());
      request.set_page_token(page->next_page_token());
    } while (!request.page_token().empty());
    return all;
  }

  // The first page of two hits, and its token.
  v1::SearchShapesRequest secondPage(int number) {
    v1::SearchShapesRequest request = query(number);
    request.set_page_size(2);
    const auto page = peer_->searchPage(request);
    EXPECT_OK(page);
    if (page.ok()) request.set_page_token(page->next_page_token());
    EXPECT_NE(request.page_token(), "");
    return request;
  }

  // Code and field of the refusal; both in the details as in google.rpc.
  void expectRefused(const v1::SearchShapesRequest& request, const std::string& field,
                     const std::string& why) {
    grpc::ClientContext context;
    const auto reader = peer_->catalog().SearchShapes(&context, request);
    v1::SearchShapesResponse event;
    while (reader->Read(&event)) {
    }
    const grpc::Status status = reader->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), HasSubstr(why));
    EXPECT_THAT(status.error_details(), HasSubstr(field));
  }

  void expectBatchRefused(const v1::BatchSearchShapesRequest& request, const std::string& field,
                          const std::string& why) {
    grpc::ClientContext context;
    const auto reader = peer_->catalog().BatchSearchShapes(&context, request);
    v1::BatchSearchShapesResponse event;
    while (reader->Read(&event)) {
    }
    const grpc::Status status = reader->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), HasSubstr(why));
    EXPECT_THAT(status.error_details(), HasSubstr(field));
  }

  Result<v1::Collection> update(const std::string& name, std::optional<double> recall,
                                const std::string& mask = "wanted_recall") {
    v1::UpdateCollectionRequest request;
    request.mutable_collection()->set_name(name);
    if (recall) request.mutable_collection()->set_wanted_recall(*recall);
    request.mutable_update_mask()->add_paths(mask);
    grpc::ClientContext context;
    v1::Collection response;
    const grpc::Status status = peer_->catalog().UpdateCollection(&context, request, &response);
    if (!status.ok()) return fromGrpcStatus(status);
    return response;
  }

  Result<v1::Collection> get(const std::string& name) {
    v1::GetCollectionRequest request;
    request.set_name(name);
    grpc::ClientContext context;
    v1::Collection response;
    const grpc::Status status = peer_->catalog().GetCollection(&context, request, &response);
    if (!status.ok()) return fromGrpcStatus(status);
    return response;
  }

  void deleteCollection(const std::string& name) {
    v1::DeleteCollectionRequest request;
    request.set_name(name);
    request.set_force(true);
    grpc::ClientContext context;
    v1::DeleteCollectionResponse response;
    ASSERT_TRUE(peer_->catalog().DeleteCollection(&context, request, &response).ok());
  }

  // With shapes enough for approximate indexes.
  void fillLarge(const std::optional<double>& wanted_recall) {
    server_.reset();
    {
      const auto catalog = open(options_);
      ASSERT_OK(catalog->createCollection("large", "", wanted_recall));
      for (int number = 0; number < kMany; ++number) {
        ASSERT_OK(catalog->putShape(recordOf("large", number), OnExists::kError));
      }
    }
    restart();
  }

  static constexpr int kMany = 4200;
  TemporaryFolder memory_{TemporaryFolder::Place::kMemory};
};

TEST_F(SearchServiceTest, PagesMakeTheWholeAnswer) {
  for (const auto space : {v1::Signature::SHAPE, v1::Signature::METRIC, v1::Signature::CONFORMAL}) {
    auto request = query(17, 57);
    request.set_space(space);
    request.set_explain(true);
    const auto whole = peer_->searchPage(request);
    ASSERT_OK(whole);
    EXPECT_EQ(whole->result().hits_size(), 57);
    EXPECT_EQ(whole->next_page_token(), "");
    for (const int size : {1, 10, 56, 57}) {
      EXPECT_EQ(paged(request, size).SerializeAsString(), whole->result().SerializeAsString());
    }
  }
  auto request = query(17, 1'000'000);
  EXPECT_EQ(paged(request, 50).hits_size(), kShapes);
  request.set_filter("label = \"odd\"");
  EXPECT_EQ(paged(request, 50).hits_size(), kShapes / 2);
  request.set_page_size(5000);  // More than a page has: as many as it has.
  EXPECT_EQ(peer_->search(request)->hits_size(), kShapes / 2);
}

TEST_F(SearchServiceTest, ATokenIsGoodForItsOwnSearchOnly) {
  const auto second = secondPage(3);
  EXPECT_OK(peer_->searchPage(second));
  auto other = second;
  other.set_page_size(7);
  EXPECT_OK(peer_->searchPage(other)) << "pages may differ in size";
  const auto differs = [&](const std::function<void(v1::SearchShapesRequest&)>& change) {
    other = second;
    change(other);
    expectRefused(other, "page_token", "belongs to another search");
  };
  differs([](auto& request) { request.set_k(11); });
  differs([](auto& request) { request.set_space(v1::Signature::METRIC); });
  differs([](auto& request) { request.set_filter("genus = 1"); });
  differs([](auto& request) { request.set_shape("collections/c/shapes/n4"); });
  differs([](auto& request) { request.set_page_token("nonsense"); });
  differs([](auto& request) { request.mutable_page_token()->pop_back(); });
  other = second;
  other.set_page_size(-1);
  expectRefused(other, "page_size", "negative");
}

TEST_F(SearchServiceTest, ATokenOfWhatIsNoMoreIsRefused) {
  auto second = secondPage(3);
  // The shape searched for is stored anew, with other numbers.
  server_.reset();
  {
    const auto catalog = open(options_);
    ShapeRecord record = recordOf("c", 60);
    record.name = "n3";
    ASSERT_OK(catalog->putShape(record, OnExists::kReplace));
  }
  restart();
  expectRefused(second, "", "since this page token was given");
  second = secondPage(5);
  const auto signature = peer_->getShape("collections/c/shapes/n5")->signature();
  auto by_signature = query(0);
  *by_signature.mutable_signature() = signature;
  by_signature.set_page_size(2);
  by_signature.set_page_token(peer_->searchPage(by_signature)->next_page_token());
  EXPECT_OK(peer_->searchPage(by_signature));
  deleteCollection("collections/c");
  EXPECT_THAT(peer_->searchPage(by_signature), FailsWith(Reason::kCollectionNotFound));
  ASSERT_OK(peer_->createCollection("c"));
  expectRefused(by_signature, "", "since this page token was given");
  EXPECT_THAT(peer_->searchPage(second), FailsWith(Reason::kShapeNotFound));
}

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

TEST_F(SearchServiceTest, BadQueriesAreRefusedWithTheirReason) {
  const auto with = [&](const std::function<void(v1::Signature&)>& change) {
    auto request = query(0);
    *request.mutable_signature() = toProto(madeUp(0));
    change(*request.mutable_signature());
    return request;
  };
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    expectRefused(with([&](auto& it) { it.mutable_vectors()->set_shape(250, bad); }), "signature",
                  "not finite");
    expectRefused(with([&](auto& it) { it.mutable_vectors()->set_metric(0, bad); }), "signature",
                  "not finite");
  }
  expectRefused(with([](auto& it) { it.mutable_vectors()->set_shape(0, 3e38F); }), "signature",
                "above 1e38");
  for (const int length : {1, 113, 252}) {
    EXPECT_THAT(peer_->search(with([&](auto& it) {
      it.mutable_vectors()->mutable_shape()->Resize(length, 0.5F);
    })),
                FailsWith(Reason::kIncomparableSignatures))
        << length;
  }
  auto conformal = with([](auto& it) { it.mutable_vectors()->add_conformal(1); });
  conformal.set_space(v1::Signature::CONFORMAL);
  EXPECT_THAT(peer_->search(conformal), FailsWith(Reason::kIncomparableSignatures));
  for (const int version : {1, kDescriptorVersion - 1, kDescriptorVersion + 1}) {
    EXPECT_THAT(peer_->search(with([&](auto& it) { it.set_descriptor_version(version); })),
                FailsWith(Reason::kIncomparableSignatures));
  }
  expectRefused(with([](auto& it) { it.set_descriptor_version(0); }), "signature",
                "no descriptor version");
  expectRefused(query(0, -1), "k", "k is -1, not in 1 to 1000000");
  expectRefused(query(0, 1'000'001), "k", "k is 1000001");
  EXPECT_EQ(peer_->search(query(0, 0))->hits_size(), 10);
  EXPECT_EQ(peer_->search(query(0, 999))->hits_size(), kShapes);
  auto filtered = query(0);
  for (const char* filter :
       {"colour = 3", "genus", "genus = ", "tags = 1", "genus = 1 OR genus = 2"}) {
    filtered.set_filter(filter);
    expectRefused(filtered, "filter", "column");
  }
}

// A stored signature of another version is left out until it is signed anew.
TEST_F(SearchServiceTest, StoredShapesOfAnotherVersionAreNeitherFoundNorSearchedFor) {
  server_.reset();
  {
    const auto catalog = open(options_);
    ShapeRecord record = recordOf("c", 0);
    Signature old = madeUp(0);
    old.descriptor_version = kDescriptorVersion - 1;
    fillRecord({old, {}}, record);
    ASSERT_OK(catalog->putShape(record, OnExists::kReplace));
  }
  restart();
  const auto found = peer_->search(query(1, 1000));
  ASSERT_OK(found);
  for (const v1::SearchHit& hit : found->hits()) EXPECT_NE(hit.name(), "n0");
  const auto asked = peer_->search(query(0));
  // Signing it anew, which the server does by itself, fails: its mesh is not there.
  EXPECT_THAT(asked, FailsWith(Reason::kIncomparableSignatures));
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
