#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/status.h"
#include "server/store/file_io.h"

namespace moduli {

/// Compresses bytes into a file as one zstd frame that records their number.
class ZstdWriter {
 public:
  /// `file` must outlive the object; `size`: how many bytes there will be.
  ZstdWriter(File& file, std::int64_t size);
  ~ZstdWriter();
  Status write(std::string_view bytes);
  /// Ends the frame.
  Status finish();

 private:
  struct Context;
  Status feed(std::string_view bytes, bool last);
  File& file_;
  std::unique_ptr<Context> context_;
};

/// Reads it back. Fails with kStoreCorrupt where the file is no such frame, or gives other than
/// the recorded number of bytes.
class ZstdReader {
 public:
  static Result<std::unique_ptr<ZstdReader>> open(File file);
  ~ZstdReader();
  /// What the frame says, not yet checked.
  std::int64_t size() const { return size_; }
  /// The next at most `limit` bytes; "" at the end.
  Result<std::string> read(std::size_t limit);

 private:
  struct Context;
  ZstdReader(File file, std::string first, std::int64_t size);
  File file_;
  std::string input_;
  std::size_t input_at_ = 0;
  std::int64_t size_;
  std::int64_t produced_ = 0;
  bool frame_done_ = false;
  std::unique_ptr<Context> context_;
};

}  // namespace moduli
