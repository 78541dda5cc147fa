#include "server/store/mesh_store.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/digest.h"
#include "core/base/log.h"
#include "server/store/file_io.h"
#include "server/store/zstd_stream.h"

namespace moduli {

namespace fs = std::filesystem;

MeshPin::MeshPin(std::shared_ptr<MeshPinCounts> counts, std::string_view digest, std::int64_t size)
    : counts_(std::move(counts)), digest_(digest), size_(size) {
  const std::lock_guard lock(counts_->mutex);
  ++counts_->count[digest_];
}

MeshPin::MeshPin(MeshPin&& other) noexcept
    : counts_(std::exchange(other.counts_, nullptr)),
      digest_(std::move(other.digest_)),
      size_(other.size_) {}

MeshPin& MeshPin::operator=(MeshPin&& other) noexcept {
  if (this != &other) {
    release();
    counts_ = std::exchange(other.counts_, nullptr);
    digest_ = std::move(other.digest_);
    size_ = other.size_;
  }
  return *this;
}

MeshPin::~MeshPin() {
  release();
}

void MeshPin::release() {
  if (counts_ == nullptr) return;
  const std::lock_guard lock(counts_->mutex);
  const auto found = counts_->count.find(digest_);
  if (--found->second == 0) counts_->count.erase(found);
}

namespace {

constexpr std::size_t kPiece = 1 << 20;
constexpr std::string_view kSuffix = ".zst";

Status notFound(std::string_view digest) {
  return {Reason::kUploadNotFound, "there is no mesh with digest " + std::string(digest),
          "upload it, or upload it again: it may have expired"};
}

class CheckedReader final : public MeshReader {
 public:
  CheckedReader(std::unique_ptr<ZstdReader> source, std::string digest,
                std::shared_ptr<MeshPinCounts> shared)
      : source_(std::move(source)), digest_(std::move(digest)), shared_(std::move(shared)) {}

  std::int64_t size() const override { return source_->size(); }

  Result<std::string> next(std::size_t limit) override {
    if (verified_) return std::string();
    Result<std::string> piece = source_->read(limit);
    if (!piece.ok()) return found(piece.status());
    hash_.update(*piece);
    produced_ += static_cast<std::int64_t>(piece->size());
    if (produced_ == size()) RETURN_IF_ERROR(verify());
    return piece;
  }

 private:
  Status verify() {
    verified_ = true;
    // Reads what follows the last byte: the frame's own end.
    const Result<std::string> rest = source_->read(1);
    if (!rest.ok()) return found(rest.status());
    if (hash_.finish() == digest_) return {};
    return found({Reason::kStoreCorrupt, "the file on disk has other bytes"});
  }

  // A damaged file counts as missing from now on, so that the next upload mends it.
  Status found(const Status& status) {
    if (status.reason() != Reason::kStoreCorrupt) return status.withContext("mesh " + digest_);
    const std::lock_guard lock(shared_->mutex);
    shared_->damaged.insert(digest_);
    return {Reason::kStoreCorrupt, "mesh " + digest_ + ": " + status.message(),
            "add the mesh again; that mends it"};
  }

  std::unique_ptr<ZstdReader> source_;
  const std::string digest_;
  const std::shared_ptr<MeshPinCounts> shared_;
  Sha256 hash_;
  std::int64_t produced_ = 0;
  bool verified_ = false;
};

ByteSource sourceOf(std::string_view bytes) {
  return [bytes, at = std::size_t{0}](std::size_t limit) mutable -> Result<std::string> {
    std::string piece(bytes.substr(at, limit));
    at += piece.size();
    return piece;
  };
}

Timestamp modificationTime(const struct stat& info) {
  return Timestamp(std::chrono::microseconds(std::int64_t{info.st_mtim.tv_sec} * 1'000'000 +
                                             info.st_mtim.tv_nsec / 1000));
}

class FolderMeshStore final : public MeshStore {
 public:
  explicit FolderMeshStore(Options options)
      : folder_(std::move(options.folder)), on_step_(std::move(options.on_step)) {}

  Status prepare() {
    RETURN_IF_ERROR(makeFolder(folder_ / "tmp"));
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "tmp", error)) {
      RETURN_IF_ERROR(removeFile(entry.path()));
    }
    if (error) return {Reason::kStoreFailure, (folder_ / "tmp").string() + ": " + error.message()};
    return {};
  }

  Result<MeshPin> put(std::string_view bytes) override {
    return put(sha256Hex(bytes), static_cast<std::int64_t>(bytes.size()), sourceOf(bytes));
  }

  Result<MeshPin> put(std::string_view digest, std::int64_t size,
                      const ByteSource& source) override {
    RETURN_IF_ERROR(validateDigest(digest));
    // Pinned before it is there, so that it is never collected between the two.
    MeshPin pin(pins_, digest, size);
    if (contains(digest) && isSound(digest)) {
      touch(digest);
      return pin;
    }
    const fs::path temporary =
        folder_ / "tmp" / (std::string(digest) + "." + std::to_string(next_temporary_++));
    Status status = writeTemporary(temporary, digest, size, source);
    if (status.ok()) status = moveIntoPlace(temporary, digest);
    if (status.ok()) return pin;
    if (const Status left = removeFile(temporary); !left.ok()) {
      log(LogLevel::kWarning, left.toString());
    }
    return status;
  }

  Result<MeshPin> pin(std::string_view digest) override {
    RETURN_IF_ERROR(validateDigest(digest));
    const MeshPin held(pins_, digest, 0);
    ASSIGN_OR_RETURN(const std::unique_ptr<MeshReader> reader, openReader(digest));
    touch(digest);
    return MeshPin(pins_, digest, reader->size());
  }

