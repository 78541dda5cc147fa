#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "core/base/status.h"
#include "server/store/shape_record.h"

namespace moduli {

/// What pins, readers and the mesh store share. Its mutex also keeps pinning and collecting apart.
struct MeshPinCounts {
  std::mutex mutex;
  std::map<std::string, int, std::less<>> count;  ///< Pins of each digest.
  std::set<std::string, std::less<>> damaged;     ///< Files that a reader has found wrong.
};

/// Keeps one mesh file from being collected as garbage while it lives. Movable.
class MeshPin {
 public:
  MeshPin(std::shared_ptr<MeshPinCounts> counts, std::string_view digest, std::int64_t size);
  MeshPin() = default;
  MeshPin(MeshPin&& other) noexcept;
  MeshPin& operator=(MeshPin&& other) noexcept;
  ~MeshPin();

  const std::string& digest() const { return digest_; }
  /// Size of the mesh file itself, not of its compressed form.
  std::int64_t size() const { return size_; }

 private:
  void release();

  std::shared_ptr<MeshPinCounts> counts_;
  std::string digest_;
  std::int64_t size_ = 0;
};

/// Hands out a stored file piece by piece and checks its SHA-256 at the end. It goes on to work if
/// the file is collected meanwhile. For one thread at a time.
class MeshReader {
 public:
  virtual ~MeshReader() = default;
  virtual std::int64_t size() const = 0;
  /// The next at most `limit` bytes; "" after the last. Fails with kStoreCorrupt, at the latest
  /// together with what would be the last piece, if the file is not what was stored.
  virtual Result<std::string> next(std::size_t limit) = 0;
};

/// A source of bytes: the next at most `limit` of them, "" at the end.
using ByteSource = std::function<Result<std::string>(std::size_t limit)>;

/// Mesh files by their SHA-256, zstd-compressed, in FOLDER/ab/cdef....zst. A file is written under
/// a temporary name in FOLDER/tmp, synced, renamed, and its folder synced, before put returns; what
/// a killed process left in FOLDER/tmp is removed when the folder is opened. Thread-safe; one
/// process at a time (the store's lock sees to that).
///
///   ASSIGN_OR_RETURN(MeshPin pin, meshes.put(bytes));
///   ... sign ...
///   RETURN_IF_ERROR(catalog.putShape(record, ...));   // pin still lives: no collection between
class MeshStore {
 public:
  struct Options {
    std::filesystem::path folder;
    /// Told before every step of a write ("create", "write", "sync", "rename", "sync-folder"): for
    /// tests that kill the process there.
    std::function<void(std::string_view step)> on_step;
  };

  /// Makes the folder if missing. Fails with kStoreFailure.
  static Result<std::unique_ptr<MeshStore>> open(Options options);

  virtual ~MeshStore() = default;

  /// Stores a file, or finds it there already (and mends it if it is damaged). Fails with
  /// kStoreFailure (disk full, ...), leaving nothing behind.
  virtual Result<MeshPin> put(std::string_view bytes) = 0;

  /// The same for bytes that need not fit into memory. `digest` and `size` are what the sender
  /// claims; fails with kUploadDigestMismatch, storing nothing, where they are not true. The source
  /// is not looked at if the file is there already.
  virtual Result<MeshPin> put(std::string_view digest, std::int64_t size,
                              const ByteSource& source) = 0;

  /// A pin of a stored file. Its time to live starts anew. Fails with kUploadNotFound.
  virtual Result<MeshPin> pin(std::string_view digest) = 0;

  /// Whether the file is there and nobody has found it damaged.
  virtual bool contains(std::string_view digest) const = 0;

  /// The whole file. Fails with kUploadNotFound, kStoreCorrupt.
  virtual Result<std::string> read(std::string_view digest) const = 0;
  virtual Result<std::unique_ptr<MeshReader>> openReader(std::string_view digest) const = 0;

  /// Removes the files that are not pinned, have not been put or pinned after `older_than`, and of
  /// which `referenced` says false (Catalog::hasMesh). Returns how many. Safe beside puts: a file
  /// is looked up and removed while no pin of it can be made.
  virtual Result<std::size_t> collectGarbage(
      Timestamp older_than,
      const std::function<Result<bool>(std::string_view digest)>& referenced) = 0;
};

}  // namespace moduli
