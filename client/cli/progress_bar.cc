#include "client/cli/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "client/cli/output.h"

namespace moduli::cli {
namespace {

constexpr int kWidth = 24;
constexpr std::chrono::milliseconds kBeforeFirst{1000};
constexpr std::chrono::milliseconds kBetween{100};

bool terminalTakesLines() {
  const char* terminal = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) == 1 &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

}  // namespace

ProgressBar::ProgressBar(bool wanted) : enabled_(wanted && terminalTakesLines()) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
}

void ProgressBar::update(const std::string& label, double fraction) {
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (now - start_ < kBeforeFirst || now - last_ < kBetween) return;
  last_ = now;
  drawn_ = true;
  const double share = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(share * kWidth);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r\x1b[K[%s] %3.0f%% %s", bar.c_str(), 100 * share,
               safe(label).substr(0, 48).c_str());
  std::fflush(stderr);
}

}  // namespace moduli::cli
