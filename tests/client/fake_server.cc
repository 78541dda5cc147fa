#include "tests/client/fake_server.h"

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <mutex>
#include <thread>

#include "moduli/v1/catalog.grpc.pb.h"
#include "moduli/v1/geometry_service.grpc.pb.h"
#include "server/rpc/grpc_status.h"

namespace moduli {
namespace {

/// Script and record, shared by the services.
struct State {
  explicit State(const FakeScript& wanted) : script(wanted) {}

  FakeScript script;
  std::mutex mutex;
  FakeRecord record;
};

const grpc::Status kBroken(grpc::StatusCode::UNAVAILABLE, "the connection broke");

class FakeGeometry final : public v1::GeometryService::Service {
 public:
  explicit FakeGeometry(State& state) : state_(state) {}

  grpc::Status ComputeSignature(grpc::ServerContext* context, const v1::ComputeSignatureRequest*,
                                grpc::ServerWriter<v1::ComputeSignatureResponse>* writer) override {
    const std::size_t call = enter(*context);
    waitWhileHanging(*context);
    if (call < state_.script.refusals.size()) return toGrpcStatus(state_.script.refusals[call]);
    v1::ComputeSignatureResponse response;
    response.mutable_progress()->set_stage("factorize");
    writer->Write(response);
    response.mutable_signature()->set_descriptor_version(7);
    writer->Write(response);
    return grpc::Status::OK;
  }

  grpc::Status Parameterize(grpc::ServerContext* context, const v1::ParameterizeRequest*,
                            grpc::ServerWriter<v1::ParameterizeResponse>* writer) override {
    bool first = false;
    {
      const std::lock_guard lock(state_.mutex);
      first = state_.record.parameterize_calls++ == 0;
    }
    waitWhileHanging(*context);
    std::size_t sent = 0;
    for (const v1::ParameterizeResponse& response : state_.script.parameterization) {
      if (!writer->Write(response)) break;
      if (++sent == state_.script.break_parameterize_after && first) return kBroken;
    }
    return grpc::Status::OK;
  }

  grpc::Status UploadMesh(grpc::ServerContext*, grpc::ServerReader<v1::UploadMeshRequest>* reader,
                          v1::UploadMeshResponse* response) override {
    v1::UploadMeshRequest request;
    for (bool first = true; reader->Read(&request); first = false) {
      const std::lock_guard lock(state_.mutex);
      FakeRecord& record = state_.record;
      if (first) record.upload_starts.push_back(request.write_offset());
      if (request.write_offset() != static_cast<std::int64_t>(record.uploaded.size())) {
        return toGrpcStatus({Reason::kUploadOffsetMismatch, "wrong offset"});
      }
      record.uploaded += request.data();
      record.upload_bytes_sent += request.data().size();
      const std::uint64_t limit = state_.script.break_upload_after;
      if (limit > 0 && record.upload_starts.size() == 1 && record.uploaded.size() >= limit) {
        return kBroken;
      }
      if (request.finish_write()) complete_ = true;
    }
    response->set_committed_size(static_cast<std::int64_t>(state_.record.uploaded.size()));
    return grpc::Status::OK;
  }

  grpc::Status QueryUpload(grpc::ServerContext*, const v1::QueryUploadRequest*,
                           v1::QueryUploadResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    if (state_.record.uploaded.empty()) {
      return toGrpcStatus({Reason::kUploadNotFound, "no such upload"});
    }
    response->set_committed_size(static_cast<std::int64_t>(state_.record.uploaded.size()));
    response->set_complete(complete_);
    return grpc::Status::OK;
  }

 private:
  void waitWhileHanging(const grpc::ServerContext& context) const {
    while (state_.script.hang && !context.IsCancelled()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  // Counts the call and notes its token; the number of calls before it.
  std::size_t enter(const grpc::ServerContext& context) {
    const std::lock_guard lock(state_.mutex);
    const auto token = context.client_metadata().find("authorization");
    if (token != context.client_metadata().end()) {
      state_.record.token.assign(token->second.data(), token->second.size());
    }
    return static_cast<std::size_t>(state_.record.signature_calls++);
  }

  State& state_;
  bool complete_ = false;
};

class FakeCatalog final : public v1::CatalogService::Service {
 public:
  explicit FakeCatalog(State& state) : state_(state) {}

  grpc::Status IngestShapes(grpc::ServerContext*,
                            grpc::ServerReaderWriter<v1::IngestShapesResponse,
                                                     v1::IngestShapesRequest>* stream) override {
    const bool first = countStream();
    int items = 0;
    v1::IngestShapesRequest request;
    while (stream->Read(&request)) {
      if (!request.has_item()) continue;
      v1::IngestShapesResponse response;
      response.set_index(request.item().index());
      response.set_outcome(answer(request.item()));
      const bool sent = request.item().probe_digest().empty();
      if (sent && ++items == state_.script.break_ingest_after && first) {
        return kBroken;  // Stored, and the client does not get to know.
      }
      stream->Write(response);
    }
    return grpc::Status::OK;
  }

 private:
  bool countStream() {
    const std::lock_guard lock(state_.mutex);
    return state_.record.ingest_streams++ == 0;
  }

  v1::IngestShapesResponse::Outcome answer(const v1::IngestShapesRequest::Item& item) {
    const std::lock_guard lock(state_.mutex);
    if (state_.record.stored.contains(item.shape_id())) return v1::IngestShapesResponse::SKIPPED;
    if (!item.probe_digest().empty()) return v1::IngestShapesResponse::MISSING;
    ++state_.record.stored[item.shape_id()];
    return v1::IngestShapesResponse::ADDED;
  }

  State& state_;
};

}  // namespace

struct FakeServer::Impl {
  explicit Impl(const FakeScript& script) : state(script), geometry(state), catalog(state) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.SetMaxReceiveMessageSize(8 << 20);
    if (script.knows_nothing) {
      builder.RegisterCallbackGenericService(&nothing);
    } else {
      builder.RegisterService(&geometry);
      builder.RegisterService(&catalog);
    }
    server = builder.BuildAndStart();
  }

  State state;
  FakeGeometry geometry;
  FakeCatalog catalog;
  // Answers every method with UNIMPLEMENTED.
  grpc::CallbackGenericService nothing;
  int port = 0;
  std::unique_ptr<grpc::Server> server;
};

FakeServer::FakeServer(const FakeScript& script) : impl_(std::make_unique<Impl>(script)) {}

FakeServer::~FakeServer() {
  impl_->server->Shutdown(std::chrono::system_clock::now());
}

std::string FakeServer::address() const {
  return "127.0.0.1:" + std::to_string(impl_->port);
}

FakeRecord FakeServer::record() const {
  const std::lock_guard lock(impl_->state.mutex);
  return impl_->state.record;
}

}  // namespace moduli
