#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/signature/conformal_vector.h"
#include "core/signature/descriptor.h"
#include "server/rpc/convert.h"
#include "server/service/stored_shape.h"
#include "server/store/sqlite_catalog.h"
#include "tests/server/service/fixture.h"

/// A server on a store of tori whose numbers are made up, for searches over the wire.
namespace moduli {

inline constexpr int kShapes = 120;

// Around some centres; every fifth number like the one before, so that distances are equal.
inline std::vector<float> numbers(int number, std::size_t length) {
  const auto seed = static_cast<unsigned>(number - (number % 5 == 4 ? 1 : 0));
  std::mt19937 centre(seed % 7), own(seed);
  std::normal_distribution<float> far(0, 1), near(0, 0.2F);
  std::vector<float> values(length);
  for (float& value : values) value = far(centre) + near(own);
  return values;
}

inline Signature madeUp(int number) {
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
inline Signature madeUpPretzel(int number) {
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

inline ShapeRecord recordOf(const std::string& collection, int number) {
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
    EXPECT_THAT(status.error_message(), testing::HasSubstr(why));
    EXPECT_THAT(status.error_details(), testing::HasSubstr(field));
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
    EXPECT_THAT(status.error_message(), testing::HasSubstr(why));
    EXPECT_THAT(status.error_details(), testing::HasSubstr(field));
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

}  // namespace moduli
