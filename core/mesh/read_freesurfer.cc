#include <bit>
#include <limits>
#include <string>

#include "core/mesh/byte_order.h"
#include "core/mesh/freesurfer.h"
#include "core/mesh/read_formats.h"

/// FreeSurfer's binary surfaces: three magic bytes, a comment of text lines, V and F in 32 bits,
/// V x 3 float32, F x 3 int32, all big-endian; behind them tags (volume geometry, command lines),
/// which are passed over. Coordinates are those of the file, in surface RAS (mm): the offset that
/// the volume geometry may tell is not applied. Corners keep their order.
namespace moduli {
namespace {

constexpr std::size_t kVertexSize = 12;
constexpr std::size_t kFaceSize = 12;

std::uint32_t bigEndian32(const char* bytes) {
  return loadNumber<std::uint32_t>(bytes, std::endian::big);
}

class FreeSurferReader {
 public:
  explicit FreeSurferReader(ReadJob& job) : job_(job), in_(job.scanner) {}
  Result<TriangleSoup> read();

 private:
  Status magic();
  Status comment();
  Status counts();
  Status vertices();
  Status faces();

  ReadJob& job_;
  Scanner& in_;
  std::uint32_t vertex_count_ = 0;
  std::uint32_t face_count_ = 0;
  TriangleSoup soup_;
};

Result<TriangleSoup> FreeSurferReader::read() {
  RETURN_IF_ERROR(magic());
  RETURN_IF_ERROR(comment());
  RETURN_IF_ERROR(counts());
  RETURN_IF_ERROR(vertices());
  RETURN_IF_ERROR(faces());
  return std::move(soup_);
}

Status FreeSurferReader::magic() {
  const auto kind = freeSurferFile({in_.at(), in_.left()});
  if (kind == FreeSurferFile::kTriangles) {
    in_.advance(kFreeSurferMagicSize);
    return {};
  }
  if (kind == FreeSurferFile::kQuads) {
    return in_.byteError(Reason::kUnsupportedContent, in_.at(),
                         "surfaces of quadrangles, as FreeSurfer wrote before 1999, are not "
                         "supported",
                         "convert the file with mris_convert");
  }
  if (kind == FreeSurferFile::kValues) {
    return in_.byteError(Reason::kUnsupportedContent, in_.at(),
                         "the file holds values of vertices, no surface",
                         "give the surface that they belong to, such as lh.white or lh.pial");
  }
  const bool cut = in_.left() < kFreeSurferMagicSize;
  return in_.byteError(cut ? Reason::kTruncatedFile : Reason::kSyntaxError, in_.at(),
                       "the file does not begin with FF FF FE",
                       "give a binary surface of FreeSurfer");
}

// Programs end it with one line end or two, and write one line or several. It is text, and the
// count behind it begins with a byte that is none: a byte below 9, as no surface has 150 million
// vertices.
Status FreeSurferReader::comment() {
  const char* start = in_.at();
  const auto is_text = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 || isSpace(c);
  };
  while (!in_.atEnd() && is_text(in_.peek())) in_.advance(1);
  if (in_.atEnd()) {
    return in_.byteError(Reason::kTruncatedFile, in_.at(), "the file ends within its comment",
                         roomHint(Reason::kTruncatedFile));
  }
  if (in_.at() == start || in_.at()[-1] != '\n') {
    return in_.byteError(Reason::kSyntaxError, in_.at(), "the comment does not end with a line end",
                         "the file is damaged; export it again");
  }
  return {};
}

Status FreeSurferReader::counts() {
  const char* place = in_.at();
  if (in_.left() < 8) {
    return in_.byteError(Reason::kTruncatedFile, in_.end(), "the file ends within its two counts",
                         roomHint(Reason::kTruncatedFile));
  }
  vertex_count_ = bigEndian32(place);
  face_count_ = bigEndian32(place + 4);
  in_.advance(8);
  if (const Reason room = in_.roomFor(vertex_count_, kVertexSize); room != Reason::kOk) {
    return in_.byteError(room, place, countMessage(vertex_count_, "vertices", in_.left()),
                         roomHint(room));
  }
  Scanner behind = in_;
  behind.advance(vertex_count_ * kVertexSize);
  if (const Reason room = behind.roomFor(face_count_, kFaceSize); room != Reason::kOk) {
    return in_.byteError(room, place + 4, countMessage(face_count_, "triangles", behind.left()),
                         roomHint(room));
  }
  if (face_count_ > job_.max_faces) {
    return in_.byteError(Reason::kMeshTooLarge, place + 4, tooManyFacesMessage(job_.max_faces),
                         kTooManyFacesHint);
  }
  if (face_count_ == 0) {
    return in_.byteError(Reason::kEmpty, place + 4, "the file has no triangles", kNoFacesHint);
  }
  return {};
}

Status FreeSurferReader::vertices() {
  soup_.vertices.resize(vertex_count_);
  for (std::size_t v = 0; v < vertex_count_; ++v) {
    if (v % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    for (int i = 0; i < 3; ++i, in_.advance(4)) {
      soup_.vertices[v][i] = std::bit_cast<float>(bigEndian32(in_.at()));
    }
  }
  return {};
}

Status FreeSurferReader::faces() {
  soup_.faces.resize(face_count_);
  for (std::size_t f = 0; f < face_count_; ++f) {
    if (f % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    for (Index& corner : soup_.faces[f]) {
      const std::uint32_t vertex = bigEndian32(in_.at());
      if (vertex >= vertex_count_) {
        return in_.byteError(
            Reason::kIndexOutOfRange, in_.at(),
            indexMessage(static_cast<std::int32_t>(vertex), vertex_count_) + ", numbered from 0",
            kIndexHint);
      }
      corner = static_cast<Index>(vertex);
      in_.advance(4);
    }
  }
  return {};
}

}  // namespace

std::optional<FreeSurferFile> freeSurferFile(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFF\xFE")) return FreeSurferFile::kTriangles;
  if (bytes.starts_with("\xFF\xFF\xFD")) return FreeSurferFile::kQuads;
  if (!bytes.starts_with("\xFF\xFF\xFF")) return std::nullopt;
  if (bytes.size() < kFreeSurferValuesHeaderSize) return FreeSurferFile::kValues;  // Cut off.
  const char* words = bytes.data() + kFreeSurferMagicSize;
  if (bigEndian32(words + 8) != 1) return FreeSurferFile::kQuads;
  const std::uint64_t vertices = bigEndian32(words) >> 8;
  const std::uint64_t quads = bigEndian32(words + 2) & 0xFFFFFFU;
  const bool fits_quads = bytes.size() == 9 + 6 * vertices + 12 * quads;
  const bool fits_values =
      bytes.size() == kFreeSurferValuesHeaderSize + 4 * std::uint64_t{bigEndian32(words)};
  return fits_quads && !fits_values ? FreeSurferFile::kQuads : FreeSurferFile::kValues;
}

Result<TriangleSoup> readFreeSurfer(ReadJob& job) {
  return FreeSurferReader(job).read();
}

}  // namespace moduli
