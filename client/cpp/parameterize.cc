#include <optional>
#include <utility>

#include "client/cpp/client_impl.h"

namespace moduli {
namespace {

/// What one attempt of the call has brought.
struct Answer {
  ArrayAssembler arrays;
  std::optional<v1::Parameterization> result;

  Status take(CallRunner& runner, v1::ParameterizeResponse& response) {
    if (response.has_progress()) {
      runner.report(response.progress());
    } else if (result) {
      return {Reason::kInternal, "the server's answer is broken: it goes on after the result",
              "try again; if it stays, update the server or this client"};
    } else if (response.has_array()) {
      return arrays.take(response.array());
    } else if (response.has_parameterization()) {
      result.emplace().Swap(response.mutable_parameterization());
    }
    return {};
  }
};

}  // namespace

Result<ParameterizedMesh> Client::parameterize(const v1::ParameterizeRequest& request) {
  Answer answer;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) -> grpc::Status {
    answer = {};
    const auto reader = impl_->geometry->Parameterize(&context, request);
    v1::ParameterizeResponse response;
    Status wrong;
    while (wrong.ok() && reader->Read(&response)) wrong = answer.take(impl_->runner, response);
    if (!wrong.ok()) context.TryCancel();
    const grpc::Status status = reader->Finish();
    return wrong.ok() ? status : toGrpcStatus(wrong);
  }));
  if (!answer.result) {
    return Status(Reason::kInternal, "the server ended its answer without a result", "try again");
  }
  ParameterizedMesh mesh;
  if (!request.omit_arrays()) {
    ASSIGN_OR_RETURN(mesh, answer.arrays.finish());
  }
  mesh.result = *std::move(answer.result);
  if (!request.omit_arrays()) RETURN_IF_ERROR(checkGeodesics(mesh));
  return mesh;
}

}  // namespace moduli
