#pragma once

#include <grpcpp/channel.h>

#include <memory>
#include <string>
#include <utility>

#include "client/cpp/call.h"
#include "client/cpp/client.h"
#include "moduli/v1/catalog.grpc.pb.h"
#include "moduli/v1/geometry_service.grpc.pb.h"
#include "moduli/v1/optimize.grpc.pb.h"
#include "server/rpc/grpc_status.h"

namespace moduli {

/// The stubs behind a Client. Internal.
struct Client::Impl {
  Impl(const std::shared_ptr<grpc::Channel>& channel, const ClientOptions& options)
      : runner(options),
        geometry(v1::GeometryService::NewStub(channel)),
        catalog(v1::CatalogService::NewStub(channel)),
        optimize(v1::OptimizeService::NewStub(channel)) {}

  template <typename Response, typename Stub, typename Request>
  Result<Response> unary(bool idempotent, Stub& stub,
                         grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                      Response*),
                         const Request& request) {
    Response response;
    RETURN_IF_ERROR(runner.run(idempotent, [&](grpc::ClientContext& context) {
      return (stub.*method)(&context, request, &response);
    }));
    return response;
  }

  /// Our status of a call that has ended; an interruption or a passed deadline says so first.
  Status finished(const grpc::Status& status) const {
    if (status.ok()) return {};
    RETURN_IF_ERROR(runner.check());
    return fromGrpcStatus(status);
  }

  /// Sends a file with the given digest, from where the server has it.
  Status upload(const MeshBytes& bytes, const std::string& digest);
  /// One stream of an upload, from `offset` to the end.
  grpc::Status sendChunks(const MeshBytes& bytes, const std::string& digest, std::uint64_t offset,
                          Status& reading);

  /// bytes as a source: inline where small, uploaded under `digest` where not.
  Result<v1::MeshSource> source(const MeshBytes& bytes, const std::string& digest,
                                const std::string& name, v1::MeshSource::Format format,
                                std::uint64_t inline_limit = kInlineLimit);

  CallRunner runner;
  std::unique_ptr<v1::GeometryService::Stub> geometry;
  std::unique_ptr<v1::CatalogService::Stub> catalog;
  std::unique_ptr<v1::OptimizeService::Stub> optimize;
};

}  // namespace moduli