  bool contains(std::string_view digest) const override {
    if (!validateDigest(digest).ok() || !isThere(digest)) return false;
    const std::lock_guard lock(pins_->mutex);
    return !pins_->damaged.contains(digest);
  }

  Result<std::string> read(std::string_view digest) const override {
    ASSIGN_OR_RETURN(const std::unique_ptr<MeshReader> reader, openReader(digest));
    std::string bytes;
    for (;;) {
      ASSIGN_OR_RETURN(const std::string piece, reader->next(kPiece));
      if (piece.empty()) return bytes;
      bytes += piece;
    }
  }

  Result<std::unique_ptr<MeshReader>> openReader(std::string_view digest) const override {
    RETURN_IF_ERROR(validateDigest(digest));
    if (!isThere(digest)) return notFound(digest);
    ASSIGN_OR_RETURN(File file, File::open(pathOf(digest), File::Mode::kRead));
    Result<std::unique_ptr<ZstdReader>> source = ZstdReader::open(std::move(file));
    if (!source.ok()) return source.status().withContext("mesh " + std::string(digest));
    return std::unique_ptr<MeshReader>(
        std::make_unique<CheckedReader>(*std::move(source), std::string(digest), pins_));
  }

  Result<std::size_t> collectGarbage(
      Timestamp older_than,
      const std::function<Result<bool>(std::string_view digest)>& referenced) override {
    std::size_t removed = 0;
    for (const std::string& digest : storedDigests()) {
      // No pin can be made, and none of a put in flight be let go, while the file is judged.
      const std::lock_guard lock(pins_->mutex);
      if (pins_->count.contains(digest)) continue;
      struct stat info = {};
      if (::stat(pathOf(digest).c_str(), &info) != 0) continue;
      if (modificationTime(info) >= older_than) continue;
      ASSIGN_OR_RETURN(const bool kept, referenced(digest));
      if (kept) continue;
      RETURN_IF_ERROR(removeFile(pathOf(digest)));
      ++removed;
    }
    return removed;
  }

 private:
  fs::path pathOf(std::string_view digest) const {
    return folder_ / digest.substr(0, 2) / (std::string(digest.substr(2)) + std::string(kSuffix));
  }

  bool isThere(std::string_view digest) const {
    std::error_code error;
    return fs::is_regular_file(pathOf(digest), error);
  }

  void step(std::string_view name) const {
    if (on_step_) on_step_(name);
  }

  bool isSound(std::string_view digest) const {
    Result<std::unique_ptr<MeshReader>> reader = openReader(digest);
    if (!reader.ok()) return false;
    for (;;) {
      const Result<std::string> piece = (*reader)->next(kPiece);
      if (!piece.ok()) return false;
      if (piece->empty()) return true;
    }
  }

  // Its time to live starts anew; failing that, it expires a little early.
  void touch(std::string_view digest) const {
    ::utimensat(AT_FDCWD, pathOf(digest).c_str(), nullptr, 0);
  }

  Status writeTemporary(const fs::path& path, std::string_view digest, std::int64_t size,
                        const ByteSource& source) {
    step("create");
    ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kCreate));
    ZstdWriter writer(file, size);
    Sha256 hash;
    std::int64_t total = 0;
    step("write");
    for (;;) {
      ASSIGN_OR_RETURN(const std::string piece, source(kPiece));
      if (piece.empty()) break;
      total += static_cast<std::int64_t>(piece.size());
      hash.update(piece);
      if (total > size) break;
      RETURN_IF_ERROR(writer.write(piece));
    }
    const std::string found = hash.finish();
    if (total != size || found != digest) {
      return {Reason::kUploadDigestMismatch,
              "the bytes have SHA-256 " + found + " and not " + std::string(digest),
              "send the file again from the start"};
    }
    RETURN_IF_ERROR(writer.finish());
    step("sync");
    return file.sync();
  }

  Status moveIntoPlace(const fs::path& temporary, std::string_view digest) {
    const fs::path path = pathOf(digest);
    RETURN_IF_ERROR(makeFolder(path.parent_path()));
    step("rename");
    if (::rename(temporary.c_str(), path.c_str()) != 0) {
      return systemFailure(path, "cannot be moved into place");
    }
    step("sync-folder");
    RETURN_IF_ERROR(syncFolder(path.parent_path()));
    const std::lock_guard lock(pins_->mutex);
    pins_->damaged.erase(std::string(digest));
    return {};
  }

  std::vector<std::string> storedDigests() const {
    std::vector<std::string> digests;
    std::error_code error;
    for (const fs::directory_entry& folder : fs::directory_iterator(folder_, error)) {
      const std::string prefix = folder.path().filename().string();
      if (prefix.size() != 2) continue;
      for (const fs::directory_entry& entry : fs::directory_iterator(folder.path(), error)) {
        if (entry.path().extension() != kSuffix) continue;
        std::string digest = prefix + entry.path().stem().string();
        if (validateDigest(digest).ok()) digests.push_back(std::move(digest));
      }
    }
    return digests;
  }

  const fs::path folder_;
  const std::function<void(std::string_view step)> on_step_;
  const std::shared_ptr<MeshPinCounts> pins_ = std::make_shared<MeshPinCounts>();
  std::atomic<std::uint64_t> next_temporary_{0};
};

}  // namespace

Result<std::unique_ptr<MeshStore>> MeshStore::open(Options options) {
  auto store = std::make_unique<FolderMeshStore>(std::move(options));
  RETURN_IF_ERROR(store->prepare());
  return std::unique_ptr<MeshStore>(std::move(store));
}

}  // namespace moduli
