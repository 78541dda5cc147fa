#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "moduli/v1/catalog.grpc.pb.h"
#include "server/rpc/convert.h"
#include "server/service/batch_search.h"
#include "server/service/duplicates.h"
#include "server/service/evaluating.h"
#include "server/service/event_stream.h"
#include "server/service/ingest_call.h"
#include "server/service/request.h"
#include "server/service/search_query.h"
#include "server/service/services.h"
#include "server/service/stored_shape.h"
#include "server/service/unary_call.h"

namespace moduli {
namespace {

using Rpc = grpc::CallbackServerContext;

Result<v1::Collection> createCollection(const Backend& backend,
                                        const v1::CreateCollectionRequest& request) {
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  ASSIGN_OR_RETURN(
      const CollectionRecord record,
      catalog->createCollection(
          request.collection_id(), request.request_id(),
          request.has_wanted_recall() ? std::optional(request.wanted_recall()) : std::nullopt));
  return toProto(record);
}

/// With what its indexes measured.
v1::Collection measured(const Backend& backend, const CollectionRecord& record) {
  v1::Collection collection = toProto(record);
  if (const auto recall = backend.indexes->recall(record.id)) collection.set_recall(*recall);
  return collection;
}

Result<v1::Collection> getCollection(const Backend& backend, const std::string& name) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(name));
  ASSIGN_OR_RETURN(const CollectionRecord record, catalog->getCollection(collection));
  return measured(backend, record);
}

Result<v1::Collection> updateCollection(const Backend& backend,
                                        const v1::UpdateCollectionRequest& request) {
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  const v1::Collection& wanted = request.collection();
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(wanted.name()));
  if (request.update_mask().paths().empty()) return getCollection(backend, wanted.name());
  ASSIGN_OR_RETURN(const CollectionRecord record,
                   catalog->updateCollection(collection, wanted.has_wanted_recall()
                                                             ? std::optional(wanted.wanted_recall())
                                                             : std::nullopt));
  RETURN_IF_ERROR(backend.indexes->refresh());
  return measured(backend, record);
}

Result<v1::ListCollectionsResponse> listCollections(const Backend& backend,
                                                    const v1::ListCollectionsRequest& request) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const Page<CollectionRecord> page,
                   catalog->listCollections({request.page_size(), request.page_token()}));
  v1::ListCollectionsResponse response;
  for (const CollectionRecord& record : page.items) *response.add_collections() = toProto(record);
  response.set_next_page_token(page.next_token);
  return response;
}

Result<v1::DeleteCollectionResponse> deleteCollection(const Backend& backend,
                                                      const v1::DeleteCollectionRequest& request) {
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(request.name()));
  ASSIGN_OR_RETURN(const std::int64_t shapes,
                   catalog->deleteCollection(collection, request.force()));
  RETURN_IF_ERROR(backend.indexes->refresh());
  v1::DeleteCollectionResponse response;
  response.set_deleted_shapes(static_cast<std::int32_t>(shapes));
  return response;
}

Result<v1::Shape> getShape(const Backend& backend, const std::string& name) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const ShapePath path, parseShapeName(name));
  ASSIGN_OR_RETURN(const ShapeRecord record,
                   catalog->getShape(path.collection, path.shape, ShapeView::kFull));
  return toProto(record, true);
}

Result<v1::ListShapesResponse> listShapes(Context& context, const Backend& backend,
                                          const v1::ListShapesRequest& request) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(request.parent()));
  ASSIGN_OR_RETURN(const Page<ShapeRecord> page,
                   catalog->listShapes(context, collection, request.filter(),
                                       {request.page_size(), request.page_token()}));
  v1::ListShapesResponse response;
  for (const ShapeRecord& record : page.items) {
    ASSIGN_OR_RETURN(*response.add_shapes(), toProto(record, false));
  }
  response.set_next_page_token(page.next_token);
  return response;
}

Result<v1::DeleteShapeResponse> deleteShape(const Backend& backend, const std::string& name) {
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  ASSIGN_OR_RETURN(const ShapePath path, parseShapeName(name));
  RETURN_IF_ERROR(catalog->deleteShape(path.collection, path.shape));
  RETURN_IF_ERROR(backend.indexes->refresh());
  return v1::DeleteShapeResponse{};
}

