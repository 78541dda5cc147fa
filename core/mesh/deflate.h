#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/context.h"
#include "core/base/status.h"

/// Compressed bytes in and out: zlib streams and gzip files. The one room for zlib.
namespace moduli {

/// How much the compressed parts of one file may grow to in all. A few kilobytes can spell
/// gigabytes of zeros, and compressed text can hold compressed text: what is inflated is bounded by
/// the size of the file itself, by 64 times that or by 16 MiB, whichever is more. (Coordinates
/// shrink to three quarters, indices to a quarter; only fields that are nearly constant shrink by
/// more than 64.)
struct InflateAllowance {
  std::size_t left;

  static InflateAllowance forFile(std::size_t file_size);
};

/// True if the bytes begin as a gzip file does.
bool isGzip(std::string_view bytes);

/// What a zlib stream or a gzip file (of one member or several) holds. `most`: the bytes that the
/// caller can use; one more is an error. What comes out is taken from the allowance; memory grows
/// with it and is never taken for a mere promise.
/// Fails with kTruncatedFile, kSyntaxError (damaged, or bytes behind the end), kCountTooLarge (more
/// than `most` or than the allowance), kCancelled. The message has no place: the caller knows it.
/// O(output).
Result<std::string> inflateBytes(Context& context, std::string_view compressed, std::size_t most,
                                 InflateAllowance& allowance);

/// At most the first `most` bytes of a gzip file, as far as they can be had: to tell what it is.
std::string inflateBeginning(std::string_view compressed, std::size_t most);

/// A zlib stream (RFC 1950). The same bytes give the same stream.
std::string deflateBytes(std::string_view bytes);
/// A gzip file (RFC 1952) without a name or a time in it.
std::string gzipBytes(std::string_view bytes);

}  // namespace moduli
