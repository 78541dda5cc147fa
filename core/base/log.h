#pragma once

#include <functional>
#include <string_view>

namespace moduli {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

using LogSink = std::function<void(LogLevel, std::string_view message)>;

/// Replaces the receiver of log lines (default: warnings and errors go to stderr). Thread-safe, but
/// meant to be called once, by main.
void setLogSink(LogSink sink);

/// Hands one line, without its newline, to the receiver. Thread-safe.
void log(LogLevel level, std::string_view message);

}  // namespace moduli