Result<v1::BatchDeleteShapesResponse> batchDelete(Context& context, const Backend& backend,
                                                  const v1::BatchDeleteShapesRequest& request) {
  constexpr std::size_t kMostNames = 100;
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(request.parent()));
  ASSIGN_OR_RETURN(const Filter filter, Filter::parse(request.filter()));
  ASSIGN_OR_RETURN(const std::vector<std::string> names,
                   catalog->deleteShapes(context, collection, filter, request.validate_only()));
  if (!request.validate_only()) RETURN_IF_ERROR(backend.indexes->refresh());
  v1::BatchDeleteShapesResponse response;
  response.set_deleted_shapes(static_cast<std::int32_t>(names.size()));
  for (std::size_t i = 0; i < std::min(kMostNames, names.size()); ++i) response.add_names(names[i]);
  return response;
}

Result<v1::Shape> updateShape(const Backend& backend, const v1::UpdateShapeRequest& request) {
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  ASSIGN_OR_RETURN(const ShapePath path, parseShapeName(request.shape().name()));
  ShapeUpdate update;
  for (const std::string& field : request.update_mask().paths()) {
    if (field == "label") update.label = request.shape().label();
    if (field == "tags") {
      update.tags.emplace(request.shape().tags().begin(), request.shape().tags().end());
    }
  }
  std::string name = path.shape;
  if (!request.new_shape_id().empty()) name = *(update.name = request.new_shape_id());
  RETURN_IF_ERROR(catalog->updateShape(path.collection, path.shape, update));
  ASSIGN_OR_RETURN(const ShapeRecord record,
                   catalog->getShape(path.collection, name, ShapeView::kSummary));
  return toProto(record, false);
}

Refusal checkUpdate(const v1::UpdateShapeRequest& request) {
  for (const std::string& field : request.update_mask().paths()) {
    if (field == "label" || field == "tags") continue;
    return {{Reason::kInvalidRequest, "\"" + field + "\" of a shape cannot be changed",
             "name label or tags"},
            "update_mask"};
  }
  return {};
}

/// Deleting everything has to be meant: DeleteCollection does that.
Refusal checkNotEmpty(const std::string& filter) {
  if (filter.find_first_not_of(" \t\n") != std::string::npos) return {};
  return {{Reason::kInvalidFilter, "no filter says which shapes are meant",
           "give one, such as label = \"cup\""},
          "filter"};
}

Refusal checkThreshold(const v1::FindDuplicatesRequest& request) {
  if (!request.has_threshold()) return {};
  if (std::isfinite(request.threshold()) && request.threshold() >= 0) return {};
  return {{Reason::kInvalidOption, "the threshold is no distance", "give 0 or a positive number"},
          "threshold"};
}

Refusal checkRecall(bool given, double recall, const std::string& field) {
  if (!given) return {};
  return {validateWantedRecall(recall), field};
}

Refusal checkCollectionUpdate(const v1::UpdateCollectionRequest& request) {
  for (const std::string& field : request.update_mask().paths()) {
    if (field == "wanted_recall") continue;
    return {{Reason::kInvalidRequest, "\"" + field + "\" of a collection cannot be changed",
             "name wanted_recall"},
            "update_mask"};
  }
  return checkRecall(request.collection().has_wanted_recall(), request.collection().wanted_recall(),
                     "collection.wanted_recall");
}

/// Sends a stored file chunk by chunk. Each chunk is read on an I/O thread when the one before it
/// has been written, so that one chunk is in memory whatever the file's size.
class Download : public std::enable_shared_from_this<Download> {
 public:
  using Stream = EventStream<v1::DownloadMeshResponse>;

  Download(Backend& backend, Stream::Self stream) : backend_(backend), stream_(std::move(stream)) {}

  void open(const std::string& name) {
    const Status status = guarded([&]() -> Status {
      ASSIGN_OR_RETURN(const Catalog* catalog, backend_.catalog());
      ASSIGN_OR_RETURN(const ShapePath path, parseShapeName(name));
      ASSIGN_OR_RETURN(const ShapeRecord record,
                       catalog->getShape(path.collection, path.shape, ShapeView::kSummary));
      ASSIGN_OR_RETURN(reader_, backend_.store->meshes().openReader(record.digest));
      next_.set_format(toProto(record.format));
      next_.set_file_name(record.file_name);
      next_.set_total_size(reader_->size());
      return {};
    });
    if (!status.ok()) return stream_->end(status);
    sendNext();
  }

 private:
  void sendNext() {
    Result<std::string> data = guarded([&] { return reader_->next(kMaxChunkBytes); });
    if (!data.ok()) return stream_->end(data.status());
    // The first message goes out even for an empty file, for the sake of its header.
    if (data->empty() && sent_any_) return stream_->end({});
    next_.set_data(*std::move(data));
    sent_any_ = true;
    stream_->send(std::exchange(next_, {}), [self = shared_from_this()] {
      self->backend_.io.submitWhenRoom([self] { self->sendNext(); });
    });
  }

