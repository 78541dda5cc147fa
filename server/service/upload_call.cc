#include "server/service/upload_call.h"

#include "server/rpc/grpc_status.h"
#include "server/service/request.h"

namespace moduli {

grpc::ServerReadReactor<v1::UploadMeshRequest>* UploadCall::answer(
    Backend& backend, const grpc::CallbackServerContext& rpc, v1::UploadMeshResponse& response) {
  auto call = std::make_shared<UploadCall>(backend, response);
  call->self_ = call;
  if (const Status status = call->admit(rpc, call); !status.ok()) {
    call->finish(status);
  } else {
    call->StartRead(&call->chunk_);
  }
  return call.get();
}

UploadCall::UploadCall(Backend& backend, v1::UploadMeshResponse& response)
    : Call(backend, {"UploadMesh"}), response_(response) {}

void UploadCall::OnReadDone(bool ok) {
  if (!ok) {
    // Half-close, cancellation and an over-size message all end here: nothing is committed.
    return finish({Reason::kInvalidRequest, "the stream ended before finish_write",
                   "ask QueryUpload how much is there, and go on from that offset"});
  }
  backend_.io.submitWhenRoom([self = self_] { self->takeChunk(); });
}

void UploadCall::takeChunk() {
  if (token_.cancelled()) return;
  if (digest_.empty()) digest_ = chunk_.digest();
  if (const Refusal refusal = checkChunk(); !refusal.ok()) {
    return finish(refusal.status, {}, refusal.field);
  }
  const Result<UploadState> state = guarded([this] { return storeChunk(); });
  if (!state.ok()) return finish(state.status());
  if (state->complete) return finish({}, *state);
  const std::lock_guard lock(mutex_);
  if (!finished_) StartRead(&chunk_);
}

Refusal UploadCall::checkChunk() const {
  if (Refusal refusal = checkDigest(chunk_.digest(), "digest"); !refusal.ok()) return refusal;
  if (chunk_.digest() != digest_) {
    return {{Reason::kInvalidRequest, "the digest changes within the stream",
             "send one file per stream"},
            "digest"};
  }
  if (chunk_.data().size() > kMaxChunkBytes) {
    return {{Reason::kMessageTooLarge,
             "a chunk of " + std::to_string(chunk_.data().size()) +
                 " bytes is above the limit of " + std::to_string(kMaxChunkBytes),
             "send smaller chunks"},
            "data"};
  }
  if (chunk_.write_offset() < 0) {
    return {{Reason::kInvalidRequest, "write_offset is negative", "count bytes from 0"},
            "write_offset"};
  }
  return {};
}

Result<UploadState> UploadCall::storeChunk() {
  UploadStore& uploads = backend_.store->uploads();
  // Asked each time, because another stream may have completed the file meanwhile.
  ASSIGN_OR_RETURN(UploadState state, uploads.query(digest_));
  if (state.complete) return state;
  if (!chunk_.data().empty() || !chunk_.finish_write()) {
    ASSIGN_OR_RETURN(state, uploads.append(digest_, chunk_.write_offset(), chunk_.data()));
  }
  if (!chunk_.finish_write() || state.complete) return state;
  ASSIGN_OR_RETURN(const MeshPin pin, uploads.finish(digest_, chunk_.total_size()));
  return UploadState{.committed_size = pin.size(), .complete = true};
}

void UploadCall::finish(const Status& status, const UploadState& state, std::string_view field) {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  finished_ = true;
  logEnd(status);
  if (status.ok()) {
    response_.set_digest(digest_);
    response_.set_committed_size(state.committed_size);
  }
  Finish(toGrpcStatus(status, field));
}

void UploadCall::stop(const Status& why) {
  token_.cancel();
  finish(why);
}

void UploadCall::OnCancel() {
  stop(cancelReason());
}

void UploadCall::OnDone() {
  ticket_ = {};
  const auto self = std::move(self_);
}

}  // namespace moduli
