#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

#include "core/base/status.h"
#include "server/store/mesh_store.h"
#include "server/store/shape_record.h"

namespace moduli {

struct UploadState {
  std::int64_t committed_size = 0;  ///< Bytes received and kept; the file's size once complete.
  bool complete = false;            ///< The whole file is in the mesh store.
};

/// Files on their way in, named by the SHA-256 that their sender claims: bytes are appended in
/// order, and finish moves the whole into the mesh store if the digest is true. What has arrived
/// survives a restart. Several senders of one digest share one upload; each write must start where
/// the bytes so far end, so the slower one is told to look again rather than doing harm.
/// Thread-safe.
class UploadStore {
 public:
  struct Options {
    std::filesystem::path folder;
    std::int64_t max_bytes = std::int64_t{2} << 30;  ///< Largest file.
  };

  /// Makes the folder if missing. `meshes` must outlive the object. Fails with kStoreFailure.
  static Result<std::unique_ptr<UploadStore>> open(Options options, MeshStore& meshes);

  virtual ~UploadStore() = default;

  /// How far the upload of `digest` is; nothing received is {0, false}. kInvalidRequest if it is
  /// not a digest.
  virtual Result<UploadState> query(std::string_view digest) const = 0;

  /// Appends `data` and returns the state after it. A file that is complete already answers so and
  /// takes nothing. Fails with kUploadOffsetMismatch if write_offset is not the committed size (the
  /// message names it), kMeshTooLarge, kInvalidRequest, kStoreFailure (the bytes so far stay).
  virtual Result<UploadState> append(std::string_view digest, std::int64_t write_offset,
                                     std::string_view data) = 0;

  /// The file is whole: checks size and SHA-256, stores it durably, and returns a pin of it. Fails
  /// with kUploadOffsetMismatch if another number of bytes than total_size has arrived (they stay),
  /// kUploadDigestMismatch if they have another SHA-256 (they are dropped), kStoreFailure.
  virtual Result<MeshPin> finish(std::string_view digest, std::int64_t total_size) = 0;

  /// Drops the unfinished uploads that were last written to before `older_than`; returns how many.
  virtual Result<std::size_t> expire(Timestamp older_than) = 0;
};

}  // namespace moduli
