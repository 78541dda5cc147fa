#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "core/base/status.h"

namespace moduli {

/// A call under way, as the one sees it who may have to end it.
class LiveCall {
 public:
  virtual ~LiveCall() = default;
  /// Answers the caller with `why` now and tells the work to stop.
  virtual void stop(const Status& why) = 0;
  /// The server is going to end: take no more work over an open stream.
  virtual void drain() {}
};

/// All calls under way. Thread-safe. Tickets keep its state alive.
class CallRegistry {
 public:
  class Ticket;

  CallRegistry();
  ~CallRegistry();

  /// Lists a call until its ticket dies. Fails with kServerDraining after close().
  Result<Ticket> enter(std::weak_ptr<LiveCall> call);

  /// Refuses new calls and drains those under way. Later calls do nothing.
  void close();

  /// Ends every call under way.
  void stopAll(const Status& why);

  /// True once no call is under way; false at the deadline.
  bool waitUntilEmpty(std::chrono::steady_clock::time_point deadline);

  std::size_t size() const;

 private:
  struct State;
  std::vector<std::shared_ptr<LiveCall>> living() const;

  std::shared_ptr<State> state_;
};

class CallRegistry::Ticket {
 public:
  Ticket() = default;
  Ticket(Ticket&& other) noexcept;
  Ticket& operator=(Ticket&& other) noexcept;
  ~Ticket();

 private:
  friend class CallRegistry;
  Ticket(std::shared_ptr<State> state, std::uint64_t id);
  void release();

  std::shared_ptr<State> state_;
  std::uint64_t id_ = 0;
};

}  // namespace moduli
