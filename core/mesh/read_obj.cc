#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "core/mesh/read_formats.h"

/// Wavefront OBJ. A statement is a line; a backslash at its end joins the next one. Only `v` and
/// `f` make a surface; what the format defines beside them is passed over.
namespace moduli {
namespace {

// Statements that describe looks, groups, points, curves or how free-form parts are built.
constexpr std::array<std::string_view, 38> kIgnored = {
    "bevel",  "bmat",   "bsp",    "bzp",        "c_interp", "cdc",    "cdp",  "con",
    "cstype", "ctech",  "curv",   "curv2",      "d_interp", "deg",    "end",  "g",
    "hole",   "l",      "lod",    "maplib",     "mg",       "mtllib", "o",    "p",
    "parm",   "s",      "scrv",   "shadow_obj", "sp",       "stech",  "step", "trace_obj",
    "trim",   "usemap", "usemtl", "vn",         "vp",       "vt"};
static_assert(std::ranges::is_sorted(kIgnored));

// Statements that hold surface or content which this reader cannot produce.
constexpr std::array<std::string_view, 4> kRefused = {"call", "csh", "res", "surf"};

// After these stands a name: a file name may end with a backslash of its own.
bool takesName(std::string_view keyword) {
  return keyword == "o" || keyword == "g" || keyword == "usemtl" || keyword == "mtllib";
}

class ObjReader {
 public:
  explicit ObjReader(ReadJob& job) : job_(job), in_(job.scanner) {}
  Result<TriangleSoup> read();

 private:
  Status statement();
  Status otherStatement(const char* start);
  Status vertex(const char* start);
  Status face(const char* start);
  Status corner();
  Status coordinateError(const char* start, int given) const;
  void skipBlanksJoined();
  bool atStatementEnd() const { return in_.atEnd() || isLineEnd(in_.peek()) || in_.peek() == '#'; }
  Status cornerError() const;

