#include <filesystem>

#include "core/signature/signature.h"
#include "tests/server/service/fixture.h"

namespace moduli {
namespace {

/// Each test has a store of its own with the same 20 shapes, copied from one that is made once.
class CatalogTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() {
    original_ = std::make_unique<TemporaryFolder>();
    ServerOptions options;
    options.listen.clear();
    options.data_dir = original_->path();
    const auto server = Server::start(options);
    ASSERT_OK(server);
    std::vector<v1::IngestShapesRequest::Item> items;
    for (int i = 0; i < 20; ++i) {
      items.push_back(ingestItemOf(i, numbered("e", i), smallMesh(20 * i)));
      items.back().set_label(i % 2 == 0 ? "even" : "odd");
      (*items.back().mutable_tags())["number"] = std::to_string(i);
    }
    const auto outcomes = Peer((*server)->inProcessChannel()).ingest(ingestHeader("c"), items);
    ASSERT_OK(outcomes);
    for (const auto& [index, outcome] : *outcomes) {
      ASSERT_EQ(outcome.outcome(), v1::IngestShapesResponse::ADDED) << outcome.message();
    }
  }

  static void TearDownTestSuite() { original_.reset(); }

  void configure(ServerOptions& options) override {
    std::filesystem::copy(original_->path(), options.data_dir,
                          std::filesystem::copy_options::recursive);
  }

  Status deleteShape(const std::string& name) {
    grpc::ClientContext context;
    v1::DeleteShapeRequest request;
    request.set_name(name);
    v1::DeleteShapeResponse response;
    return fromGrpcStatus(peer_->catalog().DeleteShape(&context, request, &response));
  }

  Result<int> deleteCollection(const std::string& name, bool force) {
    grpc::ClientContext context;
    v1::DeleteCollectionRequest request;
    request.set_name(name);
    request.set_force(force);
    v1::DeleteCollectionResponse response;
    const grpc::Status status = peer_->catalog().DeleteCollection(&context, request, &response);
    if (!status.ok()) return fromGrpcStatus(status);
    return response.deleted_shapes();
  }

  Result<v1::ListShapesResponse> list(const v1::ListShapesRequest& request) {
    grpc::ClientContext context;
    v1::ListShapesResponse response;
    const grpc::Status status = peer_->catalog().ListShapes(&context, request, &response);
    if (!status.ok()) return fromGrpcStatus(status);
    return response;
  }

  static v1::SearchShapesRequest query(int k = 5) {
    v1::SearchShapesRequest request;
    request.set_parent("collections/c");
    request.set_k(k);
    return request;
  }

