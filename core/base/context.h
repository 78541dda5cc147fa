#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/status.h"

namespace moduli {

/// A flag that one side raises and the running work reads. Copies share the flag. Thread-safe.
class CancelToken {
 public:
  CancelToken() : raised_(std::make_shared<std::atomic<bool>>(false)) {}
  void cancel() { raised_->store(true, std::memory_order_relaxed); }
  bool cancelled() const { return raised_->load(std::memory_order_relaxed); }

 private:
  std::shared_ptr<std::atomic<bool>> raised_;
};

/// How far a long computation is. fraction is in [0, 1] within the named stage.
struct Progress {
  std::string_view stage;
  double fraction = 0;
};

/// What every long function gets first: may I go on, whom do I tell, where do I note the time.
///
///   Result<X> work(Context& context, ...) {
///     Context::Stage stage(context, "factorize");   // timed until the scope ends
///     for (...) { RETURN_IF_ERROR(context.check()); ... }
///   }
///
/// One Context belongs to one computation and one thread at a time; check() alone may be called
/// from several threads at once.
class Context {
 public:
  using Clock = std::chrono::steady_clock;
  using ProgressSink = std::function<void(const Progress&)>;

  /// No deadline, never cancelled, silent.
  Context() = default;

  void setDeadline(Clock::time_point deadline) { deadline_ = deadline; }
  void setCancelToken(CancelToken token) { token_ = std::move(token); }
  void setProgressSink(ProgressSink sink) { sink_ = std::move(sink); }

  /// kCancelled or kDeadlineExceeded when the work should stop, otherwise OK. Costs some 50 ns;
  /// call it once per ten thousand elements or per solver step.
  Status check() const;

  /// Tells the listener, if any.
  void report(std::string_view stage, double fraction);

  /// Seconds spent in each stage so far, by name; a stage entered twice adds up.
  const std::map<std::string, double>& timing() const { return timing_; }

  /// Times a stage and reports its start and its end.
  class Stage {
   public:
    Stage(Context& context, std::string name);
    ~Stage();
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

   private:
    Context& context_;
    std::string name_;
    Clock::time_point start_;
  };

 private:
  std::optional<Clock::time_point> deadline_;
  std::optional<CancelToken> token_;
  ProgressSink sink_;
  std::map<std::string, double> timing_;
};

}  // namespace moduli
