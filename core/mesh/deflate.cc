// The one place that knows zlib.
#include "core/mesh/deflate.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>

namespace moduli {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;
constexpr int kEitherHeader = 15 + 32;  // zlib's way to say: zlib or gzip, the bytes tell.
constexpr int kZlibHeader = 15;
constexpr int kGzipHeader = 15 + 16;

// zlib wants bytes that it may write, and counts them in 32 bits.
void offer(z_stream& stream, std::string_view bytes) {
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in =
      static_cast<uInt>(std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max()));
}

class Inflater {
 public:
  explicit Inflater(std::string_view input) : input_(input) {
    if (inflateInit2(&stream_, kEitherHeader) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  bool done() const { return done_; }

  /// Appends at most `limit` bytes, fewer only at the end.
  Status more(std::string& output, std::size_t limit) {
    const std::size_t start = output.size();
    output.resize(start + limit);
    Status status;
    std::size_t made = 0;
    while (!done_ && made < limit && status.ok()) status = step(output, start, limit, made);
    output.resize(start + made);
    return status;
  }

 private:
  Status step(std::string& output, std::size_t start, std::size_t limit, std::size_t& made) {
    offer(stream_, input_);
    stream_.next_out = reinterpret_cast<Bytef*>(output.data() + start + made);
    stream_.avail_out =
        static_cast<uInt>(std::min<std::size_t>(limit - made, std::numeric_limits<uInt>::max()));
    const uInt offered = stream_.avail_in;
    const uInt room = stream_.avail_out;
    const int answer = ::inflate(&stream_, Z_NO_FLUSH);
    input_.remove_prefix(offered - stream_.avail_in);
    made += room - stream_.avail_out;
    if (answer == Z_STREAM_END) return endOfMember();
    if (answer == Z_MEM_ERROR) throw std::bad_alloc();
    const bool stuck = offered == stream_.avail_in && room == stream_.avail_out;
    if (answer == Z_BUF_ERROR || (answer == Z_OK && stuck)) {
      return {Reason::kTruncatedFile, "the compressed bytes end too early",
              "the file was cut off; copy or export it again"};
    }
    if (answer == Z_OK) return {};
    return damaged(stream_.msg != nullptr ? stream_.msg : "a preset dictionary is needed");
  }

  Status endOfMember() {
    if (input_.empty()) {
      done_ = true;
      return {};
    }
    if (!isGzip(input_)) {
      return damaged(std::to_string(input_.size()) + " bytes stand behind their end");
    }
    if (inflateReset(&stream_) != Z_OK) return damaged("a second part cannot be begun");
    return {};
  }

  static Status damaged(const std::string& what) {
    return {Reason::kSyntaxError, "the compressed bytes are damaged: " + what,
            "copy or export the file again"};
  }

  std::string_view input_;
  z_stream stream_{};
  bool done_ = false;
};

std::string deflated(std::string_view bytes, int header) {
  z_stream stream{};
  constexpr int kMemory = 8;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, header, kMemory,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string output;
  int answer = Z_OK;
  while (answer == Z_OK) {
    offer(stream, bytes);
    const uInt offered = stream.avail_in;
    const std::size_t start = output.size();
    output.resize(start + std::max(kBlock, start / 2));
    const std::size_t room = std::min<std::size_t>(output.size() - start, kBlock * 64);
    stream.next_out = reinterpret_cast<Bytef*>(output.data() + start);
    stream.avail_out = static_cast<uInt>(room);
    answer = ::deflate(&stream, offered == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    bytes.remove_prefix(offered - stream.avail_in);
    output.resize(start + room - stream.avail_out);
  }
  deflateEnd(&stream);
  return output;
}

}  // namespace

InflateAllowance InflateAllowance::forFile(std::size_t file_size) {
  constexpr std::size_t kFloor = std::size_t{16} << 20;
  constexpr std::size_t kRatio = 64;
  return {std::max(kFloor, kRatio * file_size)};
}

bool isGzip(std::string_view bytes) {
  return bytes.starts_with("\x1F\x8B");
}

Result<std::string> inflateBytes(Context& context, std::string_view compressed, std::size_t most,
                                 InflateAllowance& allowance) {
  const std::size_t bound = std::min(most, allowance.left);
  Inflater inflater(compressed);
  std::string output;
  while (!inflater.done()) {
    RETURN_IF_ERROR(context.check());
    // One byte more than allowed, so that too much is seen. Growth by halves: no more memory than
    // what has come out already is ever taken on trust.
    const std::size_t step = std::max(kBlock, output.size() / 2);
    RETURN_IF_ERROR(inflater.more(output, std::min(step, bound + 1 - output.size())));
    if (output.size() > bound) {
      return Status(Reason::kCountTooLarge,
                    "the compressed bytes expand to more than " + std::to_string(bound) + " bytes",
                    most <= allowance.left ? "the sizes are wrong; export the file again"
                                           : "write the file without compression");
    }
  }
  allowance.left -= output.size();
  return output;
}

std::string inflateBeginning(std::string_view compressed, std::size_t most) {
  std::string output;
  static_cast<void>(Inflater(compressed).more(output, most).ok());
  return output;
}

std::string deflateBytes(std::string_view bytes) {
  return deflated(bytes, kZlibHeader);
}

std::string gzipBytes(std::string_view bytes) {
  return deflated(bytes, kGzipHeader);
}

}  // namespace moduli
