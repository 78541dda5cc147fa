#include <optional>
#include <utility>

#include "client/cpp/array_answer.h"
#include "client/cpp/client_impl.h"

namespace moduli {

Result<MatchedSurfaces> Client::match(const v1::MatchSurfacesRequest& request) {
  using Answer = ArrayAnswer<MatchAssembler, v1::SurfaceMatch>;
  std::optional<Answer> answer;
  RETURN_IF_ERROR(impl_->runner.run(true, [&](grpc::ClientContext& context) -> grpc::Status {
    answer.emplace(MatchAssembler(request.inverse()));
    const auto reader = impl_->geometry->MatchSurfaces(&context, request);
    return answer->read<v1::MatchSurfacesResponse>(
        impl_->runner, context, *reader,
        [](v1::MatchSurfacesResponse& response) -> v1::SurfaceMatch* {
          return response.has_match() ? response.mutable_match() : nullptr;
        });
  }));
  RETURN_IF_ERROR(answer->checkResult());
  MatchedSurfaces match;
  if (!request.omit_arrays()) {
    ASSIGN_OR_RETURN(match, answer->arrays().finish());
  }
  match.result = answer->takeResult();
  return match;
}

}  // namespace moduli
