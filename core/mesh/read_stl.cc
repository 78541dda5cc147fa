#include <algorithm>
#include <bit>
#include <string>

#include "core/mesh/read_formats.h"
#include "core/mesh/vertex_welder.h"

/// STL, text and binary. It has no vertices, only corners: those with exactly equal coordinates
/// become one vertex, numbered by first use.
namespace moduli {
namespace {

constexpr std::size_t kHeaderSize = 84;  // 80 bytes of anything, then the count.
constexpr std::size_t kTriangleSize = 50;

std::uint32_t littleEndian32(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool equalWord(std::string_view word, std::string_view expected) {
  return std::ranges::equal(word, expected, {}, lower);
}

class TextStlReader {
 public:
  explicit TextStlReader(ReadJob& job) : job_(job), in_(job.scanner) {}
  Result<TriangleSoup> read();

 private:
  Status expect(std::string_view words);
  Status solid();
  Status facet();
  Status missing(std::string_view expected) const;
  bool nextIs(std::string_view word) const;

  ReadJob& job_;
  Scanner& in_;
  VertexWelder welder_;
  std::vector<Triangle> faces_;
};

Result<TriangleSoup> TextStlReader::read() {
  in_.skipByteOrderMark();
  for (in_.skipSpace(); !in_.atEnd(); in_.skipSpace()) RETURN_IF_ERROR(solid());
  if (faces_.empty()) {
    return in_.textError(Reason::kEmpty, in_.at(), "the file has no facets", kNoFacesHint);
  }
  return TriangleSoup{std::move(welder_).vertices(), std::move(faces_)};
}

bool TextStlReader::nextIs(std::string_view word) const {
  Scanner ahead = in_;
  return equalWord(ahead.word(), word);
}

Status TextStlReader::missing(std::string_view expected) const {
  const bool cut = in_.atEnd();
  const std::string message = in_.found() + " stands where " + std::string(expected) + " should be";
  return in_.textError(
      cut ? Reason::kTruncatedFile : Reason::kSyntaxError, in_.at(), message,
      cut ? roomHint(Reason::kTruncatedFile) : "correct the line, or export the file again");
}

Status TextStlReader::expect(std::string_view words) {
  while (!words.empty()) {
    const std::string_view expected = words.substr(0, words.find(' '));
    words.remove_prefix(std::min(words.size(), expected.size() + 1));
    in_.skipSpace();
    const char* start = in_.at();
    if (!equalWord(in_.word(), expected)) {
      in_.moveTo(start);
      return missing(quoted(expected));
    }
  }
  return {};
}

Status TextStlReader::solid() {
  RETURN_IF_ERROR(expect("solid"));
  in_.skipToLineEnd();  // The name.
  for (in_.skipSpace(); nextIs("facet"); in_.skipSpace()) RETURN_IF_ERROR(facet());
  RETURN_IF_ERROR(expect("endsolid"));
  in_.skipToLineEnd();
  return {};
}

Status TextStlReader::facet() {
  if (faces_.size() % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
  const char* start = in_.at();
  RETURN_IF_ERROR(expect("facet normal"));
  for (int i = 0; i < 3; ++i) {
    in_.skipSpace();
    if (!in_.skipNumber()) return missing("a number of the normal");
  }
  RETURN_IF_ERROR(expect("outer loop"));
  Triangle triangle;
  for (Index& corner : triangle) {
    RETURN_IF_ERROR(expect("vertex"));
    Eigen::Vector3d position;
    for (int i = 0; i < 3; ++i) {
      in_.skipSpace();
      if (!in_.number(position[i])) return missing("a coordinate");
    }
    corner = welder_.add(position);
  }
  RETURN_IF_ERROR(expect("endloop endfacet"));
  if (faces_.size() >= job_.max_faces) {
    return in_.textError(Reason::kMeshTooLarge, start, tooManyFacesMessage(job_.max_faces),
                         kTooManyFacesHint);
  }
  faces_.push_back(triangle);
  return {};
}

Status checkBinarySize(const ReadJob& job) {
  const Scanner& in = job.scanner;
  if (in.size() < kHeaderSize) {
    return in.byteError(Reason::kTruncatedFile, in.end(),
                        "the file ends within the 84 bytes of a binary STL header",
                        roomHint(Reason::kTruncatedFile));
  }
  const char* count_place = in.at() + kHeaderSize - 4;
  const std::uint64_t count = littleEndian32(count_place);
  Scanner body = in;
  body.advance(kHeaderSize);
  if (const Reason room = body.roomFor(count, kTriangleSize); room != Reason::kOk) {
    return in.byteError(room, count_place, countMessage(count, "triangles", body.left()),
                        roomHint(room));
  }
  if (count > job.max_faces) {
    return in.byteError(Reason::kMeshTooLarge, count_place, tooManyFacesMessage(job.max_faces),
                        kTooManyFacesHint);
  }
  if (const std::size_t rest = body.left() - count * kTriangleSize; rest > 0) {
    return in.byteError(Reason::kSyntaxError, in.end() - rest,
                        std::to_string(rest) + " bytes stand behind the last triangle",
                        "the count is too small or the file is damaged; export it again");
  }
  if (count == 0) {
    return in.byteError(Reason::kEmpty, count_place, "the file has no triangles", kNoFacesHint);
  }
  return {};
}

Result<TriangleSoup> readBinaryStl(ReadJob& job) {
  RETURN_IF_ERROR(checkBinarySize(job));
  const char* triangles = job.scanner.at() + kHeaderSize;
  const std::size_t count = (job.scanner.left() - kHeaderSize) / kTriangleSize;
  VertexWelder welder;
  std::vector<Triangle> faces(count);
  for (std::size_t f = 0; f < count; ++f) {
    if (f % kCheckInterval == 0) RETURN_IF_ERROR(job.context.check());
    const char* corner = triangles + f * kTriangleSize + 12;  // Behind the normal.
    for (Index& vertex : faces[f]) {
      Eigen::Vector3d position;
      for (int i = 0; i < 3; ++i, corner += 4) {
        position[i] = std::bit_cast<float>(littleEndian32(corner));
      }
      vertex = welder.add(position);
    }
  }
  return TriangleSoup{std::move(welder).vertices(), std::move(faces)};
}

}  // namespace

bool isSizedBinaryStl(std::string_view bytes) {
  return bytes.size() >= kHeaderSize && (bytes.size() - kHeaderSize) % kTriangleSize == 0 &&
         (bytes.size() - kHeaderSize) / kTriangleSize == littleEndian32(bytes.data() + 80);
}

bool looksLikeAsciiStl(std::string_view bytes) {
  Scanner scanner("", bytes);
  scanner.skipByteOrderMark();
  scanner.skipSpace();
  // A binary header may begin with "solid" too, but has zero bytes in its padding or its count.
  return equalWord(scanner.word(), "solid") &&
         bytes.substr(0, kHeaderSize).find('\0') == std::string_view::npos;
}

Result<TriangleSoup> readStl(ReadJob& job) {
  const std::string_view bytes(job.scanner.at(), job.scanner.left());
  if (!isSizedBinaryStl(bytes) && looksLikeAsciiStl(bytes)) return TextStlReader(job).read();
  return readBinaryStl(job);
}

}  // namespace moduli
