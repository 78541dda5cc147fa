#include "client/cpp/client.h"

#include <array>
#include <cstdio>
#include <random>
#include <utility>

#include "client/cpp/client_impl.h"
#include "client/cpp/events.h"

namespace moduli {
namespace {

constexpr int kPageSize = 1000;

// A version 4 UUID.
std::string newRequestId() {
  std::random_device random;
  std::array<unsigned int, 4> words{random(), random(), random(), random()};
  words[1] = (words[1] & 0xFFFF0FFFU) | 0x00004000U;
  words[2] = (words[2] & 0x3FFFFFFFU) | 0x80000000U;
  std::array<char, 37> text{};
  std::snprintf(text.data(), text.size(), "%08x-%04x-%04x-%04x-%04x%08x", words[0], words[1] >> 16,
                words[1] & 0xFFFFU, words[2] >> 16, words[2] & 0xFFFFU, words[3]);
  return text.data();
}

}  // namespace

Client::Client(std::shared_ptr<grpc::Channel> channel, ClientOptions options)
    : impl_(std::make_unique<Impl>(std::move(channel), options)) {}

Client::~Client() = default;

void Client::cancel() {
  impl_->runner.cancel();
}

Result<v1::ServerInfo> Client::serverInfo() {
  return impl_->unary<v1::ServerInfo>(true, *impl_->geometry,
                                      &v1::GeometryService::Stub::GetServerInfo,
                                      v1::GetServerInfoRequest());
}

Result<v1::Inspection> Client::inspect(const v1::InspectMeshRequest& request) {
  v1::Inspection result;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) {
    const auto reader = impl_->geometry->InspectMesh(&context, request);
    return readEvents<v1::InspectMeshResponse>(impl_->runner, *reader, [&](auto& response) {
      if (response.has_inspection()) result.Swap(response.mutable_inspection());
      return true;
    });
  }));
  return result;
}

Result<v1::Signature> Client::computeSignature(const v1::ComputeSignatureRequest& request) {
  v1::Signature result;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) {
    const auto reader = impl_->geometry->ComputeSignature(&context, request);
    return readEvents<v1::ComputeSignatureResponse>(impl_->runner, *reader, [&](auto& response) {
      if (response.has_signature()) result.Swap(response.mutable_signature());
      return true;
    });
  }));
  return result;
}

Result<v1::SignatureDistances> Client::compareSignatures(
    const v1::CompareSignaturesRequest& request) {
  v1::SignatureDistances result;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) {
    const auto reader = impl_->geometry->CompareSignatures(&context, request);
    return readEvents<v1::CompareSignaturesResponse>(impl_->runner, *reader, [&](auto& response) {
      if (response.has_distances()) result.Swap(response.mutable_distances());
      return true;
    });
  }));
  return result;
}

Result<v1::Evaluation> Client::evaluate(const v1::EvaluateCollectionRequest& request) {
  v1::Evaluation result;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) {
    const auto reader = impl_->catalog->EvaluateCollection(&context, request);
    return readEvents<v1::EvaluateCollectionResponse>(impl_->runner, *reader, [&](auto& response) {
      if (response.has_evaluation()) result.Swap(response.mutable_evaluation());
      return true;
    });
  }));
  return result;
}

Result<v1::Duplicates> Client::findDuplicates(const v1::FindDuplicatesRequest& request) {
  v1::Duplicates result;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) {
    const auto reader = impl_->catalog->FindDuplicates(&context, request);
    return readEvents<v1::FindDuplicatesResponse>(impl_->runner, *reader, [&](auto& response) {
      if (response.has_duplicates()) result.Swap(response.mutable_duplicates());
      return true;
    });
  }));
  return result;
}

Result<v1::Collection> Client::createCollection(const std::string& id,
                                                const std::optional<double>& wanted_recall) {
  v1::CreateCollectionRequest request;
  request.set_collection_id(id);
  if (wanted_recall) request.set_wanted_recall(*wanted_recall);
  request.set_request_id(newRequestId());  // Makes a second attempt harmless.
  return impl_->unary<v1::Collection>(true, *impl_->catalog,
                                      &v1::CatalogService::Stub::CreateCollection, request);
}

Result<v1::Collection> Client::setWantedRecall(const std::string& name,
                                               const std::optional<double>& wanted_recall) {
  v1::UpdateCollectionRequest request;
  request.mutable_collection()->set_name(name);
  if (wanted_recall) request.mutable_collection()->set_wanted_recall(*wanted_recall);
  request.mutable_update_mask()->add_paths("wanted_recall");
  return impl_->unary<v1::Collection>(true, *impl_->catalog,
                                      &v1::CatalogService::Stub::UpdateCollection, request);
}

Result<v1::Collection> Client::getCollection(const std::string& name) {
  v1::GetCollectionRequest request;
  request.set_name(name);
  return impl_->unary<v1::Collection>(true, *impl_->catalog,
                                      &v1::CatalogService::Stub::GetCollection, request);
}

