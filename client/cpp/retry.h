#pragma once

#include <chrono>
#include <cstdint>

namespace moduli {

/// When a failed call is tried again: only calls that may safely run twice, only when the server
/// could not be reached or had no room, and only as long as the deadline allows.
struct RetryPolicy {
  int max_attempts = 4;  ///< Together with the first one; 1: never again.
  std::chrono::milliseconds first_wait{100};
  std::chrono::milliseconds longest_wait{5000};
};

/// Waits between attempts: doubling from first_wait to longest_wait, each drawn evenly from its
/// upper half so that many clients do not come back at once, and never shorter than what the server
/// asked for. Not thread-safe.
class Backoff {
 public:
  /// seed: any; the waits are a function of it.
  Backoff(const RetryPolicy& policy, std::uint64_t seed);

  /// False when all attempts are used up.
  bool another();
  /// The wait before the attempt that another() granted.
  std::chrono::milliseconds wait(std::chrono::milliseconds asked_by_server);
  /// Something went forward: the count of attempts and the waits start anew.
  void reset();

 private:
  RetryPolicy policy_;
  std::uint64_t random_;
  int attempts_ = 1;
};

}  // namespace moduli
