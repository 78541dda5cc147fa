#include "client/cli/file_writer.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "client/cli/output.h"

namespace moduli::cli {

FileWriter::FileWriter(std::string path, bool overwrite)
    : path_(std::move(path)), overwrite_(overwrite) {}

FileWriter::~FileWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!part_.empty()) ::unlink(part_.c_str());
}

Status FileWriter::failure(int error) const {
  if (error == EEXIST) {
    return {Reason::kFileUnwritable, path_ + ": is there already",
            "give --force to overwrite it, or another name with --output"};
  }
  return {Reason::kFileUnwritable, path_ + ": cannot be written (" + std::strerror(error) + ")",
          "check the folder, or give another name with --output"};
}

Status FileWriter::open() {
  struct stat facts {};
  if (!overwrite_ && ::lstat(path_.c_str(), &facts) == 0) return failure(EEXIST);
  part_ = path_ + ".XXXXXX";
  descriptor_ = ::mkostemp(part_.data(), O_CLOEXEC);
  if (descriptor_ < 0) {
    part_.clear();
    return failure(errno);
  }
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(descriptor_, 0666 & ~mask);
  return {};
}

Status FileWriter::write(std::string_view bytes) {
  return writeAll(descriptor_, bytes).ok() ? Status() : failure(errno);
}

Status FileWriter::commit() {
  const int closed = ::close(std::exchange(descriptor_, -1));
  if (closed != 0) return failure(errno);
  if (overwrite_) {
    if (::rename(part_.c_str(), path_.c_str()) != 0) return failure(errno);
    part_.clear();
    return {};
  }
  // A link refuses an existing name, which a rename would replace.
  if (::link(part_.c_str(), path_.c_str()) != 0) return failure(errno);
  return {};
}

}  // namespace moduli::cli
