#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "server/rpc/grpc_status.h"
#include "server/service/call.h"

namespace moduli {

/// A call answered by a stream: Progress messages (the latest one, if the caller reads slowly), and
/// results one after the other. Any thread may call any method; what comes after the end is
/// dropped.
template <typename Response>
class EventStream final : public grpc::ServerWriteReactor<Response>, public Call {
 public:
  using Self = std::shared_ptr<EventStream>;
  using Work = std::function<Result<Response>(Context&)>;
  /// Hands out one result a call, and nothing after the last. Costs no more than a copy.
  using Parts = std::function<std::optional<Response>()>;
  using PartsWork = std::function<Result<Parts>(Context&)>;

  /// A stream of Progress and one result, computed by `work`, which owns what it uses.
  static grpc::ServerWriteReactor<Response>* answer(Backend& backend,
                                                    const grpc::CallbackServerContext& rpc,
                                                    const CallKind& kind, const Refusal& refusal,
                                                    Work work) {
    return open(backend, rpc, kind, refusal, [work = std::move(work)](const Self& self) {
      self->progress({"queued", 0});
      return self->backend_.compute.submit([self, work] {
        auto result = self->template compute<Response>(work);
        if (result.ok()) self->send(*std::move(result));
        self->end(result.status());
      });
    });
  }

  /// A stream of Progress and a result in parts, computed by `work`. The computing thread is free
  /// when the parts are there: however slow the reader, they are sent as it takes them.
  static grpc::ServerWriteReactor<Response>* answerInParts(Backend& backend,
                                                           const grpc::CallbackServerContext& rpc,
                                                           const CallKind& kind,
                                                           const Refusal& refusal, PartsWork work) {
    return open(backend, rpc, kind, refusal, [work = std::move(work)](const Self& self) {
      self->progress({"queued", 0});
      return self->backend_.compute.submit([self, work] {
        auto parts = self->template compute<Parts>(work);
        if (!parts.ok()) return self->end(parts.status());
        sendParts(self, *std::move(parts));
      });
    });
  }

  /// A stream that `begin` starts to fill by send() and end(), if nothing is to be refused.
  static grpc::ServerWriteReactor<Response>* open(Backend& backend,
                                                  const grpc::CallbackServerContext& rpc,
                                                  const CallKind& kind, const Refusal& refusal,
                                                  const std::function<Status(const Self&)>& begin) {
    auto call = std::make_shared<EventStream>(backend, kind);
    call->self_ = call;
    Refusal found{call->admit(rpc, call), {}};
    if (found.ok()) found = refusal;
    if (found.ok()) found.status = begin(call);
    if (!found.ok()) call->end(found.status, found.field);
    return call.get();
  }

  EventStream(Backend& backend, const CallKind& kind) : Call(backend, kind) {}

  /// Sends one result. `sent` is called, on a thread of gRPC, when there is room for the next one,
  /// and not at all if the call has ended.
  void send(Response response, std::function<void()> sent = {}) {
    const std::lock_guard lock(mutex_);
    if (closed_ || end_) return;
    result_ = std::move(response);
    sent_ = std::move(sent);
    pump();
  }

  /// Ends the call, after the results sent so far where status is OK.
  void end(const Status& status, std::string_view field = {}) {
    const std::lock_guard lock(mutex_);
    if (closed_ || end_) return;
    if (!status.ok()) dropUnsent();
    logEnd(status);
    end_ = toGrpcStatus(status, field);
    pump();
  }

  void stop(const Status& why) override {
    token_.cancel();
    end(why);
  }

 private:
  template <typename Value>
  Result<Value> compute(const std::function<Result<Value>(Context&)>& work) {
    Context context = makeContext();
    ProgressThrottle throttle;
    context.setProgressSink([this, &throttle](const Progress& progress_now) {
      if (throttle.due(progress_now)) progress(progress_now);
    });
    return guarded([&]() -> Result<Value> {
      RETURN_IF_ERROR(context.check());
      return work(context);
    });
  }

  static void sendParts(const Self& self, const Parts& parts) {
    Result<std::optional<Response>> part =
        guarded([&]() -> Result<std::optional<Response>> { return parts(); });
    if (!part.ok()) return self->end(part.status());
    if (!*part) return self->end({});
    self->send(**std::move(part), [self, parts] { sendParts(self, parts); });
  }

  void progress(const Progress& progress_now) {
    if constexpr (requires(Response response) { response.mutable_progress(); }) {
      const std::lock_guard lock(mutex_);
      if (closed_ || end_ || result_) return;
      Response& response = progress_.emplace();
      response.mutable_progress()->set_stage(std::string(progress_now.stage));
      response.mutable_progress()->set_fraction(progress_now.fraction);
      pump();
    }
  }

  void dropUnsent() {
    progress_.reset();
    result_.reset();
    sent_ = nullptr;
  }

  /// Starts the next operation, if none is under way. Under mutex_.
  void pump() {
    if (closed_ || writing_) return;
    std::optional<Response>& next = progress_ ? progress_ : result_;
    if (next) {
      writing_ = true;
      writing_result_ = &next == &result_;
      current_ = std::move(*next);
      next.reset();
      this->StartWrite(&current_);
    } else if (end_) {
      closed_ = true;
      this->Finish(*end_);
    }
  }

  void OnWriteDone(bool ok) override {
    std::function<void()> sent;
    {
      const std::lock_guard lock(mutex_);
      writing_ = false;
      if (ok && writing_result_) sent = std::exchange(sent_, {});
      if (!ok) dropUnsent();
      pump();
    }
    if (!ok) return stop(cancelReason());
    if (sent) sent();
  }

  void OnCancel() override { stop(cancelReason()); }

  void OnDone() override {
    ticket_ = {};
    const auto self = std::move(self_);
  }

  bool writing_ = false;
  bool writing_result_ = false;
  bool closed_ = false;  ///< Finish has been called.
  Response current_;     ///< Belongs to gRPC while writing_.
  std::optional<Response> progress_, result_;
  std::function<void()> sent_;
  std::optional<grpc::Status> end_;
  Self self_;
};

}  // namespace moduli
