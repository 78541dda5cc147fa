#pragma once

#include <string>
#include <string_view>

#include "core/base/status.h"

namespace moduli::cli {

/// A file that is there whole or not at all: written beside its place, then put into it.
class FileWriter {
 public:
  /// overwrite: replace a file of this name; otherwise it is kept and open() or commit() fails.
  FileWriter(std::string path, bool overwrite);
  /// What was not committed is removed.
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  /// All fail with kFileUnwritable.
  Status open();
  Status write(std::string_view bytes);
  Status commit();

 private:
  Status failure(int error) const;

  const std::string path_;
  const bool overwrite_;
  std::string part_;
  int descriptor_ = -1;
};

}  // namespace moduli::cli
