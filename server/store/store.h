#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/base/status.h"
#include "server/store/catalog.h"
#include "server/store/mesh_store.h"
#include "server/store/upload_store.h"

namespace moduli {

struct StoreOptions {
  /// Created if missing. Holds lock, catalog.sqlite (with -wal and -shm beside it), meshes/ and
  /// uploads/.
  std::filesystem::path folder;
  std::int64_t max_upload_bytes = std::int64_t{2} << 30;
  /// How long an unfinished upload, or a mesh that no shape has, is kept.
  std::chrono::seconds upload_ttl{24 * 3600};
};

/// The folder in which everything durable lives: catalogue, mesh files, uploads. One process at a
/// time. Thread-safe.
class Store {
 public:
  /// Locks the folder, brings the schema up to date, clears what a killed process left. Fails with
  /// kStoreLocked (the message names process, host and since when), kStoreTooNew,
  /// kStoreOnNetworkFileSystem, kStoreCorrupt, kStoreFailure.
  static Result<std::unique_ptr<Store>> open(const StoreOptions& options);

  /// Uploads and meshes alone, in a folder of its own below the system's temporary one that goes
  /// with the object. `folder` is not used; there is no catalogue.
  static Result<std::unique_ptr<Store>> openTemporary(const StoreOptions& options);

  /// Writes the log back into the database and unlocks the folder.
  virtual ~Store() = default;

  /// Null in a temporary store.
  virtual Catalog* catalog() = 0;
  virtual MeshStore& meshes() = 0;
  virtual UploadStore& uploads() = 0;

  /// Drops expired uploads and the meshes that no shape has any more. Call it now and then (once an
  /// hour); costs a look at every mesh file's name and time.
  virtual Status collectGarbage() = 0;
};

}  // namespace moduli
