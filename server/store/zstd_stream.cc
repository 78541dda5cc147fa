// The one place that knows zstd.
#include "server/store/zstd_stream.h"

#include <zstd.h>

#include <algorithm>
#include <utility>

namespace moduli {
namespace {

// Meshes are text mostly: level 3 halves them and costs less than hashing does.
constexpr int kLevel = 3;
constexpr std::size_t kBlock = 1 << 18;

Status damaged(std::string_view what) {
  return {Reason::kStoreCorrupt, "the compressed file is damaged: " + std::string(what)};
}

}  // namespace

struct ZstdWriter::Context {
  ZSTD_CCtx* handle = ZSTD_createCCtx();
  std::string output = std::string(ZSTD_CStreamOutSize(), '\0');
  Context() = default;
  ~Context() { ZSTD_freeCCtx(handle); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

ZstdWriter::ZstdWriter(File& file, std::int64_t size)
    : file_(file), context_(std::make_unique<Context>()) {
  ZSTD_CCtx_setParameter(context_->handle, ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context_->handle, ZSTD_c_checksumFlag, 1);
  ZSTD_CCtx_setPledgedSrcSize(context_->handle, static_cast<unsigned long long>(size));
}

ZstdWriter::~ZstdWriter() = default;

Status ZstdWriter::write(std::string_view bytes) {
  return feed(bytes, false);
}

Status ZstdWriter::finish() {
  return feed({}, true);
}

Status ZstdWriter::feed(std::string_view bytes, bool last) {
  ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
  for (;;) {
    ZSTD_outBuffer output{context_->output.data(), context_->output.size(), 0};
    const std::size_t left = ZSTD_compressStream2(context_->handle, &output, &input,
                                                  last ? ZSTD_e_end : ZSTD_e_continue);
    if (ZSTD_isError(left) != 0) {
      return {Reason::kStoreFailure,
              std::string("the file cannot be compressed: ") + ZSTD_getErrorName(left)};
    }
    RETURN_IF_ERROR(file_.write(std::string_view(context_->output).substr(0, output.pos)));
    if (last ? left == 0 : input.pos == input.size) return {};
  }
}

struct ZstdReader::Context {
  ZSTD_DCtx* handle = ZSTD_createDCtx();
  Context() = default;
  ~Context() { ZSTD_freeDCtx(handle); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

ZstdReader::ZstdReader(File file, std::string first, std::int64_t size)
    : file_(std::move(file)),
      input_(std::move(first)),
      size_(size),
      context_(std::make_unique<Context>()) {}

ZstdReader::~ZstdReader() = default;

Result<std::unique_ptr<ZstdReader>> ZstdReader::open(File file) {
  ASSIGN_OR_RETURN(std::string first, file.read(kBlock));
  const unsigned long long size = ZSTD_getFrameContentSize(first.data(), first.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > INT64_MAX) {
    return damaged("no frame with a size");
  }
  return std::unique_ptr<ZstdReader>(
      new ZstdReader(std::move(file), std::move(first), static_cast<std::int64_t>(size)));
}

Result<std::string> ZstdReader::read(std::size_t limit) {
  // Never more than the frame may still give, and one byte to notice that it gives too much.
  const auto left = static_cast<std::size_t>(size_ - produced_);
  std::string bytes(std::min(limit, left + 1), '\0');
  ZSTD_outBuffer output{bytes.data(), bytes.size(), 0};
  while (!frame_done_ && output.pos < output.size) {
    ZSTD_inBuffer input{input_.data(), input_.size(), input_at_};
    const std::size_t hint = ZSTD_decompressStream(context_->handle, &output, &input);
    if (ZSTD_isError(hint) != 0) return damaged(ZSTD_getErrorName(hint));
    input_at_ = input.pos;
    frame_done_ = hint == 0;
    if (frame_done_ || output.pos == output.size || input_at_ < input_.size()) continue;
    ASSIGN_OR_RETURN(input_, file_.read(kBlock));
    input_at_ = 0;
    if (input_.empty()) return damaged("it ends too early");
  }
  bytes.resize(output.pos);
  produced_ += static_cast<std::int64_t>(output.pos);
  if (produced_ > size_) return damaged("it holds more than it says");
  if (frame_done_ && produced_ < size_) return damaged("it holds less than it says");
  return bytes;
}

}  // namespace moduli
