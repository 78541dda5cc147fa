#include <limits>
#include <string>

#include "core/mesh/read_formats.h"

/// OFF: a header word, three counts, vertices, faces; numbers between spaces and comments. Only the
/// counts, and the optional colour behind a face, depend on where a line ends.
namespace moduli {
namespace {

class OffReader {
 public:
  explicit OffReader(ReadJob& job) : job_(job), in_(job.scanner) {}
  Result<TriangleSoup> read();

 private:
  Status header();
  Status count(std::string_view what, std::int64_t& value);
  Status counts();
  Status vertices();
  Status faces();
  Status face();
  Status colorOf(const char* face_start);
  int numbersOnLine() const;
  Status missing(Reason otherwise, std::string_view what) const;

  ReadJob& job_;
  Scanner& in_;
  OffHeader header_;
  std::int64_t vertex_count_ = 0;
  std::int64_t face_count_ = 0;
  bool faces_flow_ = false;  // Several faces stand on a line, so none has a colour.
  TriangleSoup soup_;
  std::vector<Index> polygon_;
};

Result<TriangleSoup> OffReader::read() {
  in_.skipByteOrderMark();
  RETURN_IF_ERROR(header());
  RETURN_IF_ERROR(counts());
  RETURN_IF_ERROR(vertices());
  RETURN_IF_ERROR(faces());
  in_.skipSpaceAndComments();
  if (!in_.atEnd()) {
    return in_.textError(Reason::kSyntaxError, in_.at(),
                         in_.found() + " stands behind the last face",
                         "the counts in the header are too small, or a face has a wrong count");
  }
  return std::move(soup_);
}

Status OffReader::header() {
  in_.skipSpaceAndComments();
  const char* start = in_.at();
  const std::string_view word = in_.word();
  const auto header = parseOffHeader(word);
  if (!header) {
    in_.moveTo(start);
    return in_.textError(Reason::kSyntaxError, start, in_.found() + " stands where 'OFF' should be",
                         "put the word OFF into the first line");
  }
  header_ = *header;
  if (header_.other_dimension) {
    return in_.textError(Reason::kUnsupportedContent, start,
                         quoted(word) + " files have points of another dimension than 3",
                         "project the mesh to three coordinates and write it as OFF");
  }
  in_.skipBlanks();
  if (std::string_view(in_.at(), in_.left()).starts_with("BINARY")) {
    return in_.textError(Reason::kUnsupportedContent, start, "binary OFF is not supported",
                         "write the mesh as text OFF or as PLY");
  }
  return {};
}

Status OffReader::missing(Reason otherwise, std::string_view what) const {
  if (in_.atEnd()) {
    return in_.textError(Reason::kTruncatedFile, in_.at(),
                         "the file ends where " + std::string(what) + " should be",
                         roomHint(Reason::kTruncatedFile));
  }
  return in_.textError(otherwise, in_.at(), in_.found() + " is not " + std::string(what),
                       "correct the line, or export the file again");
}

Status OffReader::count(std::string_view what, std::int64_t& value) {
  const char* start = in_.at();
  if (!in_.integer(value) || value < 0) {
    in_.moveTo(start);
    return missing(Reason::kSyntaxError, what);
  }
  return {};
}

// All three on one line: a file without the third would otherwise be read shifted by one number.
Status OffReader::counts() {
  in_.skipSpaceAndComments();
  const char* start = in_.at();
  std::int64_t edges = 0;
  RETURN_IF_ERROR(count("the number of vertices", vertex_count_));
  in_.skipBlanks();
  RETURN_IF_ERROR(count("the number of faces", face_count_));
  in_.skipBlanks();
  RETURN_IF_ERROR(count("the number of edges (0 will do)", edges));
  // A vertex takes " 0 0 0" at least, a face " 3 0 0 0".
  Reason room = in_.roomFor(vertex_count_, 6);
  if (room != Reason::kOk || vertex_count_ > std::numeric_limits<Index>::max()) {
    room = room == Reason::kOk ? Reason::kCountTooLarge : room;
    return in_.textError(room, start, countMessage(vertex_count_, "vertices", in_.left()),
                         roomHint(room));
  }
  room = in_.roomFor(face_count_, 8);
  if (room != Reason::kOk) {
    return in_.textError(room, start, countMessage(face_count_, "faces", in_.left()),
                         roomHint(room));
  }
  if (static_cast<std::uint64_t>(face_count_) > job_.max_faces) {
    return in_.textError(Reason::kMeshTooLarge, start, tooManyFacesMessage(job_.max_faces),
                         kTooManyFacesHint);
  }
  if (face_count_ == 0) {
    return in_.textError(Reason::kEmpty, start, "the file has no faces", kNoFacesHint);
  }
  return {};
}

// Numbers from the cursor to the end of its line.
int OffReader::numbersOnLine() const {
  Scanner line = in_;
  int count = 0;
  for (line.skipBlanks(); !line.atEnd() && line.skipNumber(); line.skipBlanks()) ++count;
  return count;
}

Status OffReader::vertices() {
  soup_.vertices.reserve(vertex_count_);
  in_.skipSpaceAndComments();
  int extra = (header_.normals ? 3 : 0) + (header_.texture ? 2 : 0);
  // Colours have three parts in some files and four in others; the first vertex tells.
  if (header_.colors) extra += numbersOnLine() == 3 + extra + 3 ? 3 : 4;
  for (std::int64_t v = 0; v < vertex_count_; ++v) {
    if (v % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    Eigen::Vector3d position;
    for (int i = 0; i < 3; ++i) {
      in_.skipSpaceAndComments();
      if (!in_.number(position[i])) return missing(Reason::kSyntaxError, "a coordinate");
    }
    for (int i = 0; i < extra; ++i) {
      in_.skipSpaceAndComments();
      if (!in_.skipNumber()) {
        return missing(Reason::kSyntaxError, "a number of a normal, colour or texture coordinate");
      }
    }
    soup_.vertices.push_back(position);
  }
  return {};
}

Status OffReader::faces() {
  soup_.faces.reserve(face_count_);
  for (std::int64_t f = 0; f < face_count_; ++f) {
    if (f % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    in_.skipSpaceAndComments();
    const char* start = in_.at();
    RETURN_IF_ERROR(face());
    if (!appendFan(soup_.faces, polygon_, job_.max_faces)) {
      return in_.textError(Reason::kMeshTooLarge, start, tooManyFacesMessage(job_.max_faces),
                           kTooManyFacesHint);
    }
    if (f == 0) faces_flow_ = numbersOnLine() > 4;
    if (!faces_flow_) RETURN_IF_ERROR(colorOf(start));
  }
  return {};
}

Status OffReader::face() {
  const char* start = in_.at();
  std::int64_t corners = 0;
  RETURN_IF_ERROR(count("the number of corners of a face", corners));
  if (corners < 3) {
    return in_.textError(Reason::kSyntaxError, start,
                         "a face with " + std::to_string(corners) + " corners",
                         "a face needs 3 corners or more; remove points and edges");
  }
  if (static_cast<std::uint64_t>(corners) > in_.left() / 2) {
    const Reason room = in_.roomFor(corners, 2);
    return in_.textError(room, start, countMessage(corners, "corners", in_.left()), roomHint(room));
  }
  polygon_.clear();
  for (std::int64_t c = 0; c < corners; ++c) {
    in_.skipSpaceAndComments();
    const char* place = in_.at();
    std::int64_t vertex = 0;
    if (!in_.integer(vertex)) return missing(Reason::kSyntaxError, "a vertex number");
    if (vertex < 0 || vertex >= vertex_count_) {
      return in_.textError(Reason::kIndexOutOfRange, place,
                           indexMessage(vertex, vertex_count_) + ", numbered from 0", kIndexHint);
    }
    polygon_.push_back(static_cast<Index>(vertex));
  }
  return {};
}

// Behind a face may stand an index into a colour map, three parts or four.
Status OffReader::colorOf(const char* face_start) {
  int parts = 0;
  for (in_.skipBlanks(); !in_.atEnd() && !isLineEnd(in_.peek()) && in_.peek() != '#';
       in_.skipBlanks(), ++parts) {
    if (!in_.skipNumber()) return missing(Reason::kSyntaxError, "a part of a face's colour");
  }
  if (parts == 2 || parts > 4) {
    return in_.textError(Reason::kSyntaxError, face_start,
                         std::to_string(parts) + " numbers stand behind the corners of a face",
                         "a colour has 1, 3 or 4 parts; or the number of corners is wrong");
  }
  return {};
}

}  // namespace

std::optional<OffHeader> parseOffHeader(std::string_view word) {
  if (!word.ends_with("OFF")) return std::nullopt;
  word.remove_suffix(3);
  OffHeader header;
  while (!word.empty()) {
    bool& seen = word.starts_with("ST")  ? header.texture
                 : word.starts_with("C") ? header.colors
                 : word.starts_with("N") ? header.normals
                                         : header.other_dimension;
    const bool known =
        &seen != &header.other_dimension || word == "4" || word == "n" || word == "4n";
    if (!known || seen) return std::nullopt;
    seen = true;
    word.remove_prefix(&seen == &header.texture || word == "4n" ? 2 : 1);
  }
  return header;
}

Result<TriangleSoup> readOff(ReadJob& job) {
  return OffReader(job).read();
}

}  // namespace moduli
