#include <bit>
#include <cstring>
#include <limits>
#include <string>

#include "core/mesh/ply_header.h"
#include "core/mesh/read_formats.h"

/// PLY, text and binary of both byte orders. Vertices are the x, y, z of `vertex`, faces the lists
/// `vertex_indices` (or `vertex_index`) of `face`; whatever else is declared is stepped over.
namespace moduli {
namespace {

template <typename T>
T loadAs(const char* bytes, bool swap) {
  char ordered[sizeof(T)];
  if (swap) {
    for (std::size_t i = 0; i < sizeof(T); ++i) ordered[i] = bytes[sizeof(T) - 1 - i];
  } else {
    std::memcpy(ordered, bytes, sizeof(T));
  }
  T value;
  std::memcpy(&value, ordered, sizeof(T));
  return value;
}

double loadDouble(const char* bytes, PlyType type, bool swap) {
  switch (type) {
    case PlyType::kInt8:
      return loadAs<std::int8_t>(bytes, swap);
    case PlyType::kUint8:
      return loadAs<std::uint8_t>(bytes, swap);
    case PlyType::kInt16:
      return loadAs<std::int16_t>(bytes, swap);
    case PlyType::kUint16:
      return loadAs<std::uint16_t>(bytes, swap);
    case PlyType::kInt32:
      return loadAs<std::int32_t>(bytes, swap);
    case PlyType::kUint32:
      return loadAs<std::uint32_t>(bytes, swap);
    case PlyType::kFloat32:
      return loadAs<float>(bytes, swap);
    case PlyType::kFloat64:
      return loadAs<double>(bytes, swap);
  }
  return 0;
}

// Integer types only; every one of them is exact in a double.
std::int64_t loadInteger(const char* bytes, PlyType type, bool swap) {
  if (type == PlyType::kInt32) return loadAs<std::int32_t>(bytes, swap);
  return static_cast<std::int64_t>(loadDouble(bytes, type, swap));
}

class PlyReader {
 public:
  explicit PlyReader(ReadJob& job) : job_(job), in_(job.scanner) {}
  Result<TriangleSoup> read();

 private:
  Status checkHeader();
  Status checkVertexElement();
  Status checkFaceElement();
  Status checkCounts();
  Status element(const PlyElement& element);
  Status vertices(const PlyElement& element);
  Status binaryVertices(const PlyElement& element);
  Status vertex(const PlyElement& element);
  Status faces(const PlyElement& element);
  Status binaryTriangles(const PlyElement& element, std::uint64_t& done);
  Status polygon(const PlyProperty& property);
  Status appendPolygon(const char* place);
  Status otherElements(const PlyElement& element);
  Status skip(const PlyProperty& property);
  Status listCount(const PlyProperty& property, std::uint64_t& count);
  Status scalar(PlyType type, double& value);
  Status integer(PlyType type, std::int64_t& value);
  Status checkIndex(std::int64_t index, const char* place) const;
  Status finish();

  bool isText() const { return header_.encoding == PlyEncoding::kText; }
  const PlyElement* findElement(std::string_view name) const;
  Status error(Reason reason, const char* place, std::string_view message,
               std::string_view hint) const;
  Status missing(std::string_view what) const;

