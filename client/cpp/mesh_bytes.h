#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "core/base/status.h"

namespace moduli {

/// The bytes of a mesh file: in memory, or in a file that is read piece by piece. Copies share the
/// open file. Thread-safe.
class MeshBytes {
 public:
  static MeshBytes ofMemory(std::string bytes);

  /// Opens a file; what is not a regular file (a pipe) is read into memory at once.
  /// Fails with kFileNotFound, kFileUnreadable (a folder, no permission), kMeshTooLarge (a pipe
  /// that gives more than 2 GiB).
  static Result<MeshBytes> ofFile(const std::string& path);

  std::uint64_t size() const { return size_; }

  /// Exactly `length` bytes from `offset` on. Fails with kFileUnreadable if they cannot be had, for
  /// instance because the file has become shorter.
  Result<std::string> read(std::uint64_t offset, std::size_t length) const;

  /// SHA-256 as 64 hexadecimal digits. O(size), in pieces.
  Result<std::string> digest() const;

 private:
  class Descriptor;

  MeshBytes() = default;

  std::string name_;
  std::uint64_t size_ = 0;
  std::shared_ptr<const std::string> memory_;
  std::shared_ptr<const Descriptor> file_;
};

}  // namespace moduli
