#include <cmath>
#include <limits>

#include "tests/server/service/search_fixture.h"

/// Pages of one search, and what is refused of a query.
namespace moduli {
namespace {

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

}  // namespace
}  // namespace moduli
