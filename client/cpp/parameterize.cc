#include <optional>
#include <utility>

#include "client/cpp/array_answer.h"
#include "client/cpp/client_impl.h"

namespace moduli {

Result<ParameterizedMesh> Client::parameterize(const v1::ParameterizeRequest& request) {
  std::optional<ArrayAnswer<ArrayAssembler, v1::Parameterization>> answer;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) -> grpc::Status {
    answer.emplace(ArrayAssembler());
    const auto reader = impl_->geometry->Parameterize(&context, request);
    return answer->read<v1::ParameterizeResponse>(
        impl_->runner, context, *reader,
        [](v1::ParameterizeResponse& response) -> v1::Parameterization* {
          return response.has_parameterization() ? response.mutable_parameterization() : nullptr;
        });
  }));
  RETURN_IF_ERROR(answer->checkResult());
  ParameterizedMesh mesh;
  if (!request.omit_arrays()) {
    ASSIGN_OR_RETURN(mesh, answer->arrays().finish());
  }
  mesh.result = answer->takeResult();
  if (!request.omit_arrays()) RETURN_IF_ERROR(checkGeodesics(mesh));
  return mesh;
}

}  // namespace moduli
