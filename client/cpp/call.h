#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <set>

#include "client/cpp/client.h"
#include "client/cpp/retry.h"
#include "core/base/status.h"

/// What all calls of one client share: deadline, token, cancellation, retries. Internal.
namespace moduli {

/// Thread-safe.
class CallRunner {
 public:
  explicit CallRunner(const ClientOptions& options);

  /// One attempt of a call with its context, alive as long as this object.
  class Attempt {
   public:
    explicit Attempt(CallRunner& runner);
    ~Attempt();
    Attempt(const Attempt&) = delete;
    Attempt& operator=(const Attempt&) = delete;

    grpc::ClientContext& context() { return *context_; }

   private:
    CallRunner& runner_;
    std::shared_ptr<grpc::ClientContext> context_;
  };

  using Call = std::function<grpc::Status(grpc::ClientContext&)>;

  /// Runs a call, again and again where `idempotent` and the policy allow it.
  Status run(bool idempotent, const Call& call);

  /// Whether another attempt may help; waits before saying yes.
  bool waitToRetry(const grpc::Status& failure, Backoff& backoff);

  Backoff makeBackoff() const;
  void report(const v1::Progress& progress) const;

  /// Ends running calls with CANCELLED and refuses later ones.
  void cancel();
  bool cancelled() const;
  /// kCancelled after cancel(), kDeadlineExceeded after the deadline.
  Status check() const;

 private:
  const ClientOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::set<std::shared_ptr<grpc::ClientContext>> active_;
  bool cancelled_ = false;
};

}  // namespace moduli