  ReadJob& job_;
  Scanner& in_;
  PlyHeader header_;
  bool swap_ = false;
  std::uint64_t vertex_count_ = 0;
  const PlyProperty* coordinates_[3] = {};
  const PlyProperty* corners_ = nullptr;
  TriangleSoup soup_;
  std::vector<Index> polygon_;
};

const PlyElement* PlyReader::findElement(std::string_view name) const {
  for (const PlyElement& element : header_.elements) {
    if (element.name == name) return &element;
  }
  return nullptr;
}

Status PlyReader::error(Reason reason, const char* place, std::string_view message,
                        std::string_view hint) const {
  return isText() ? in_.textError(reason, place, message, hint)
                  : in_.byteError(reason, place, message, hint);
}

Status PlyReader::missing(std::string_view what) const {
  if (!isText() || in_.atEnd()) {
    return error(Reason::kTruncatedFile, isText() ? in_.at() : in_.end(),
                 "the file ends where " + std::string(what) + " should be",
                 roomHint(Reason::kTruncatedFile));
  }
  return in_.textError(Reason::kSyntaxError, in_.at(), in_.found() + " is not " + std::string(what),
                       "correct the line, or export the file again");
}

Result<TriangleSoup> PlyReader::read() {
  ASSIGN_OR_RETURN(header_, readPlyHeader(in_));
  const bool little = std::endian::native == std::endian::little;
  swap_ = header_.encoding == (little ? PlyEncoding::kBigEndian : PlyEncoding::kLittleEndian);
  RETURN_IF_ERROR(checkHeader());
  for (const PlyElement& next : header_.elements) RETURN_IF_ERROR(element(next));
  RETURN_IF_ERROR(finish());
  return std::move(soup_);
}

Status PlyReader::finish() {
  in_.skipSpace();
  if (in_.atEnd()) return {};
  return error(Reason::kSyntaxError, in_.at(), "content stands behind the last element",
               "the counts in the header are too small; export the file again");
}

Status PlyReader::checkHeader() {
  RETURN_IF_ERROR(checkVertexElement());
  RETURN_IF_ERROR(checkFaceElement());
  return checkCounts();
}

Status PlyReader::checkVertexElement() {
  constexpr std::string_view kHint = "export the mesh with 'element vertex' and x, y, z";
  const PlyElement* element = findElement("vertex");
  if (element == nullptr) {
    return in_.textError(Reason::kSyntaxError, header_.end_place, "the header declares no vertices",
                         kHint);
  }
  constexpr std::string_view kNames[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    coordinates_[i] = element->find(kNames[i]);
    if (coordinates_[i] == nullptr || coordinates_[i]->is_list) {
      return in_.textError(Reason::kSyntaxError, element->place,
                           "the vertices have no number " + quoted(kNames[i]), kHint);
    }
  }
  vertex_count_ = element->count;
  return {};
}

Status PlyReader::checkFaceElement() {
  const PlyElement* element = findElement("face");
  if (const PlyElement* strips = findElement("tristrips"); strips != nullptr && strips->count > 0) {
    return in_.textError(Reason::kUnsupportedContent, strips->place,
                         "triangle strips are not supported",
                         "convert the mesh to plain faces, for instance in MeshLab");
  }
  if (element == nullptr || element->count == 0) {
    return in_.textError(Reason::kEmpty, element == nullptr ? header_.end_place : element->place,
                         "the file has no faces", kNoFacesHint);
  }
  corners_ = element->find("vertex_indices");
  if (corners_ == nullptr) corners_ = element->find("vertex_index");
  if (corners_ == nullptr || !corners_->is_list || !isInteger(corners_->type)) {
    return in_.textError(Reason::kSyntaxError, element->place,
                         "the faces have no list of integers 'vertex_indices'",
                         "export the mesh with 'property list uchar int vertex_indices'");
  }
  return {};
}

// Every element must fit into the bytes behind the header.
Status PlyReader::checkCounts() {
  for (const PlyElement& element : header_.elements) {
    std::uint64_t smallest = element.smallestSize(header_.encoding);
    // A face has three corners or more.
    if (element.name == "face") smallest += 3 * (isText() ? 2 : plyTypeSize(corners_->type));
    // The last number of a text needs no space behind it.
    Reason room = Reason::kOk;
    if (smallest > 0 && element.count > (in_.left() + 1) / smallest) {
      room = in_.roomFor(element.count, smallest);
    }
    if (element.name == "vertex" && room == Reason::kOk &&
        element.count > std::numeric_limits<Index>::max()) {
      room = Reason::kCountTooLarge;
    }
    if (room != Reason::kOk) {
      const std::string what = "elements " + quoted(element.name);
      return in_.textError(room, element.place, countMessage(element.count, what, in_.left()),
                           roomHint(room));
    }
    if (element.name == "face" && element.count > job_.max_faces) {
      return in_.textError(Reason::kMeshTooLarge, element.place,
                           tooManyFacesMessage(job_.max_faces), kTooManyFacesHint);
    }
  }
  return {};
}

Status PlyReader::element(const PlyElement& element) {
  if (element.name == "vertex") return vertices(element);
  if (element.name == "face") return faces(element);
  return otherElements(element);
}

Status PlyReader::vertices(const PlyElement& element) {
  soup_.vertices.reserve(element.count);
  if (!isText() && element.fixedSize() > 0) return binaryVertices(element);
  for (std::uint64_t v = 0; v < element.count; ++v) {
    if (v % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    RETURN_IF_ERROR(vertex(element));
  }
  return {};
}

Status PlyReader::binaryVertices(const PlyElement& element) {
  const std::size_t size = element.fixedSize();
  if (element.count > in_.left() / size) return missing("a vertex");
  std::size_t offset[3] = {};
  std::size_t before = 0;
  for (const PlyProperty& property : element.properties) {
    for (int i = 0; i < 3; ++i) {
      if (&property == coordinates_[i]) offset[i] = before;
    }
    before += plyTypeSize(property.type);
  }
  for (std::uint64_t v = 0; v < element.count; ++v, in_.advance(size)) {
    if (v % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    Eigen::Vector3d position;
    for (int i = 0; i < 3; ++i) {
      position[i] = loadDouble(in_.at() + offset[i], coordinates_[i]->type, swap_);
    }
    soup_.vertices.push_back(position);
  }
  return {};
}

Status PlyReader::vertex(const PlyElement& element) {
  Eigen::Vector3d position;
  for (const PlyProperty& property : element.properties) {
    double* target = nullptr;
    for (int i = 0; i < 3; ++i) {
      if (&property == coordinates_[i]) target = &position[i];
    }
    if (target == nullptr) {
      RETURN_IF_ERROR(skip(property));
    } else {
      RETURN_IF_ERROR(scalar(property.type, *target));
    }
  }
  soup_.vertices.push_back(position);
  return {};
}

Status PlyReader::faces(const PlyElement& element) {
  soup_.faces.reserve(element.count);
  std::uint64_t done = 0;
  if (!isText() && element.properties.size() == 1) {
    RETURN_IF_ERROR(binaryTriangles(element, done));
  }
  for (std::uint64_t f = done; f < element.count; ++f) {
    if (f % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    const char* start = in_.at();
    for (const PlyProperty& property : element.properties) {
      RETURN_IF_ERROR(&property == corners_ ? polygon(property) : skip(property));
    }
    RETURN_IF_ERROR(appendPolygon(start));
  }
  return {};
}

// The usual case, fast: "uchar int" lists, as long as they are triangles.
Status PlyReader::binaryTriangles(const PlyElement& element, std::uint64_t& done) {
  const bool usual = plyTypeSize(corners_->count_type) == 1 && plyTypeSize(corners_->type) == 4;
  constexpr std::size_t kSize = 13;
  for (; usual && done < element.count; ++done) {
    if (done % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    if (in_.left() < kSize || in_.peek() != 3) return {};
    Triangle triangle;
    for (int i = 0; i < 3; ++i) {
      const char* place = in_.at() + 1 + 4 * i;
      const auto index = loadAs<std::uint32_t>(place, swap_);
      if (index >= vertex_count_) {
        return checkIndex(loadInteger(place, corners_->type, swap_), place);
      }
      triangle[i] = static_cast<Index>(index);
    }
    soup_.faces.push_back(triangle);
    in_.advance(kSize);
  }
  return {};
}

Status PlyReader::checkIndex(std::int64_t index, const char* place) const {
  if (index >= 0 && static_cast<std::uint64_t>(index) < vertex_count_) return {};
  return error(Reason::kIndexOutOfRange, place,
               indexMessage(index, vertex_count_) + ", numbered from 0", kIndexHint);
}

Status PlyReader::polygon(const PlyProperty& property) {
  std::uint64_t count = 0;
  RETURN_IF_ERROR(listCount(property, count));
  polygon_.clear();
  for (std::uint64_t i = 0; i < count; ++i) {
    if (isText()) in_.skipSpace();
    const char* place = in_.at();
    std::int64_t index = 0;
    RETURN_IF_ERROR(integer(property.type, index));
    RETURN_IF_ERROR(checkIndex(index, place));
    polygon_.push_back(static_cast<Index>(index));
  }
  return {};
}

Status PlyReader::appendPolygon(const char* place) {
  if (isText()) {  // The cursor stood at the end of the line before.
    while (isSpace(*place)) ++place;
  }
  if (polygon_.size() < 3) {
    return error(Reason::kSyntaxError, place,
                 "a face with " + std::to_string(polygon_.size()) + " corners",
                 "a face needs 3 corners or more; remove points and edges");
  }
  if (!appendFan(soup_.faces, polygon_, job_.max_faces)) {
    return error(Reason::kMeshTooLarge, place, tooManyFacesMessage(job_.max_faces),
                 kTooManyFacesHint);
  }
  return {};
}

Status PlyReader::otherElements(const PlyElement& element) {
  if (element.properties.empty()) return {};
  if (const std::size_t size = element.fixedSize(); !isText() && size > 0) {
    if (element.count > in_.left() / size) return missing("an element " + quoted(element.name));
    in_.advance(element.count * size);
    return {};
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (i % kCheckInterval == 0) RETURN_IF_ERROR(job_.context.check());
    for (const PlyProperty& property : element.properties) RETURN_IF_ERROR(skip(property));
  }
  return {};
}

Status PlyReader::skip(const PlyProperty& property) {
  std::uint64_t count = 1;
  if (property.is_list) RETURN_IF_ERROR(listCount(property, count));
  if (!isText()) {
    const std::size_t size = plyTypeSize(property.type);
    if (count > in_.left() / size) return missing("a value of " + quoted(property.name));
    in_.advance(count * size);
    return {};
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    in_.skipSpace();
    if (!in_.skipNumber()) return missing("a value of " + quoted(property.name));
  }
  return {};
}

Status PlyReader::listCount(const PlyProperty& property, std::uint64_t& count) {
  if (isText()) in_.skipSpace();
  const char* place = in_.at();
  std::int64_t value = 0;
  RETURN_IF_ERROR(integer(property.count_type, value));
  if (value < 0) {
    return error(Reason::kSyntaxError, place, "a list of " + std::to_string(value) + " values",
                 "the file is damaged; export it again");
  }
  count = value;
  const std::size_t smallest = isText() ? 2 : plyTypeSize(property.type);
  if (const Reason room = in_.roomFor(count, smallest); room != Reason::kOk) {
    return error(room, place, countMessage(count, "values of " + quoted(property.name), in_.left()),
                 roomHint(room));
  }
  return {};
}

Status PlyReader::scalar(PlyType type, double& value) {
  if (isText()) {
    in_.skipSpace();
    return in_.number(value) ? Status() : missing("a coordinate");
  }
  const std::size_t size = plyTypeSize(type);
  if (in_.left() < size) return missing("a coordinate");
  value = loadDouble(in_.at(), type, swap_);
  in_.advance(size);
  return {};
}

Status PlyReader::integer(PlyType type, std::int64_t& value) {
  if (isText()) {
    in_.skipSpace();
    return in_.integer(value) ? Status() : missing("a whole number");
  }
  const std::size_t size = plyTypeSize(type);
  if (in_.left() < size) return missing("a whole number");
  value = loadInteger(in_.at(), type, swap_);
  in_.advance(size);
  return {};
}

}  // namespace

Result<TriangleSoup> readPly(ReadJob& job) {
  return PlyReader(job).read();
}

}  // namespace moduli
