#include <optional>
#include <utility>

#include "client/cpp/array_answer.h"
#include "client/cpp/client_impl.h"

namespace moduli {
namespace {

template <typename Message, typename ResultOf>
auto answerOf(CallRunner& runner, v1::OptimizeService::Stub& stub,
              const v1::MinimizeRequest& request, ResultOf result_of)
    -> decltype(MinimizeAssembler(request).finish(Message())) {
  std::optional<ArrayAnswer<MinimizeAssembler, Message>> answer;
  RETURN_IF_ERROR(runner.run(true, [&](grpc::ClientContext& context) -> grpc::Status {
    answer.emplace(MinimizeAssembler(request));
    const auto reader = stub.Minimize(&context, request);
    return answer->template read<v1::MinimizeResponse>(runner, context, *reader, result_of);
  }));
  RETURN_IF_ERROR(answer->checkResult());
  return answer->arrays().finish(answer->takeResult());
}

}  // namespace

Result<MinimizedFunction> Client::minimize(const v1::MinimizeRequest& request) {
  return answerOf<v1::Minimization>(
      impl_->runner, *impl_->optimize, request,
      [](v1::MinimizeResponse& response) -> v1::Minimization* {
        return response.has_minimization() ? response.mutable_minimization() : nullptr;
      });
}

Result<v1::AffineDirection> Client::affineNormal(const v1::MinimizeRequest& request) {
  v1::MinimizeRequest bare = request;
  bare.set_trace(false);
  bare.set_path(false);
  return answerOf<v1::AffineDirection>(
      impl_->runner, *impl_->optimize, bare,
      [](v1::MinimizeResponse& response) -> v1::AffineDirection* {
        return response.has_direction() ? response.mutable_direction() : nullptr;
      });
}

}  // namespace moduli
