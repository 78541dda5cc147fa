#pragma once

#include <string>
#include <string_view>

#include "core/mesh/read.h"
#include "tests/core/testing.h"

/// What the tests of the readers share.
namespace moduli {

inline Result<TriangleSoup> parse(std::string_view bytes, const std::string& name) {
  Context context;
  ReadOptions options;
  options.name = name;
  return readMesh(context, bytes, options);
}

/// A failure with this reason whose message contains `text`; the file's name and the place come
/// first: "part.obj:3: a face".
MATCHER_P2(FailsAt, reason, text,
           std::string("fails with ") + std::string(reasonName(reason)) + " at " + text) {
  const Status status = statusOf(arg);
  *result_listener << status.toString();
  return status.reason() == reason && status.message().starts_with(text) &&
         !status.hint().empty() && status.message().find('\n') == std::string::npos;
}

inline TriangleSoup tetrahedronSoup() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

}  // namespace moduli
