#include "server/store/file_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace moduli {

Status systemFailure(const std::filesystem::path& path, std::string_view what) {
  const int code = errno;
  std::string hint;
  if (code == ENOSPC || code == EDQUOT) hint = "make room on the disk";
  if (code == EACCES || code == EPERM || code == EROFS) {
    hint = "check who may write to the store's folder";
  }
  return {Reason::kStoreFailure,
          path.string() + ": " + std::string(what) + ": " +
              std::error_code(code, std::generic_category()).message(),
          hint};
}

Result<File> File::open(const std::filesystem::path& path, Mode mode) {
  int flags = O_CLOEXEC;
  if (mode == Mode::kRead) flags |= O_RDONLY;
  if (mode == Mode::kCreate) flags |= O_WRONLY | O_CREAT | O_EXCL;
  if (mode == Mode::kAppend) flags |= O_RDWR | O_CREAT;
  if (mode == Mode::kFolder) flags |= O_RDONLY | O_DIRECTORY;
  const int descriptor = ::open(path.c_str(), flags, 0600);
  if (descriptor < 0) return systemFailure(path, "cannot be opened");
  return File(descriptor, path.string());
}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}

File& File::operator=(File&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = std::exchange(other.descriptor_, -1);
    path_ = std::move(other.path_);
  }
  return *this;
}

File::~File() {
  close();
}

void File::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

Result<std::string> File::read(std::size_t limit) {
  std::string bytes(limit, '\0');
  std::size_t filled = 0;
  while (filled < limit) {
    const ssize_t count = ::read(descriptor_, bytes.data() + filled, limit - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return systemFailure(path_, "cannot be read");
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
  }
  bytes.resize(filled);
  return bytes;
}

Status File::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return systemFailure(path_, "cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

Status File::seek(std::int64_t offset) {
  if (::lseek(descriptor_, offset, SEEK_SET) < 0) return systemFailure(path_, "cannot be read");
  return {};
}

Status File::truncate(std::int64_t size) {
  if (::ftruncate(descriptor_, size) != 0) return systemFailure(path_, "cannot be cut");
  return {};
}

Result<std::int64_t> File::size() const {
  struct stat info = {};
  if (::fstat(descriptor_, &info) != 0) return systemFailure(path_, "cannot be measured");
  return static_cast<std::int64_t>(info.st_size);
}

Status File::sync() {
  if (::fsync(descriptor_) != 0) return systemFailure(path_, "cannot be synced to the disk");
  return {};
}

Status makeFolder(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return {};
  const std::filesystem::path parent = path.parent_path();
  if (!parent.empty() && parent != path) RETURN_IF_ERROR(makeFolder(parent));
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) {
    return systemFailure(path, "the folder cannot be made");
  }
  return syncFolder(parent.empty() ? "." : parent);
}

Status syncFolder(const std::filesystem::path& path) {
  ASSIGN_OR_RETURN(File folder, File::open(path, File::Mode::kFolder));
  return folder.sync();
}

Status removeFile(const std::filesystem::path& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return systemFailure(path, "cannot be removed");
  }
  return {};
}

}  // namespace moduli
