#include "client/cpp/call.h"

#include <random>
#include <vector>

#include "server/rpc/grpc_status.h"

namespace moduli {
namespace {

bool worthRetrying(const grpc::Status& failure) {
  return failure.error_code() == grpc::StatusCode::UNAVAILABLE ||
         (failure.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED &&
          retryDelay(failure).count() > 0);
}

}  // namespace

CallRunner::CallRunner(const ClientOptions& options) : options_(options) {}

CallRunner::Attempt::Attempt(CallRunner& runner)
    : runner_(runner), context_(std::make_shared<grpc::ClientContext>()) {
  const ClientOptions& options = runner.options_;
  if (options.deadline) {
    // gRPC counts in the calendar's time, we in that of a stopwatch.
    const auto left = *options.deadline - std::chrono::steady_clock::now();
    context_->set_deadline(std::chrono::system_clock::now() +
                           std::chrono::duration_cast<std::chrono::system_clock::duration>(left));
  }
  if (!options.token.empty()) context_->AddMetadata("authorization", "Bearer " + options.token);
  bool cancelled = false;
  {
    const std::lock_guard lock(runner_.mutex_);
    cancelled = runner_.cancelled_;
    runner_.active_.insert(context_);
  }
  if (cancelled) context_->TryCancel();
}

CallRunner::Attempt::~Attempt() {
  const std::lock_guard lock(runner_.mutex_);
  runner_.active_.erase(context_);
}

Status CallRunner::run(bool idempotent, const Call& call) {
  Backoff backoff = makeBackoff();
  while (true) {
    grpc::Status status;
    {
      Attempt attempt(*this);
      status = call(attempt.context());
    }
    if (status.ok()) return {};
    if (!idempotent || !waitToRetry(status, backoff)) {
      RETURN_IF_ERROR(check());
      return fromGrpcStatus(status);
    }
  }
}

bool CallRunner::waitToRetry(const grpc::Status& failure, Backoff& backoff) {
  if (!worthRetrying(failure) || !backoff.another()) return false;
  const auto until = std::chrono::steady_clock::now() + backoff.wait(retryDelay(failure));
  if (options_.deadline && until >= *options_.deadline) return false;
  std::unique_lock lock(mutex_);
  return !wake_.wait_until(lock, until, [this] { return cancelled_; });
}

Backoff CallRunner::makeBackoff() const {
  return {options_.retry, std::random_device{}()};
}

void CallRunner::report(const v1::Progress& progress) const {
  if (options_.progress) options_.progress(progress);
}

void CallRunner::cancel() {
  std::vector<std::shared_ptr<grpc::ClientContext>> running;
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    running.assign(active_.begin(), active_.end());
  }
  wake_.notify_all();
  // Without our lock: gRPC may call back from here.
  for (const auto& context : running) context->TryCancel();
}

bool CallRunner::cancelled() const {
  const std::lock_guard lock(mutex_);
  return cancelled_;
}

Status CallRunner::check() const {
  if (cancelled()) return {Reason::kCancelled, "interrupted"};
  if (options_.deadline && std::chrono::steady_clock::now() >= *options_.deadline) {
    return {Reason::kDeadlineExceeded, "the deadline passed before the work was done",
            "allow more time with --timeout"};
  }
  return {};
}

}  // namespace moduli
