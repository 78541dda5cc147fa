#include <utility>

#include "moduli/v1/optimize.grpc.pb.h"
#include "server/service/event_stream.h"
#include "server/service/optimize_request.h"
#include "server/service/optimizing.h"
#include "server/service/services.h"

namespace moduli {
namespace {

Result<EventStream<v1::MinimizeResponse>::Parts> answer(Context& context, const Backend& backend,
                                                        const v1::MinimizeRequest& request) {
  ASSIGN_OR_RETURN(Optimized optimized, optimizeFunction(context, backend, request));
  return optimizationParts(std::make_shared<const Optimized>(std::move(optimized)));
}

class OptimizeService final : public v1::OptimizeService::CallbackService {
 public:
  explicit OptimizeService(Backend& backend) : backend_(backend) {}

  grpc::ServerWriteReactor<v1::MinimizeResponse>* Minimize(
      grpc::CallbackServerContext* rpc, const v1::MinimizeRequest* request) override {
    return EventStream<v1::MinimizeResponse>::answerInParts(
        backend_, *rpc, {"Minimize"}, checkMinimize(*request),
        [this, kept = std::make_shared<v1::MinimizeRequest>(*request)](Context& context) {
          return answer(context, backend_, *kept);
        });
  }

 private:
  Backend& backend_;
};

}  // namespace

std::unique_ptr<grpc::Service> makeOptimizeService(Backend& backend) {
  return std::make_unique<OptimizeService>(backend);
}

}  // namespace moduli
