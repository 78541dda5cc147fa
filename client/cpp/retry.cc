#include "client/cpp/retry.h"

#include <algorithm>

namespace moduli {
namespace {

// SplitMix64, the usual mixer of counters.
std::uint64_t mix(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

}  // namespace

Backoff::Backoff(const RetryPolicy& policy, std::uint64_t seed) : policy_(policy), random_(seed) {}

bool Backoff::another() {
  if (attempts_ >= policy_.max_attempts) return false;
  ++attempts_;
  return true;
}

std::chrono::milliseconds Backoff::wait(std::chrono::milliseconds asked_by_server) {
  std::chrono::milliseconds full = policy_.first_wait;
  for (int i = 2; i < attempts_ && full < policy_.longest_wait; ++i) full *= 2;
  full = std::min(full, policy_.longest_wait);
  const auto half = full.count() / 2;
  const auto jitter =
      static_cast<std::int64_t>(mix(random_) % static_cast<std::uint64_t>(half + 1));
  return asked_by_server + std::chrono::milliseconds(full.count() - half + jitter);
}

void Backoff::reset() {
  attempts_ = 1;
}

}  // namespace moduli
