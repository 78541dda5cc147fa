#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>
#include <memory>
#include <utility>

#include "server/rpc/grpc_status.h"
#include "server/service/call.h"

namespace moduli {

/// A call with one answer, worked out on the I/O threads:
///
///   return UnaryCall<v1::Collection>::answer(backend, *rpc, *response, {"GetCollection"}, refusal,
///                                            [=](Context&) -> Result<v1::Collection> { ... });
template <typename Response>
class UnaryCall final : public grpc::ServerUnaryReactor, public Call {
 public:
  using Work = std::function<Result<Response>(Context&)>;

  /// refusal: a fault of the request found already, if any. work: owns what it uses.
  static grpc::ServerUnaryReactor* answer(Backend& backend, const grpc::CallbackServerContext& rpc,
                                          Response& response, const CallKind& kind,
                                          const Refusal& refusal, Work work) {
    auto call = std::make_shared<UnaryCall>(backend, response, kind);
    call->self_ = call;
    call->start(rpc, refusal, std::move(work));
    return call.get();
  }

  UnaryCall(Backend& backend, Response& response, const CallKind& kind)
      : Call(backend, kind), response_(response) {}

  void stop(const Status& why) override {
    token_.cancel();
    finish(why);
  }

 private:
  void start(const grpc::CallbackServerContext& rpc, const Refusal& refusal, Work work) {
    if (const Status status = admit(rpc, self_); !status.ok()) return finish(status);
    if (!refusal.ok()) return finish(refusal.status, {}, refusal.field);
    const Status taken = backend_.io.submit([self = self_, work = std::move(work)] {
      Context context = self->makeContext();
      const auto result = guarded([&]() -> Result<Response> {
        RETURN_IF_ERROR(context.check());
        return work(context);
      });
      self->finish(result.status(), result.ok() ? &*result : nullptr);
    });
    if (!taken.ok()) finish(taken);
  }

  void finish(const Status& status, const Response* response = nullptr,
              std::string_view field = {}) {
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    finished_ = true;
    logEnd(status);
    if (response != nullptr) response_ = *response;
    Finish(toGrpcStatus(status, field));
  }

  void OnCancel() override { stop(cancelReason()); }

  void OnDone() override {
    ticket_ = {};
    const auto self = std::move(self_);
  }

  Response& response_;  ///< gRPC's; not to be touched once finished_.
  bool finished_ = false;
  std::shared_ptr<UnaryCall> self_;
};

}  // namespace moduli
