#include "server/service/call.h"

#include <grpcpp/server_context.h>

#include "core/base/log.h"

namespace moduli {
namespace {

using Clock = Context::Clock;

std::optional<Clock::time_point> deadlineOf(const grpc::CallbackServerContext& rpc) {
  const auto deadline = rpc.deadline();
  if (deadline == std::chrono::system_clock::time_point::max()) return {};
  const auto left = deadline - std::chrono::system_clock::now();
  // "Never" of other clients: more than a year.
  if (left > std::chrono::hours(24 * 366)) return {};
  return Clock::now() + left;
}

std::string authorizationOf(const grpc::CallbackServerContext& rpc) {
  const auto found = rpc.client_metadata().find("authorization");
  if (found == rpc.client_metadata().end()) return {};
  return {found->second.data(), found->second.size()};
}

bool blamesTheServer(ErrorCode code) {
  return code == ErrorCode::kInternal || code == ErrorCode::kDataLoss;
}

}  // namespace

Call::Call(Backend& backend, const CallKind& kind) : backend_(backend), kind_(kind) {}

Call::~Call() = default;

Status Call::admit(const grpc::CallbackServerContext& rpc, const std::weak_ptr<LiveCall>& self) {
  deadline_ = deadlineOf(rpc);
  RETURN_IF_ERROR(backend_.access.check(authorizationOf(rpc), kind_.role));
  ASSIGN_OR_RETURN(ticket_, backend_.calls.enter(self));
  return {};
}

Context Call::makeContext() const {
  Context context;
  if (deadline_) context.setDeadline(*deadline_);
  context.setCancelToken(token_);
  return context;
}

Status Call::cancelReason() const {
  // gRPC's timer and ours may differ by a little.
  constexpr auto kSlack = std::chrono::milliseconds(10);
  if (deadline_ && Clock::now() + kSlack >= *deadline_) {
    return {Reason::kDeadlineExceeded, "the deadline passed before the work was done",
            "allow more time with --timeout"};
  }
  return {Reason::kCancelled, "the caller cancelled the call"};
}

void Call::logEnd(const Status& status) const {
  if (!backend_.log_calls) return;
  const auto elapsed =
      std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start_).count();
  const LogLevel level = status.ok()                              ? LogLevel::kDebug
                         : blamesTheServer(status.code())         ? LogLevel::kError
                         : status.code() == ErrorCode::kCancelled ? LogLevel::kInfo
                                                                  : LogLevel::kWarning;
  log(level, std::string(kind_.method) + " " + std::to_string(elapsed) + " ms " +
                 (status.ok() ? "OK" : status.toString()));
}

bool ProgressThrottle::due(const Progress& progress) {
  constexpr auto kInterval = std::chrono::milliseconds(100);
  const auto now = Clock::now();
  if (progress.stage == stage_ && now - last_ < kInterval) return false;
  stage_ = progress.stage;
  last_ = now;
  return true;
}

}  // namespace moduli