Pager<v1::Collection> Client::listCollections() {
  return Pager<v1::Collection>([this](
                                   const std::string& token) -> Result<ListPage<v1::Collection>> {
    v1::ListCollectionsRequest request;
    request.set_page_size(kPageSize);
    request.set_page_token(token);
    ASSIGN_OR_RETURN(const auto response, impl_->unary<v1::ListCollectionsResponse>(
                                              true, *impl_->catalog,
                                              &v1::CatalogService::Stub::ListCollections, request));
    return ListPage<v1::Collection>{{response.collections().begin(), response.collections().end()},
                                    response.next_page_token()};
  });
}

Result<v1::DeleteCollectionResponse> Client::deleteCollection(const std::string& name, bool force) {
  v1::DeleteCollectionRequest request;
  request.set_name(name);
  request.set_force(force);
  return impl_->unary<v1::DeleteCollectionResponse>(
      false, *impl_->catalog, &v1::CatalogService::Stub::DeleteCollection, request);
}

Result<v1::Shape> Client::getShape(const std::string& name) {
  v1::GetShapeRequest request;
  request.set_name(name);
  return impl_->unary<v1::Shape>(true, *impl_->catalog, &v1::CatalogService::Stub::GetShape,
                                 request);
}

Pager<v1::Shape> Client::listShapes(const std::string& collection, const std::string& filter) {
  return Pager<v1::Shape>([this, collection,
                           filter](const std::string& token) -> Result<ListPage<v1::Shape>> {
    v1::ListShapesRequest request;
    request.set_parent(collection);
    request.set_filter(filter);
    request.set_page_size(kPageSize);
    request.set_page_token(token);
    ASSIGN_OR_RETURN(const auto response,
                     impl_->unary<v1::ListShapesResponse>(
                         true, *impl_->catalog, &v1::CatalogService::Stub::ListShapes, request));
    return ListPage<v1::Shape>{{response.shapes().begin(), response.shapes().end()},
                               response.next_page_token()};
  });
}

Status Client::deleteShape(const std::string& name) {
  v1::DeleteShapeRequest request;
  request.set_name(name);
  return impl_
      ->unary<v1::DeleteShapeResponse>(false, *impl_->catalog,
                                       &v1::CatalogService::Stub::DeleteShape, request)
      .status();
}

Result<v1::BatchDeleteShapesResponse> Client::deleteShapes(
    const v1::BatchDeleteShapesRequest& request) {
  return impl_->unary<v1::BatchDeleteShapesResponse>(request.validate_only(), *impl_->catalog,
                                                     &v1::CatalogService::Stub::BatchDeleteShapes,
                                                     request);
}

Result<v1::Shape> Client::updateShape(const v1::UpdateShapeRequest& request) {
  return impl_->unary<v1::Shape>(request.new_shape_id().empty(), *impl_->catalog,
                                 &v1::CatalogService::Stub::UpdateShape, request);
}

Result<Client::DownloadHeader> Client::download(
    const std::string& name, const std::function<Status(std::string_view)>& sink) {
  v1::DownloadMeshRequest request;
  request.set_name(name);
  DownloadHeader header;
  Status sink_status;
  std::int64_t received = 0;
  // Not retried once bytes went to the sink; before that a failure has the call run again.
  Backoff backoff = impl_->runner.makeBackoff();
  grpc::Status status;
  do {
    CallRunner::Attempt attempt(impl_->runner);
    const auto reader = impl_->catalog->DownloadMesh(&attempt.context(), request);
    v1::DownloadMeshResponse piece;
    while (sink_status.ok() && reader->Read(&piece)) {
      if (received == 0 && (piece.total_size() > 0 || !piece.file_name().empty())) {
        header = {piece.format(), piece.file_name(), piece.total_size()};
      }
      received += static_cast<std::int64_t>(piece.data().size());
      sink_status = sink(piece.data());
    }
    if (!sink_status.ok()) attempt.context().TryCancel();
    status = reader->Finish();
  } while (!status.ok() && received == 0 && sink_status.ok() &&
           impl_->runner.waitToRetry(status, backoff));
  RETURN_IF_ERROR(sink_status);
  RETURN_IF_ERROR(impl_->finished(status));
  if (received != header.size) {
    return Status(Reason::kInternal, "the file's bytes ended too early", "try again");
  }
  return header;
}

std::string collectionName(const std::string& collection_id) {
  return "collections/" + collection_id;
}

std::string shapeName(const std::string& collection_id, const std::string& shape_id) {
  return collectionName(collection_id) + "/shapes/" + shape_id;
}

std::string idOf(const std::string& resource_name) {
  return resource_name.substr(resource_name.rfind('/') + 1);
}

}  // namespace moduli
