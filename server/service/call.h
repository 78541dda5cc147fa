#pragma once

#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/context.h"
#include "server/service/access.h"
#include "server/service/backend.h"

namespace grpc {
class CallbackServerContext;
}

namespace moduli {

/// What is wrong with a request, and in which of its fields.
struct Refusal {
  Status status;
  std::string field;  ///< Path such as "source.digest"; "" where no single one is to blame.

  bool ok() const { return status.ok(); }
};

/// What a call is and who may make it.
struct CallKind {
  std::string_view method;
  Role role = Role::kReader;
};

/// What every reactor of ours has: its place among the calls under way, its deadline, and the flag
/// that stops its work. A reactor keeps itself alive until OnDone, and a job keeps the reactor of
/// its call alive; what a job says after the call has been answered is dropped.
class Call : public LiveCall {
 public:
  Call(Backend& backend, const CallKind& kind);
  ~Call() override;

  /// Cancellation and deadline of this call, for work that is done for it.
  Context makeContext() const;

 protected:
  /// Asks whether the server takes the call and the caller may make it. To be called first.
  Status admit(const grpc::CallbackServerContext& rpc, const std::weak_ptr<LiveCall>& self);

  /// Why gRPC says that the call has been cancelled: its deadline, or its caller.
  Status cancelReason() const;

  /// Writes the call's end into the log.
  void logEnd(const Status& status) const;

  Backend& backend_;
  CancelToken token_;
  std::mutex mutex_;  ///< Of the reactor's own state.

 private:
  const CallKind kind_;
  const Context::Clock::time_point start_ = Context::Clock::now();
  std::optional<Context::Clock::time_point> deadline_;

 protected:
  CallRegistry::Ticket ticket_;  ///< Given back in OnDone.
};

/// Runs work that returns a Status or a Result, and turns an exception into a failure, because none
/// may reach gRPC or the executor.
template <typename Work>
auto guarded(Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return Status(Reason::kMeshTooLarge, "there is not enough memory for this mesh",
                  "use a machine with more memory, or a coarser mesh");
  } catch (const std::exception& error) {
    return Status(Reason::kInternal, error.what());
  }
}

/// Passes on a first message of every stage and then at most one each 100 ms. For one thread.
class ProgressThrottle {
 public:
  bool due(const Progress& progress);

 private:
  std::string stage_;
  Context::Clock::time_point last_{};
};

}  // namespace moduli