  Backend& backend_;
  const Stream::Self stream_;
  std::unique_ptr<MeshReader> reader_;
  v1::DownloadMeshResponse next_;
  bool sent_any_ = false;
};

/// Hands out the results of a batch.
EventStream<v1::BatchSearchShapesResponse>::Parts oneByOne(std::vector<v1::QueryResult> results) {
  return
      [results = std::make_shared<std::vector<v1::QueryResult>>(std::move(results)),
       next = std::make_shared<std::size_t>(0)]() -> std::optional<v1::BatchSearchShapesResponse> {
        if (*next == results->size()) return std::nullopt;
        v1::BatchSearchShapesResponse response;
        *response.mutable_result() = std::move((*results)[(*next)++]);
        return response;
      };
}

class CatalogService final : public v1::CatalogService::CallbackService {
 public:
  explicit CatalogService(Backend& backend) : backend_(backend) {}

  grpc::ServerUnaryReactor* CreateCollection(Rpc* rpc, const v1::CreateCollectionRequest* request,
                                             v1::Collection* response) override {
    const Status valid = validateCollectionName(request->collection_id());
    return UnaryCall<v1::Collection>::answer(
        backend_, *rpc, *response, {"CreateCollection", Role::kWriter},
        firstOf(
            Refusal{valid, "collection_id"},
            checkRecall(request->has_wanted_recall(), request->wanted_recall(), "wanted_recall")),
        [this, kept = *request](Context&) { return createCollection(backend_, kept); });
  }

  grpc::ServerUnaryReactor* UpdateCollection(Rpc* rpc, const v1::UpdateCollectionRequest* request,
                                             v1::Collection* response) override {
    return UnaryCall<v1::Collection>::answer(
        backend_, *rpc, *response, {"UpdateCollection", Role::kWriter},
        firstOf(checkCollectionName(request->collection().name(), "collection.name"),
                checkCollectionUpdate(*request)),
        [this, kept = *request](Context&) { return updateCollection(backend_, kept); });
  }

  grpc::ServerUnaryReactor* GetCollection(Rpc* rpc, const v1::GetCollectionRequest* request,
                                          v1::Collection* response) override {
    return UnaryCall<v1::Collection>::answer(
        backend_, *rpc, *response, {"GetCollection"}, checkCollectionName(request->name(), "name"),
        [this, name = request->name()](Context&) { return getCollection(backend_, name); });
  }

  grpc::ServerUnaryReactor* ListCollections(Rpc* rpc, const v1::ListCollectionsRequest* request,
                                            v1::ListCollectionsResponse* response) override {
    return UnaryCall<v1::ListCollectionsResponse>::answer(
        backend_, *rpc, *response, {"ListCollections"}, checkPageSize(request->page_size()),
        [this, kept = *request](Context&) { return listCollections(backend_, kept); });
  }

  grpc::ServerUnaryReactor* DeleteCollection(Rpc* rpc, const v1::DeleteCollectionRequest* request,
                                             v1::DeleteCollectionResponse* response) override {
    return UnaryCall<v1::DeleteCollectionResponse>::answer(
        backend_, *rpc, *response, {"DeleteCollection", Role::kAdmin},
        checkCollectionName(request->name(), "name"),
        [this, kept = *request](Context&) { return deleteCollection(backend_, kept); });
  }

  grpc::ServerUnaryReactor* GetShape(Rpc* rpc, const v1::GetShapeRequest* request,
                                     v1::Shape* response) override {
    return UnaryCall<v1::Shape>::answer(
        backend_, *rpc, *response, {"GetShape"}, checkShapeName(request->name(), "name"),
        [this, name = request->name()](Context&) { return getShape(backend_, name); });
  }

  grpc::ServerUnaryReactor* ListShapes(Rpc* rpc, const v1::ListShapesRequest* request,
                                       v1::ListShapesResponse* response) override {
    return UnaryCall<v1::ListShapesResponse>::answer(
        backend_, *rpc, *response, {"ListShapes"},
        firstOf(checkCollectionName(request->parent(), "parent"),
                checkPageSize(request->page_size()), checkFilter(request->filter())),
        [this, kept = *request](Context& context) { return listShapes(context, backend_, kept); });
  }

  grpc::ServerUnaryReactor* DeleteShape(Rpc* rpc, const v1::DeleteShapeRequest* request,
                                        v1::DeleteShapeResponse* response) override {
    return UnaryCall<v1::DeleteShapeResponse>::answer(
        backend_, *rpc, *response, {"DeleteShape", Role::kWriter},
        checkShapeName(request->name(), "name"),
        [this, name = request->name()](Context&) { return deleteShape(backend_, name); });
  }

