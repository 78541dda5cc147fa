#include "server/store/store.h"

#include <stdlib.h>

#include <string>
#include <system_error>
#include <utility>

#include "core/base/log.h"
#include "server/store/file_io.h"
#include "server/store/file_system_kind.h"
#include "server/store/sqlite_catalog.h"
#include "server/store/store_lock.h"

namespace moduli {
namespace {

namespace fs = std::filesystem;

/// Meshes and uploads below a folder, and a catalogue where there is one.
class FolderStore final : public Store {
 public:
  explicit FolderStore(const StoreOptions& options) : upload_ttl_(options.upload_ttl) {}

  ~FolderStore() override {
    catalog_.reset();
    uploads_.reset();
    meshes_.reset();
    if (!temporary_) return;
    std::error_code error;
    fs::remove_all(*temporary_, error);
    if (error) log(LogLevel::kWarning, temporary_->string() + ": " + error.message());
  }

  Status openFolder(const fs::path& folder, std::int64_t max_upload_bytes) {
    ASSIGN_OR_RETURN(meshes_, MeshStore::open({folder / "meshes", {}}));
    ASSIGN_OR_RETURN(uploads_, UploadStore::open({folder / "uploads", max_upload_bytes}, *meshes_));
    return {};
  }

  Status openDurable(const StoreOptions& options) {
    RETURN_IF_ERROR(makeFolder(options.folder));
    if (const auto kind = networkFileSystemAt(options.folder)) {
      return {Reason::kStoreOnNetworkFileSystem,
              options.folder.string() + " is on a network file system (" + *kind +
                  "), where concurrent writes are not safe",
              "keep the store on a local disk with --data, and share it by running modulid"};
    }
    ASSIGN_OR_RETURN(StoreLock lock, StoreLock::acquire(options.folder));
    lock_ = std::make_unique<StoreLock>(std::move(lock));
    ASSIGN_OR_RETURN(catalog_, SqliteCatalog::open(options.folder / "catalog.sqlite"));
    return openFolder(options.folder, options.max_upload_bytes);
  }

  Status openTemporaryFolder(const StoreOptions& options) {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "moduli-XXXXXX").string();
    if (error || ::mkdtemp(name.data()) == nullptr) {
      return systemFailure(name, "the temporary folder cannot be made");
    }
    temporary_ = std::make_unique<fs::path>(name);
    return openFolder(*temporary_, options.max_upload_bytes);
  }

  Catalog* catalog() override { return catalog_.get(); }
  MeshStore& meshes() override { return *meshes_; }
  UploadStore& uploads() override { return *uploads_; }

  Status collectGarbage() override {
    const Timestamp older_than =
        std::chrono::time_point_cast<std::chrono::microseconds>(std::chrono::system_clock::now()) -
        upload_ttl_;
    RETURN_IF_ERROR(statusOf(uploads_->expire(older_than)));
    return statusOf(
        meshes_->collectGarbage(older_than, [this](std::string_view digest) -> Result<bool> {
          return catalog_ == nullptr ? Result<bool>(false) : catalog_->hasMesh(digest);
        }));
  }

 private:
  static Status statusOf(const Result<std::size_t>& result) { return result.status(); }

  const std::chrono::seconds upload_ttl_;
  std::unique_ptr<fs::path> temporary_;  ///< To be removed at the end.
  std::unique_ptr<StoreLock> lock_;      ///< Let go last of all.
  std::unique_ptr<Catalog> catalog_;
  std::unique_ptr<MeshStore> meshes_;
  std::unique_ptr<UploadStore> uploads_;
};

}  // namespace

Result<std::unique_ptr<Store>> Store::open(const StoreOptions& options) {
  auto store = std::make_unique<FolderStore>(options);
  RETURN_IF_ERROR(store->openDurable(options));
  return std::unique_ptr<Store>(std::move(store));
}

Result<std::unique_ptr<Store>> Store::openTemporary(const StoreOptions& options) {
  auto store = std::make_unique<FolderStore>(options);
  RETURN_IF_ERROR(store->openTemporaryFolder(options));
  return std::unique_ptr<Store>(std::move(store));
}

}  // namespace moduli