  ReadJob& job_;
  Scanner& in_;
  TriangleSoup soup_;
  std::vector<Index> polygon_;
  unsigned corner_form_ = 0;
  // A face may name a vertex that is defined below it. The largest such index is judged at the end.
  std::int64_t largest_index_ = 0;
  const char* largest_place_ = nullptr;
};

// Blanks, and line ends after a backslash.
void ObjReader::skipBlanksJoined() {
  for (;;) {
    in_.skipBlanks();
    if (in_.left() < 2 || in_.peek() != '\\' || !isLineEnd(in_.at()[1])) return;
    in_.advance(1);
    in_.skipLineEnd();
  }
}

Result<TriangleSoup> ObjReader::read() {
  in_.skipByteOrderMark();
  for (std::size_t count = 1; !in_.atEnd(); ++count) {
    if (count % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    RETURN_IF_ERROR(statement());
    in_.skipToLineEnd();
    in_.skipLineEnd();
  }
  const std::size_t vertex_count = soup_.vertices.size();
  if (largest_index_ > static_cast<std::int64_t>(vertex_count)) {
    return in_.textError(Reason::kIndexOutOfRange, largest_place_,
                         indexMessage(largest_index_, vertex_count), kIndexHint);
  }
  if (soup_.faces.empty()) {
    return in_.textError(Reason::kEmpty, in_.at(), "the file has no faces", kNoFacesHint);
  }
  return std::move(soup_);
}

// Leaves the cursor within the line of the statement, at its end or at a comment.
Status ObjReader::statement() {
  skipBlanksJoined();
  if (atStatementEnd()) return {};
  const char* start = in_.at();
  if (in_.left() > 1 && isBlank(start[1])) {
    if (*start == 'v' || *start == 'f') {
      in_.advance(1);
      return *start == 'v' ? vertex(start) : face(start);
    }
  }
  return otherStatement(start);
}

Status ObjReader::otherStatement(const char* start) {
  const std::string_view keyword = in_.word();
  if (keyword == "v") return vertex(start);
  if (keyword == "f" || keyword == "fo") return face(start);
  if (std::ranges::find(kRefused, keyword) != kRefused.end()) {
    return in_.textError(Reason::kUnsupportedContent, start,
                         "the statement " + quoted(keyword) + " is not supported",
                         "tessellate the model into plain polygons in one file");
  }
  if (!std::ranges::binary_search(kIgnored, keyword)) {
    return in_.textError(Reason::kSyntaxError, start, quoted(keyword) + " is no OBJ statement",
                         "remove the line, or check that the file is OBJ at all");
  }
  for (;;) {
    in_.skipToLineEnd();
    if (in_.atEnd() || takesName(keyword) || in_.at()[-1] != '\\') return {};
    in_.skipLineEnd();
  }
}

// x y z, then nothing, a weight, a colour, or both.
Status ObjReader::vertex(const char* start) {
  Eigen::Vector3d position;
  for (int i = 0; i < 3; ++i) {
    skipBlanksJoined();
    if (!in_.number(position[i])) return coordinateError(start, i);
  }
  skipBlanksJoined();
  int extra = 0;
  for (; !atStatementEnd(); skipBlanksJoined(), ++extra) {
    if (!in_.skipNumber()) {
      return in_.textError(Reason::kSyntaxError, in_.at(), in_.found() + " is not a number",
                           "a vertex is 'v x y z', with an optional weight or colour");
    }
  }
  if (extra == 2 || extra > 4) {
    return in_.textError(Reason::kSyntaxError, start,
                         "a vertex with " + std::to_string(3 + extra) + " numbers",
                         "a vertex is 'v x y z', with an optional weight or colour");
  }
  if (soup_.vertices.size() >= std::numeric_limits<Index>::max()) {
    return in_.textError(Reason::kMeshTooLarge, start, "has more vertices than 32 bits can count",
                         "split or simplify the mesh");
  }
  soup_.vertices.push_back(position);
  return {};
}

Status ObjReader::coordinateError(const char* start, int given) const {
  if (atStatementEnd()) {
    return in_.textError(in_.atEnd() ? Reason::kTruncatedFile : Reason::kSyntaxError, start,
                         "a vertex with " + std::to_string(given) + " coordinates instead of 3",
                         "complete the line, or export the file again");
  }
  return in_.textError(Reason::kSyntaxError, in_.at(), in_.found() + " is not a coordinate",
                       "a vertex is 'v x y z' with decimal numbers in the range of a double");
}

Status ObjReader::face(const char* start) {
  polygon_.clear();
  for (skipBlanksJoined(); !atStatementEnd(); skipBlanksJoined()) RETURN_IF_ERROR(corner());
  if (polygon_.size() < 3) {
    return in_.textError(in_.atEnd() ? Reason::kTruncatedFile : Reason::kSyntaxError, start,
                         "a face with " + std::to_string(polygon_.size()) + " corners",
                         "a face needs 3 corners or more; write edges as 'l'");
  }
  if (!appendFan(soup_.faces, polygon_, job_.max_faces)) {
    return in_.textError(Reason::kMeshTooLarge, start, tooManyFacesMessage(job_.max_faces),
                         kTooManyFacesHint);
  }
  return {};
}

// v, v/vt, v//vn or v/vt/vn, the same form at all corners of a face. 1 is the file's first vertex,
// -1 the latest one above this line.
Status ObjReader::corner() {
  const char* start = in_.at();
  std::array<std::int64_t, 3> index{};
  unsigned form = 0;
  for (unsigned part = 0; part < 3; ++part) {
    if (part > 0) {
      if (in_.atEnd() || in_.peek() != '/') break;
      in_.advance(1);
      if (part == 1 && !in_.atEnd() && in_.peek() == '/') continue;
    }
    const char* stop = in_.integerPrefix(index[part]);
    if (stop == nullptr || index[part] == 0) {
      in_.moveTo(start);
      return cornerError();
    }
    in_.moveTo(stop);
    form |= 1U << part;
  }
  if (!atStatementEnd() && !isBlank(in_.peek()) && in_.peek() != '\\') {
    in_.moveTo(start);
    return cornerError();
  }
  if (!polygon_.empty() && form != corner_form_) {
    in_.moveTo(start);
    return in_.textError(Reason::kSyntaxError, start,
                         "the corner " + in_.found() + " is not of the form of the others",
                         "use one of v, v/vt, v//vn, v/vt/vn for all corners of a face");
  }
  corner_form_ = form;
  const auto defined = static_cast<std::int64_t>(soup_.vertices.size());
  const std::int64_t vertex = index[0] > 0 ? index[0] : defined + 1 + index[0];
  if (vertex < 1 || vertex > std::numeric_limits<Index>::max()) {
    return in_.textError(
        Reason::kIndexOutOfRange, start,
        indexMessage(index[0], soup_.vertices.size()) + (index[0] < 0 ? " above this line" : ""),
        kIndexHint);
  }
  if (vertex > defined && vertex > largest_index_) {
    largest_index_ = vertex;
    largest_place_ = start;
  }
  polygon_.push_back(static_cast<Index>(vertex - 1));
  return {};
}

Status ObjReader::cornerError() const {
  if (in_.peek() == '0' && (in_.left() == 1 || isSpace(in_.at()[1]) || in_.at()[1] == '/')) {
    return in_.textError(Reason::kIndexOutOfRange, in_.at(), "a face uses vertex 0",
                         "OBJ counts vertices from 1");
  }
  return in_.textError(Reason::kSyntaxError, in_.at(), in_.found() + " is not a corner of a face",
                       "a corner is v, v/vt, v//vn or v/vt/vn with whole numbers other than 0");
}

}  // namespace

bool isObjKeyword(std::string_view word) {
  return word == "v" || word == "f" || word == "fo" || std::ranges::binary_search(kIgnored, word) ||
         std::ranges::find(kRefused, word) != kRefused.end();
}

Result<TriangleSoup> readObj(ReadJob& job) {
  return ObjReader(job).read();
}

}  // namespace moduli
