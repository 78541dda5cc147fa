#include "client/cpp/mesh_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/digest.h"

namespace moduli {
namespace {

constexpr std::uint64_t kPipeLimit = 2ULL << 30;
constexpr std::size_t kPiece = 1 << 20;

Status openFailure(const std::string& path, int error) {
  if (error == ENOENT || error == ENOTDIR) {
    return {Reason::kFileNotFound, path + ": no such file", "check the path"};
  }
  return {Reason::kFileUnreadable, path + ": cannot be opened (" + std::strerror(error) + ")",
          "check the file's permissions"};
}

Status readFailure(const std::string& path, const std::string& why) {
  return {Reason::kFileUnreadable, path + ": cannot be read (" + why + ")",
          "try again when nothing else writes the file"};
}

Result<std::string> readAll(int descriptor, const std::string& path) {
  std::string bytes;
  std::string piece(kPiece, '\0');
  while (true) {
    const ssize_t got = ::read(descriptor, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return readFailure(path, std::strerror(errno));
    if (got == 0) return bytes;
    bytes.append(piece, 0, static_cast<std::size_t>(got));
    if (bytes.size() > kPipeLimit) {
      return Status(Reason::kMeshTooLarge, path + ": gives more than 2 GiB",
                    "write it to a file first");
    }
  }
}

}  // namespace

class MeshBytes::Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() { ::close(value_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int value() const { return value_; }

 private:
  const int value_;
};

MeshBytes MeshBytes::ofMemory(std::string bytes) {
  MeshBytes result;
  result.size_ = bytes.size();
  result.memory_ = std::make_shared<const std::string>(std::move(bytes));
  return result;
}

Result<MeshBytes> MeshBytes::ofFile(const std::string& path) {
  const int opened = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (opened < 0) return openFailure(path, errno);
  const auto file = std::make_shared<const Descriptor>(opened);
  struct stat facts {};
  if (::fstat(opened, &facts) != 0) return openFailure(path, errno);
  if (S_ISDIR(facts.st_mode)) {
    return Status(Reason::kFileUnreadable, path + ": is a folder", "name a mesh file in it");
  }
  MeshBytes result;
  result.name_ = path;
  if (S_ISREG(facts.st_mode)) {
    result.size_ = static_cast<std::uint64_t>(facts.st_size);
    result.file_ = file;
    return result;
  }
  ASSIGN_OR_RETURN(std::string bytes, readAll(opened, path));
  return ofMemory(std::move(bytes));
}

Result<std::string> MeshBytes::read(std::uint64_t offset, std::size_t length) const {
  if (offset + length > size_) return readFailure(name_, "its end comes too early");
  if (memory_) return memory_->substr(offset, length);
  std::string bytes(length, '\0');
  for (std::size_t done = 0; done < length;) {
    const ssize_t got = ::pread(file_->value(), bytes.data() + done, length - done,
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return readFailure(name_, std::strerror(errno));
    if (got == 0) return readFailure(name_, "it has become shorter");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

Result<std::string> MeshBytes::digest() const {
  Sha256 sha;
  for (std::uint64_t offset = 0; offset < size_; offset += kPiece) {
    const auto length = static_cast<std::size_t>(std::min<std::uint64_t>(kPiece, size_ - offset));
    ASSIGN_OR_RETURN(const std::string piece, read(offset, length));
    sha.update(piece);
  }
  return sha.finish();
}

}  // namespace moduli
