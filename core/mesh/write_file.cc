#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "core/mesh/write.h"

namespace moduli {
namespace {

Status unwritable(const std::string& path, int problem) {
  return {Reason::kFileUnwritable, path + ": " + std::strerror(problem),
          "check that the folder exists, is writable and has room"};
}

// 0 or the errno of the failure.
int writeAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(file, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return 0;
}

// Pipes and devices take the bytes as they come; renaming a file over them would destroy them.
Status writeStream(const std::string& path, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return unwritable(path, errno);
  int problem = writeAll(file, bytes);
  if (::close(file) != 0 && problem == 0) problem = errno;
  return problem == 0 ? Status() : unwritable(path, problem);
}

std::string folderOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

// So that the new name survives a power loss. Some file systems cannot do it for folders; the file
// itself is safe then all the same.
void syncFolder(const std::string& folder) {
  const int number = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (number < 0) return;
  ::fsync(number);
  ::close(number);
}

std::string temporaryName(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  return path + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
}

Status replaceFile(const std::string& path, std::string_view bytes, mode_t mode) {
  const std::string temporary = temporaryName(path);
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (file < 0) return unwritable(path, errno);
  int problem = writeAll(file, bytes);
  if (problem == 0 && ::fsync(file) != 0) problem = errno;
  if (::close(file) != 0 && problem == 0) problem = errno;
  if (problem == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) problem = errno;
  if (problem != 0) {
    ::unlink(temporary.c_str());
    return unwritable(path, problem);
  }
  syncFolder(folderOf(path));
  return {};
}

}  // namespace

Status writeFile(const std::string& path, std::string_view bytes) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) return replaceFile(path, bytes, 0666);
  if (S_ISDIR(about.st_mode)) return unwritable(path, EISDIR);
  if (!S_ISREG(about.st_mode)) return writeStream(path, bytes);
  // Behind a symbolic link the file itself is replaced, not the link.
  char* resolved = ::realpath(path.c_str(), nullptr);
  if (resolved == nullptr) return unwritable(path, errno);
  const std::string target = resolved;
  std::free(resolved);
  if (::access(target.c_str(), W_OK) != 0) return unwritable(path, errno);
  return replaceFile(target, bytes, about.st_mode & 07777);
}

}  // namespace moduli
