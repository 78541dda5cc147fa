#include "core/base/log.h"

#include <cstdio>
#include <mutex>
#include <utility>

namespace moduli {
namespace {

struct Hook {
  std::mutex mutex;
  LogSink sink = [](LogLevel level, std::string_view message) {
    if (level < LogLevel::kWarning) return;
    std::fprintf(stderr, "moduli: %.*s\n", static_cast<int>(message.size()), message.data());
  };
};

Hook& hook() {
  static Hook instance;
  return instance;
}

}  // namespace

void setLogSink(LogSink sink) {
  const std::lock_guard lock(hook().mutex);
  hook().sink = std::move(sink);
}

void log(LogLevel level, std::string_view message) {
  const std::lock_guard lock(hook().mutex);
  if (hook().sink) hook().sink(level, message);
}

}  // namespace moduli
