#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "core/base/status.h"

/// What the fuzzed readers must all keep to. A violation ends the program, which the fuzzer sees.
namespace moduli {

inline void require(bool truth, const char* what) {
  if (truth) return;
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}

inline void checkRefusal(const Status& status) {
  require(status.reason() != Reason::kInternal, "a refusal is not an internal error");
  require(status.message().starts_with("input:"), "a refusal names the file");
  require(status.message().find('\n') == std::string::npos, "a refusal is one line");
  require(!status.hint().empty(), "a refusal says what to do");
}

inline bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

}  // namespace moduli
