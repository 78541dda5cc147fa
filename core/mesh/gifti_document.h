#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/deflate.h"
#include "core/mesh/gifti.h"
#include "core/mesh/scanner.h"

/// The XML of a GIFTI file and the arrays in it, whatever they mean.
namespace moduli {

enum class GiftiType : std::uint8_t { kUint8, kInt32, kFloat32, kFloat64 };

/// A DataArray element as the file has it, its numbers not yet decoded.
struct GiftiArray {
  std::string intent;
  std::string type_name;      ///< As written, for messages.
  std::string encoding_name;  ///< As written, for messages.
  std::optional<GiftiType> type;
  std::optional<GiftiEncoding> encoding;
  std::string endian;  ///< As written; "" if it does not say.
  bool column_major = false;
  std::array<std::uint64_t, 6> dimensions{};
  std::size_t rank = 0;
  std::vector<GiftiMetaItem> metadata;
  std::vector<GiftiCoordinateSystem> coordinates;
  std::string data;       ///< The text of its Data element.
  std::size_t place = 0;  ///< The byte at which the element begins.

  /// The product of the dimensions, at most 2^63.
  std::uint64_t count() const;
};

struct GiftiDocument {
  std::vector<GiftiMetaItem> metadata;
  std::vector<GiftiArray> arrays;
};

/// The document's XML: the bytes themselves, or what they hold if they are a gzip file.
Result<std::string> giftiText(Context& context, const Scanner& file, InflateAllowance& allowance);

/// Reads the elements of a document. Those that the format does not have where they stand are
/// refused by name. Memory: the document's size and a small multiple of the elements'.
/// Fails as readXml() does, and with kSyntaxError. O(document).
Result<GiftiDocument> parseGifti(Context& context, const Scanner& document);

/// The numbers of an array in row-major order, count() of them. INT32 and UINT8 are exact in
/// doubles. ASCII numbers are rounded to the declared type.
/// Fails with kSyntaxError, kTruncatedFile, kCountTooLarge, kUnsupportedContent, kCancelled; the
/// message has no place. O(count), of memory too, after the data have shown to be that many.
Result<std::vector<double>> decodeGiftiArray(Context& context, const GiftiArray& array,
                                             InflateAllowance& allowance);

/// A failure about an array, with its place and its intent.
Status giftiArrayError(const Scanner& document, const GiftiArray& array, const Status& status);

/// True if the bytes, or what they hold if they are a gzip file, begin as a GIFTI file does.
bool looksLikeGifti(std::string_view bytes);

}  // namespace moduli
