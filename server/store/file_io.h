#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/base/status.h"

namespace moduli {

/// An open file, closed with the object. Failures are kStoreFailure and name the file and the
/// system's reason.
class File {
 public:
  enum class Mode { kRead, kCreate, kAppend, kFolder };

  /// kCreate: a new file for writing, which must not exist. kAppend: for writing at any place,
  /// created if missing. kFolder: to sync what was renamed in it.
  static Result<File> open(const std::filesystem::path& path, Mode mode);

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  /// At most `limit` bytes from the current place; "" at the end.
  Result<std::string> read(std::size_t limit);
  /// All of `bytes`, at the current place.
  Status write(std::string_view bytes);
  Status seek(std::int64_t offset);
  Status truncate(std::int64_t size);
  Result<std::int64_t> size() const;
  /// Returns when data and size are on the disk.
  Status sync();

  int descriptor() const { return descriptor_; }

 private:
  File(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}
  void close();

  int descriptor_ = -1;
  std::string path_;
};

/// kStoreFailure "PATH: WHAT: reason" from errno.
Status systemFailure(const std::filesystem::path& path, std::string_view what);

/// Makes the folder and those above it, and syncs the one that holds it.
Status makeFolder(const std::filesystem::path& path);

/// Syncs a folder, so that names in it survive a power failure.
Status syncFolder(const std::filesystem::path& path);

/// Removes a file if it is there.
Status removeFile(const std::filesystem::path& path);

}  // namespace moduli