  grpc::ServerUnaryReactor* UpdateShape(Rpc* rpc, const v1::UpdateShapeRequest* request,
                                        v1::Shape* response) override {
    return UnaryCall<v1::Shape>::answer(
        backend_, *rpc, *response, {"UpdateShape", Role::kWriter},
        firstOf(checkShapeName(request->shape().name(), "shape.name"), checkUpdate(*request)),
        [this, kept = *request](Context&) { return updateShape(backend_, kept); });
  }

  grpc::ServerUnaryReactor* BatchDeleteShapes(Rpc* rpc, const v1::BatchDeleteShapesRequest* request,
                                              v1::BatchDeleteShapesResponse* response) override {
    return UnaryCall<v1::BatchDeleteShapesResponse>::answer(
        backend_, *rpc, *response, {"BatchDeleteShapes", Role::kWriter},
        firstOf(checkCollectionName(request->parent(), "parent"), checkFilter(request->filter()),
                checkNotEmpty(request->filter())),
        [this, kept = *request](Context& context) { return batchDelete(context, backend_, kept); });
  }

  grpc::ServerWriteReactor<v1::EvaluateCollectionResponse>* EvaluateCollection(
      Rpc* rpc, const v1::EvaluateCollectionRequest* request) override {
    return EventStream<v1::EvaluateCollectionResponse>::answer(
        backend_, *rpc, {"EvaluateCollection"},
        firstOf(checkCollectionName(request->parent(), "parent"),
                checkSpace(request->space(), "space"), checkFilter(request->filter())),
        [this, kept = *request](Context& context) -> Result<v1::EvaluateCollectionResponse> {
          v1::EvaluateCollectionResponse response;
          ASSIGN_OR_RETURN(*response.mutable_evaluation(),
                           evaluateCollection(context, backend_, kept));
          return response;
        });
  }

  grpc::ServerWriteReactor<v1::FindDuplicatesResponse>* FindDuplicates(
      Rpc* rpc, const v1::FindDuplicatesRequest* request) override {
    return EventStream<v1::FindDuplicatesResponse>::answer(
        backend_, *rpc, {"FindDuplicates"},
        firstOf(checkCollectionName(request->parent(), "parent"),
                checkSpace(request->space(), "space"), checkFilter(request->filter()),
                checkThreshold(*request)),
        [this, kept = *request](Context& context) -> Result<v1::FindDuplicatesResponse> {
          v1::FindDuplicatesResponse response;
          ASSIGN_OR_RETURN(*response.mutable_duplicates(), findDuplicates(context, backend_, kept));
          return response;
        });
  }

  grpc::ServerWriteReactor<v1::DownloadMeshResponse>* DownloadMesh(
      Rpc* rpc, const v1::DownloadMeshRequest* request) override {
    return Download::Stream::open(
        backend_, *rpc, {"DownloadMesh"}, checkShapeName(request->name(), "name"),
        [this, name = request->name()](const Download::Stream::Self& stream) {
          auto download = std::make_shared<Download>(backend_, stream);
          return backend_.io.submit([download, name] { download->open(name); });
        });
  }

  IngestCall::Reactor* IngestShapes(Rpc* rpc) override {
    return IngestCall::answer(backend_, *rpc);
  }

  grpc::ServerWriteReactor<v1::SearchShapesResponse>* SearchShapes(
      Rpc* rpc, const v1::SearchShapesRequest* request) override {
    return EventStream<v1::SearchShapesResponse>::answer(
        backend_, *rpc, {"SearchShapes"}, checkSearch(*request),
        [this, kept = std::make_shared<v1::SearchShapesRequest>(*request)](Context& context) {
          return search(context, backend_, *kept);
        });
  }

  grpc::ServerWriteReactor<v1::BatchSearchShapesResponse>* BatchSearchShapes(
      Rpc* rpc, const v1::BatchSearchShapesRequest* request) override {
    using Stream = EventStream<v1::BatchSearchShapesResponse>;
    return Stream::answerInParts(
        backend_, *rpc, {"BatchSearchShapes"}, checkBatchSearch(*request),
        [this, kept = std::make_shared<v1::BatchSearchShapesRequest>(*request)](
            Context& context) -> Result<Stream::Parts> {
          ASSIGN_OR_RETURN(auto results, batchSearch(context, backend_, *kept));
          return oneByOne(std::move(results));
        });
  }

 private:
  Backend& backend_;
};

}  // namespace

std::unique_ptr<grpc::Service> makeCatalogService(Backend& backend) {
  return std::make_unique<CatalogService>(backend);
}

}  // namespace moduli
