#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace moduli::cli {

/// One line on standard error that says how far the work is, drawn only on a terminal and only for
/// work that lasts longer than a second; gone when the bar is. Thread-safe.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// fraction: in [0, 1].
  void update(const std::string& label, double fraction);

 private:
  using Clock = std::chrono::steady_clock;

  const bool enabled_;
  const Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  Clock::time_point last_{};
  bool drawn_ = false;
};

}  // namespace moduli::cli