  static std::unique_ptr<TemporaryFolder> original_;
};

std::unique_ptr<TemporaryFolder> CatalogTest::original_;

TEST_F(CatalogTest, CollectionsAreMadeFoundListedAndCounted) {
  ASSERT_OK(peer_->createCollection("b"));
  EXPECT_THAT(peer_->createCollection("b"), FailsWith(Reason::kCollectionExists));
  for (const char* id : {"", ".b", "-b", "a/b", "a b", "ä"}) {
    EXPECT_THAT(peer_->createCollection(id), FailsWith(Reason::kInvalidName)) << id;
  }
  grpc::ClientContext get_context;
  v1::GetCollectionRequest get;
  get.set_name("collections/c");
  v1::Collection collection;
  ASSERT_TRUE(peer_->catalog().GetCollection(&get_context, get, &collection).ok());
  EXPECT_EQ(collection.shape_count(), 20);
  EXPECT_GT(collection.create_time().seconds(), 0);

  v1::ListCollectionsRequest request;
  request.set_page_size(1);
  v1::ListCollectionsResponse first, second;
  grpc::ClientContext first_context, second_context;
  ASSERT_TRUE(peer_->catalog().ListCollections(&first_context, request, &first).ok());
  request.set_page_token(first.next_page_token());
  ASSERT_TRUE(peer_->catalog().ListCollections(&second_context, request, &second).ok());
  EXPECT_EQ(first.collections(0).name(), "collections/b");
  EXPECT_EQ(second.collections(0).name(), "collections/c");
  EXPECT_EQ(second.next_page_token(), "");
}

TEST_F(CatalogTest, ARepeatedRequestIdAnswersTheFirstSuccess) {
  v1::CreateCollectionRequest request;
  request.set_collection_id("once");
  request.set_request_id("7d5a9f4e-0000-4000-8000-000000000001");
  for (int i = 0; i < 2; ++i) {
    grpc::ClientContext context;
    v1::Collection response;
    EXPECT_TRUE(peer_->catalog().CreateCollection(&context, request, &response).ok());
    EXPECT_EQ(response.name(), "collections/once");
  }
}

TEST_F(CatalogTest, AShapeComesBackWithItsSignatureAndItsVeryBytes) {
  const auto shape = peer_->getShape("collections/c/shapes/e3");
  ASSERT_OK(shape);
  EXPECT_EQ(shape->name(), "collections/c/shapes/e3");
  EXPECT_EQ(shape->label(), "odd");
  EXPECT_EQ(shape->tags().at("number"), "3");
  EXPECT_EQ(shape->format(), v1::MeshSource::OFF);
  EXPECT_EQ(shape->file_name(), "e3.off");
  EXPECT_EQ(shape->digest(), sha256Hex(smallMesh(60)));
  EXPECT_EQ(shape->signature().topology().faces(), 320);
  EXPECT_GT(shape->signature().shape().mean_curvature_spectrum_size(), 0);
  const auto bytes = peer_->download("collections/c/shapes/e3");
  ASSERT_OK(bytes);
  EXPECT_EQ(*bytes, smallMesh(60));
  EXPECT_EQ(shape->mesh_bytes(), static_cast<double>(bytes->size()));
}

TEST_F(CatalogTest, ALongFileIsDownloadedInChunks) {
  const std::string& bytes = largeMesh();
  const auto digest = peer_->upload(bytes);
  ASSERT_OK(digest);
  v1::IngestShapesRequest::Item item;
  item.set_shape_id("large");
  *item.mutable_source() = digestSource(*digest);
  item.mutable_source()->set_file_name("large.off");
  const auto outcomes = peer_->ingest(ingestHeader("c"), {item});
  ASSERT_OK(outcomes);
  ASSERT_EQ(outcomes->at(0).outcome(), v1::IngestShapesResponse::ADDED);
  const auto back = peer_->download("collections/c/shapes/large");
  ASSERT_OK(back);
  EXPECT_EQ(*back, bytes);
}

TEST_F(CatalogTest, ListsArePagedAndFiltered) {
  const auto all = peer_->listShapes("c");  // Pages of 7.
  ASSERT_OK(all);
  EXPECT_EQ(all->size(), 20U);
  EXPECT_EQ(all->front().signature().conformal().type(), v1::ConformalBlock::SPHERE);
  EXPECT_EQ(all->front().signature().topology().faces(), 320);
  EXPECT_EQ(all->front().signature().vectors().shape_size(), 0) << "summaries are short";
  v1::ListShapesRequest request;
  request.set_parent("collections/c");
  request.set_filter("label = \"odd\" AND tags.number >= 10");
  const auto odd = list(request);
  ASSERT_OK(odd);
  EXPECT_EQ(odd->shapes_size(), 5);
  request.set_page_size(-1);
  EXPECT_THAT(list(request), FailsWith(Reason::kInvalidRequest));
  request.set_page_size(2);
  request.set_page_token("nonsense");
  EXPECT_THAT(list(request), FailsWith(Reason::kInvalidPageToken));
  request.clear_page_token();
  request.set_filter("colour = \"red\"");
  EXPECT_THAT(list(request), FailsWith(Reason::kInvalidFilter));
}

TEST_F(CatalogTest, SearchFindsTheMeshItselfFirst) {
  auto request = query();
  *request.mutable_source() = inlineSource(smallMesh(140));
  const auto by_mesh = peer_->search(request);
  ASSERT_OK(by_mesh);
  ASSERT_EQ(by_mesh->hits_size(), 5);
  EXPECT_TRUE(by_mesh->exact());
  EXPECT_EQ(by_mesh->hits(0).name(), "e7");
  EXPECT_EQ(by_mesh->hits(0).label(), "odd");
  EXPECT_EQ(by_mesh->hits(0).distance(), 0.0);
  for (int i = 1; i < 5; ++i) {
    EXPECT_GE(by_mesh->hits(i).distance(), by_mesh->hits(i - 1).distance());
  }
  request.set_shape("collections/c/shapes/e7");
  const auto by_name = peer_->search(request);
  ASSERT_OK(by_name);
  EXPECT_EQ(by_name->SerializeAsString(), by_mesh->SerializeAsString());
  const auto signature = peer_->sign(inlineSource(smallMesh(140)));
  ASSERT_OK(signature);
  *request.mutable_signature() = *signature;
  const auto by_signature = peer_->search(request);
  ASSERT_OK(by_signature);
  EXPECT_EQ(by_signature->SerializeAsString(), by_mesh->SerializeAsString());
}

TEST_F(CatalogTest, SearchDistancesAreTheComparedOnes) {
  auto request = query(20);
  request.set_shape("collections/c/shapes/e0");
  for (const auto space : {v1::Signature::SHAPE, v1::Signature::METRIC}) {
    request.set_space(space);
    const auto found = peer_->search(request);
    ASSERT_OK(found);
    ASSERT_EQ(found->hits_size(), 20);
    v1::CompareSignaturesRequest compare;
    *compare.mutable_a()->mutable_source() = shapeSource("collections/c/shapes/e0");
    *compare.mutable_b()->mutable_source() =
        shapeSource("collections/c/shapes/" + found->hits(19).name());
    grpc::ClientContext context;
    const auto last = lastEvent(*peer_->geometry().CompareSignatures(&context, compare));
    ASSERT_OK(last);
    EXPECT_EQ(found->hits(19).distance(), space == v1::Signature::SHAPE
                                              ? last->distances().shape()
                                              : last->distances().metric());
  }
}

TEST_F(CatalogTest, SearchHonoursFilterSpaceAndCount) {
  auto request = query(20);
  request.set_shape("collections/c/shapes/e0");
  request.set_filter("label = \"odd\"");
  const auto odd = peer_->search(request);
  ASSERT_OK(odd);
  EXPECT_EQ(odd->hits_size(), 10);
  request.clear_filter();
  request.set_space(v1::Signature::CONFORMAL);
  const auto conformal = peer_->search(request);
  ASSERT_OK(conformal);
  ASSERT_EQ(conformal->hits_size(), 20);
  EXPECT_EQ(conformal->hits(19).distance(), 0.0) << "all spheres are conformally one";
  request.set_k(1'000'001);
  EXPECT_THAT(peer_->search(request), FailsWith(Reason::kInvalidOption));
  request.set_k(0);
  const auto usual = peer_->search(request);
  ASSERT_OK(usual);
  EXPECT_EQ(usual->hits_size(), 10);
  request.set_filter("genus >");
  EXPECT_THAT(peer_->search(request), FailsWith(Reason::kInvalidFilter));
  request.clear_filter();
  request.clear_query();
  EXPECT_THAT(peer_->search(request), FailsWith(Reason::kInvalidRequest));
  request.set_shape("collections/c/shapes/nobody");
  EXPECT_THAT(peer_->search(request), FailsWith(Reason::kShapeNotFound));
  request.set_parent("collections/none");
  EXPECT_THAT(peer_->search(request), FailsWith(Reason::kCollectionNotFound));
}

TEST_F(CatalogTest, AQueryOfAnotherVersionOrWithoutTheSpaceIsRefused) {
  auto signature = peer_->sign(inlineSource(smallMesh(0)), v1::Signature::CONFORMAL);
  ASSERT_OK(signature);
  auto request = query();
  *request.mutable_signature() = *signature;
  EXPECT_THAT(peer_->search(request), FailsWith(Reason::kIncomparableSignatures));
  request.set_space(v1::Signature::CONFORMAL);
  EXPECT_OK(peer_->search(request));
  request.mutable_signature()->set_descriptor_version(kDescriptorVersion + 1);
  EXPECT_THAT(peer_->search(request), FailsWith(Reason::kIncomparableSignatures));
}

TEST_F(CatalogTest, DeletedShapesAreGoneFromEverything) {
  ASSERT_OK(deleteShape("collections/c/shapes/e0"));
  EXPECT_THAT(deleteShape("collections/c/shapes/e0"), FailsWith(Reason::kShapeNotFound));
  EXPECT_THAT(peer_->getShape("collections/c/shapes/e0"), FailsWith(Reason::kShapeNotFound));
  EXPECT_THAT(peer_->download("collections/c/shapes/e0"), FailsWith(Reason::kShapeNotFound));
  auto request = query(20);
  *request.mutable_source() = inlineSource(smallMesh(0));
  const auto found = peer_->search(request);
  ASSERT_OK(found);
  EXPECT_EQ(found->hits_size(), 19);
  EXPECT_NE(found->hits(0).name(), "e0");
}

TEST_F(CatalogTest, ACollectionWithShapesGoesOnlyByForce) {
  EXPECT_THAT(deleteCollection("collections/c", false), FailsWith(Reason::kCollectionNotEmpty));
  const auto deleted = deleteCollection("collections/c", true);
  ASSERT_OK(deleted);
  EXPECT_EQ(*deleted, 20);
  EXPECT_THAT(deleteCollection("collections/c", true), FailsWith(Reason::kCollectionNotFound));
  EXPECT_THAT(peer_->listShapes("c"), FailsWith(Reason::kCollectionNotFound));
}

TEST_F(CatalogTest, NamesThatAreNoneAreRefused) {
  for (const char* name : {"", "c", "collections/c", "collections/c/shapes/", "shapes/e0",
                           "collections/c/shapes/a/b", "collections//shapes/e0"}) {
    EXPECT_THAT(peer_->getShape(name), FailsWith(Reason::kInvalidName)) << name;
  }
}

TEST_F(CatalogTest, EverythingIsThereAfterARestart) {
  restart();
  const auto shapes = peer_->listShapes("c");
  ASSERT_OK(shapes);
  EXPECT_EQ(shapes->size(), 20U);
  auto request = query();
  request.set_shape("collections/c/shapes/e9");
  const auto found = peer_->search(request);
  ASSERT_OK(found);
  EXPECT_EQ(found->hits(0).name(), "e9");
}

}  // namespace
}  // namespace moduli
