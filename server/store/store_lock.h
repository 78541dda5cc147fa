#pragma once

#include <filesystem>

#include "core/base/status.h"
#include "server/store/file_io.h"

namespace moduli {

/// Holds a store's folder for one process while it lives; the system lets go of it when the
/// process ends, however that happens. Movable.
class StoreLock {
 public:
  /// Locks FOLDER/lock and writes there who holds it. Fails at once with kStoreLocked naming
  /// process, host and since when, or with kStoreFailure.
  static Result<StoreLock> acquire(const std::filesystem::path& folder);

 private:
  explicit StoreLock(File file) : file_(std::move(file)) {}
  File file_;
};

}  // namespace moduli
