#pragma once

#include <grpcpp/support/server_callback.h>

#include <memory>

#include "moduli/v1/geometry_service.pb.h"
#include "server/service/call.h"

namespace moduli {

/// UploadMesh: takes one chunk after the other to disk, on the I/O threads, and reads on when it is
/// there. Only finish_write commits.
class UploadCall final : public grpc::ServerReadReactor<v1::UploadMeshRequest>, public Call {
 public:
  static grpc::ServerReadReactor<v1::UploadMeshRequest>* answer(
      Backend& backend, const grpc::CallbackServerContext& rpc, v1::UploadMeshResponse& response);

  UploadCall(Backend& backend, v1::UploadMeshResponse& response);

  void stop(const Status& why) override;

 private:
  void OnReadDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  /// Takes chunk_ in. On an I/O thread.
  void takeChunk();
  Refusal checkChunk() const;
  /// What is there after chunk_; complete ends the call.
  Result<UploadState> storeChunk();

  void finish(const Status& status, const UploadState& state = {}, std::string_view field = {});

  v1::UploadMeshRequest chunk_;  ///< Belongs to gRPC while a read is under way, else to takeChunk.
  std::string digest_;           ///< Of the first chunk.
  v1::UploadMeshResponse& response_;  ///< gRPC's; not to be touched once finished_.
  bool finished_ = false;
  std::shared_ptr<UploadCall> self_;
};

}  // namespace moduli
