#include "server/store/upload_store.h"

#include <sys/stat.h>

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "core/base/log.h"
#include "server/store/file_io.h"

namespace moduli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".part";

Status offsetMismatch(std::int64_t committed, std::int64_t given) {
  return {Reason::kUploadOffsetMismatch,
          "committed size is " + std::to_string(committed) + ", not " + std::to_string(given),
          "ask QueryUpload how much has arrived and go on from there"};
}

class FolderUploadStore final : public UploadStore {
 public:
  FolderUploadStore(Options options, MeshStore& meshes)
      : folder_(std::move(options.folder)), max_bytes_(options.max_bytes), meshes_(meshes) {}

  Result<UploadState> query(std::string_view digest) const override {
    RETURN_IF_ERROR(validateDigest(digest));
    if (meshes_.contains(digest)) {
      // The pin lets its time to live start anew: whoever asks wants to use it.
      const Result<MeshPin> pin = meshes_.pin(digest);
      if (pin.ok()) return UploadState{pin->size(), true};
    }
    return UploadState{partialSize(digest), false};
  }

  Result<UploadState> append(std::string_view digest, std::int64_t write_offset,
                             std::string_view data) override {
    RETURN_IF_ERROR(validateDigest(digest));
    const DigestLock lock(*this, digest);
    ASSIGN_OR_RETURN(UploadState state, query(digest));
    if (state.complete) return state;
    if (write_offset != state.committed_size) {
      return offsetMismatch(state.committed_size, write_offset);
    }
    if (static_cast<std::int64_t>(data.size()) > max_bytes_ - write_offset) {
      return Status(Reason::kMeshTooLarge,
                    "the file has more than " + std::to_string(max_bytes_) + " bytes");
    }
    ASSIGN_OR_RETURN(File file, File::open(pathOf(digest), File::Mode::kAppend));
    RETURN_IF_ERROR(file.seek(write_offset));
    if (const Status status = file.write(data); !status.ok()) {
      // What did arrive of this piece goes, so that the committed size is what was answered.
      RETURN_IF_ERROR(file.truncate(write_offset));
      return status;
    }
    state.committed_size += static_cast<std::int64_t>(data.size());
    return state;
  }

  Result<MeshPin> finish(std::string_view digest, std::int64_t total_size) override {
    RETURN_IF_ERROR(validateDigest(digest));
    const DigestLock lock(*this, digest);
    if (meshes_.contains(digest)) {
      Result<MeshPin> pin = meshes_.pin(digest);
      if (pin.ok()) {
        if (pin->size() != total_size) return offsetMismatch(pin->size(), total_size);
        RETURN_IF_ERROR(removeFile(pathOf(digest)));
        return pin;
      }
    }
    const std::int64_t committed = partialSize(digest);
    if (committed != total_size) return offsetMismatch(committed, total_size);
    Result<MeshPin> pin = storePartial(digest, total_size);
    if (pin.ok() || pin.status().reason() == Reason::kUploadDigestMismatch) {
      RETURN_IF_ERROR(removeFile(pathOf(digest)));
    }
    return pin;
  }

  Result<std::size_t> expire(Timestamp older_than) override {
    std::size_t dropped = 0;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
      if (entry.path().extension() != kSuffix) continue;
      const DigestLock lock(*this, entry.path().stem().string());
      struct stat info = {};
      if (::stat(entry.path().c_str(), &info) != 0) continue;
      const Timestamp written{std::chrono::seconds(info.st_mtim.tv_sec) +
                              std::chrono::microseconds(info.st_mtim.tv_nsec / 1000)};
      if (written >= older_than) continue;
      RETURN_IF_ERROR(removeFile(entry.path()));
      ++dropped;
    }
    if (error) return Status(Reason::kStoreFailure, folder_.string() + ": " + error.message());
    return dropped;
  }

 private:
  // One writer per digest; different digests do not wait for each other.
  class DigestLock {
   public:
    DigestLock(FolderUploadStore& store, std::string_view digest) : store_(store), digest_(digest) {
      {
        const std::lock_guard guard(store_.locks_mutex_);
        std::shared_ptr<std::mutex>& slot = store_.locks_[digest_];
        if (slot == nullptr) slot = std::make_shared<std::mutex>();
        mutex_ = slot;
      }
      mutex_->lock();
    }
    ~DigestLock() {
      mutex_->unlock();
      const std::lock_guard guard(store_.locks_mutex_);
      mutex_ = nullptr;
      const auto slot = store_.locks_.find(digest_);
      if (slot != store_.locks_.end() && slot->second.use_count() == 1) store_.locks_.erase(slot);
    }
    DigestLock(const DigestLock&) = delete;
    DigestLock& operator=(const DigestLock&) = delete;

   private:
    FolderUploadStore& store_;
    const std::string digest_;
    std::shared_ptr<std::mutex> mutex_;
  };

  fs::path pathOf(std::string_view digest) const {
    return folder_ / (std::string(digest) + std::string(kSuffix));
  }

  std::int64_t partialSize(std::string_view digest) const {
    struct stat info = {};
    return ::stat(pathOf(digest).c_str(), &info) == 0 ? info.st_size : 0;
  }

  Result<MeshPin> storePartial(std::string_view digest, std::int64_t total_size) {
    ASSIGN_OR_RETURN(File file, File::open(pathOf(digest), File::Mode::kAppend));
    return meshes_.put(digest, total_size, [&file](std::size_t limit) { return file.read(limit); });
  }

  const fs::path folder_;
  const std::int64_t max_bytes_;
  MeshStore& meshes_;
  std::mutex locks_mutex_;
  std::map<std::string, std::shared_ptr<std::mutex>> locks_;
};

}  // namespace

Result<std::unique_ptr<UploadStore>> UploadStore::open(Options options, MeshStore& meshes) {
  RETURN_IF_ERROR(makeFolder(options.folder));
  return std::unique_ptr<UploadStore>(
      std::make_unique<FolderUploadStore>(std::move(options), meshes));
}

}  // namespace moduli
