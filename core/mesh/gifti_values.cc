#include <bit>
#include <cmath>
#include <limits>

#include "core/mesh/base64.h"
#include "core/mesh/byte_order.h"
#include "core/mesh/gifti_document.h"
#include "core/mesh/read_formats.h"

/// From the text of a GIFTI array to numbers.
namespace moduli {
namespace {

std::size_t sizeOf(GiftiType type) {
  switch (type) {
    case GiftiType::kUint8:
      return 1;
    case GiftiType::kInt32:
    case GiftiType::kFloat32:
      return 4;
    case GiftiType::kFloat64:
      return 8;
  }
  return 8;
}

Status unsupported(std::string message, std::string hint) {
  return {Reason::kUnsupportedContent, std::move(message), std::move(hint)};
}

// Where the i-th number of the file belongs in row-major order.
class Order {
 public:
  explicit Order(const GiftiArray& array)
      : rank_(array.column_major ? array.rank : 0), dimensions_(array.dimensions) {}

  std::size_t operator()(std::size_t i) const {
    if (rank_ < 2) return i;
    // The first index runs fastest in the file, the last one in row-major order.
    std::size_t place = 0;
    for (std::size_t axis = 0; axis < rank_; ++axis) {
      place = place * dimensions_[axis] + i % dimensions_[axis];
      i /= dimensions_[axis];
    }
    return place;
  }

 private:
  std::size_t rank_;
  std::array<std::uint64_t, 6> dimensions_;
};

// A number of an ASCII array in its declared type, or nothing if the type has no such number.
std::optional<double> asType(double value, GiftiType type) {
  switch (type) {
    case GiftiType::kUint8:
      if (!(value >= 0 && value <= 255)) return std::nullopt;
      break;
    case GiftiType::kInt32:
      if (!(value >= -0x1p31 && value < 0x1p31)) return std::nullopt;
      break;
    case GiftiType::kFloat32: {
      const auto rounded = static_cast<float>(value);
      if (std::isinf(rounded) && !std::isinf(value)) return std::nullopt;
      return rounded;
    }
    case GiftiType::kFloat64:
      return value;
  }
  return value == std::trunc(value) ? std::optional(value) : std::nullopt;
}

Status countError(Reason reason, std::uint64_t expected, std::string_view found) {
  return {
      reason,
      "declares " + std::to_string(expected) + " numbers, but the data have " + std::string(found),
      std::string(roomHint(reason))};
}

Result<std::vector<double>> decodeAscii(Context& context, const GiftiArray& array) {
  Scanner in("", array.data);
  const std::uint64_t count = array.count();
  // A number takes a digit, and a space or the end behind it.
  if (const Reason room = in.roomFor(count, 2);
      room != Reason::kOk && count != (in.left() + 1) / 2) {
    return countError(room, count, "fewer");
  }
  const Order order(array);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % kCheckInterval == 0) RETURN_IF_ERROR(context.check());
    in.skipSpace();
    if (in.atEnd()) return countError(Reason::kTruncatedFile, count, std::to_string(i));
    const char* start = in.at();
    double value = 0;
    const bool number = in.number(value);
    const auto typed = number ? asType(value, *array.type) : std::nullopt;
    if (!typed) {
      in.moveTo(start);
      return Status(Reason::kSyntaxError, in.found() + " is no " + array.type_name,
                    "the file is damaged; export it again");
    }
    values[order(i)] = *typed;
  }
  in.skipSpace();
  if (!in.atEnd()) return countError(Reason::kSyntaxError, count, "more");
  return values;
}

double numberAt(const char* bytes, GiftiType type, std::endian order) {
  switch (type) {
    case GiftiType::kUint8:
      return static_cast<unsigned char>(*bytes);
    case GiftiType::kInt32:
      return static_cast<std::int32_t>(loadNumber<std::uint32_t>(bytes, order));
    case GiftiType::kFloat32:
      return std::bit_cast<float>(loadNumber<std::uint32_t>(bytes, order));
    case GiftiType::kFloat64:
      return std::bit_cast<double>(loadNumber<std::uint64_t>(bytes, order));
  }
  return 0;
}

Result<std::endian> byteOrder(const GiftiArray& array) {
  if (array.endian == "LittleEndian") return std::endian::little;
  if (array.endian == "BigEndian") return std::endian::big;
  return Status(Reason::kSyntaxError,
                "Endian=" + quoted(array.endian) + " is neither LittleEndian nor BigEndian",
                "export the file again");
}

Result<std::vector<double>> decodeBinary(Context& context, const GiftiArray& array,
                                         InflateAllowance& allowance) {
  ASSIGN_OR_RETURN(const std::endian endian, byteOrder(array));
  const std::size_t size = sizeOf(*array.type);
  const std::uint64_t count = array.count();
  if (count > std::numeric_limits<std::size_t>::max() / 16) {
    return countError(Reason::kCountTooLarge, count, "fewer");
  }
  ASSIGN_OR_RETURN(std::string bytes, decodeBase64(array.data));
  if (array.encoding == GiftiEncoding::kGzipBase64) {
    ASSIGN_OR_RETURN(bytes, inflateBytes(context, bytes, count * size, allowance));
  }
  if (bytes.size() != count * size) {
    const Scanner have("", bytes);
    const Reason room = have.roomFor(count, size);
    return countError(room == Reason::kOk ? Reason::kSyntaxError : room, count,
                      std::to_string(bytes.size()) + " bytes");
  }
  const Order order(array);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % kCheckInterval == 0) RETURN_IF_ERROR(context.check());
    values[order(i)] = numberAt(bytes.data() + i * size, *array.type, endian);
  }
  return values;
}

}  // namespace

Result<std::vector<double>> decodeGiftiArray(Context& context, const GiftiArray& array,
                                             InflateAllowance& allowance) {
  if (!array.type) {
    return unsupported("numbers of type " + quoted(array.type_name) + " are not supported",
                       "write FLOAT32, FLOAT64, INT32 or UINT8");
  }
  if (!array.encoding) {
    return unsupported("the encoding " + quoted(array.encoding_name) + " is not supported",
                       "write the numbers into the file itself, as GZipBase64Binary");
  }
  if (array.encoding == GiftiEncoding::kAscii) return decodeAscii(context, array);
  return decodeBinary(context, array, allowance);
}

Status giftiArrayError(const Scanner& document, const GiftiArray& array, const Status& status) {
  if (status.reason() == Reason::kCancelled || status.reason() == Reason::kDeadlineExceeded) {
    return status;
  }
  return document.textError(status.reason(), document.at() + array.place,
                            "array " + quoted(array.intent) + ": " + status.message(),
                            status.hint());
}

}  // namespace moduli
