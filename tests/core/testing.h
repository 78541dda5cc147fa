#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "core/base/status.h"

/// What tests of every room share.
namespace moduli {

/// Path of a real mesh such as "genus1/cfwen__torus.off": below $MODULI_SHARED, or below ../shared
/// beside the source tree. Nothing if the folder or the file is missing.
std::optional<std::string> sharedMesh(const std::string& name);

/// All files in a subfolder of the real meshes, sorted, with paths as sharedMesh gives them.
std::vector<std::string> sharedMeshes(const std::string& folder);

inline const Status& statusOf(const Status& status) {
  return status;
}
template <typename T>
Status statusOf(const Result<T>& result) {
  return result.status();
}

MATCHER(IsOk, "is OK") {
  const Status status = statusOf(arg);
  if (!status.ok()) *result_listener << status.toString();
  return status.ok();
}

MATCHER_P(FailsWith, reason, std::string("fails with ") + std::string(reasonName(reason))) {
  const Status status = statusOf(arg);
  *result_listener << status.toString();
  return status.reason() == reason;
}

}  // namespace moduli

/// Skips the running test, saying why, where the real meshes are not there.
#define MODULI_NEED_SHARED_MESH(variable, name)                       \
  const auto variable##_path = ::moduli::sharedMesh(name);            \
  if (!variable##_path)                                               \
    GTEST_SKIP() << "needs the shared mesh " << (name)                \
                 << "; set MODULI_SHARED to the folder with meshes/"; \
  const std::string& variable = *variable##_path

#define ASSERT_OK(expression) ASSERT_THAT((expression), ::moduli::IsOk())
#define EXPECT_OK(expression) EXPECT_THAT((expression), ::moduli::IsOk())
