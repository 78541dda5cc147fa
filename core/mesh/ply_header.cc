#include "core/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "core/mesh/read_formats.h"

namespace moduli {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};

// Both spellings in use.
constexpr std::array<TypeName, 16> kTypeNames = {{
    {"char", PlyType::kInt8},
    {"int8", PlyType::kInt8},
    {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},
    {"short", PlyType::kInt16},
    {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},
    {"uint16", PlyType::kUint16},
    {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},
    {"uint", PlyType::kUint32},
    {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},
    {"float32", PlyType::kFloat32},
    {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64},
}};

class HeaderReader {
 public:
  explicit HeaderReader(Scanner& in) : in_(in) {}
  Result<PlyHeader> read();

 private:
  Status line(std::string_view keyword, const char* start);
  Status format();
  Status element(const char* start);
  Status property(const char* start);
  Result<PlyType> type();
  Result<std::string_view> name(std::string_view what);
  void lineEnd();
  Status wrong(std::string_view expected) const;

  Scanner& in_;
  std::string_view line_end_;  // As the first line ends, so do all, and so ends the header.
  std::optional<PlyEncoding> encoding_;
  PlyHeader header_;
};

Status HeaderReader::wrong(std::string_view expected) const {
  const bool cut = in_.atEnd();
  return in_.textError(
      cut ? Reason::kTruncatedFile : Reason::kSyntaxError, in_.at(),
      in_.found() + " stands where " + std::string(expected) + " should be",
      cut ? roomHint(Reason::kTruncatedFile) : "correct the PLY header, or export the file again");
}

// A binary file's first data byte may look like a line end: only the ending of the first line
// counts.
void HeaderReader::lineEnd() {
  if (line_end_.empty()) {
    const char* start = in_.at();
    in_.skipLineEnd();
    line_end_ = {start, static_cast<std::size_t>(in_.at() - start)};
    return;
  }
  const bool same = std::string_view(in_.at(), in_.left()).starts_with(line_end_);
  in_.advance(same ? line_end_.size() : std::min<std::size_t>(in_.left(), 1));
}

Result<PlyHeader> HeaderReader::read() {
  if (in_.word() != "ply") {
    in_.moveTo(in_.end() - in_.size());
    return wrong("'ply'");
  }
  for (;;) {
    in_.skipBlanks();
    if (in_.atEnd() || !isLineEnd(in_.peek())) return wrong("the end of the line");
    lineEnd();
    in_.skipBlanks();
    const char* start = in_.at();
    const std::string_view keyword = in_.word();
    header_.end_place = start;
    if (keyword == "end_header") break;
    RETURN_IF_ERROR(line(keyword, start));
  }
  if (!encoding_) {
    return in_.textError(Reason::kSyntaxError, header_.end_place, "the header has no line 'format'",
                         "add 'format ascii 1.0', or export the file again");
  }
  in_.skipBlanks();
  if (!in_.atEnd() && !isLineEnd(in_.peek())) return wrong("the end of the line");
  lineEnd();
  header_.encoding = *encoding_;
  return std::move(header_);
}

Status HeaderReader::line(std::string_view keyword, const char* start) {
  in_.skipBlanks();
  if (keyword == "comment" || keyword == "obj_info") {
    in_.skipToLineEnd();
    return {};
  }
  if (keyword == "format") return format();
  if (keyword == "element") return element(start);
  if (keyword == "property") return property(start);
  in_.moveTo(start);
  return wrong("'element', 'property', 'comment' or 'end_header'");
}

Status HeaderReader::format() {
  const char* start = in_.at();
  const std::string_view word = in_.word();
  if (word == "ascii") {
    encoding_ = PlyEncoding::kText;
  } else if (word == "binary_little_endian") {
    encoding_ = PlyEncoding::kLittleEndian;
  } else if (word == "binary_big_endian") {
    encoding_ = PlyEncoding::kBigEndian;
  } else {
    in_.moveTo(start);
    return wrong("'ascii', 'binary_little_endian' or 'binary_big_endian'");
  }
  in_.skipBlanks();
  const char* version = in_.at();
  if (in_.word() != "1.0") {
    in_.moveTo(version);
    return wrong("the version 1.0");
  }
  return {};
}

Result<std::string_view> HeaderReader::name(std::string_view what) {
  in_.skipBlanks();
  const std::string_view word = in_.word();
  if (word.empty()) return wrong(what);
  return word;
}

Status HeaderReader::element(const char* start) {
  PlyElement element;
  element.place = start;
  ASSIGN_OR_RETURN(element.name, name("the name of the element"));
  for (const PlyElement& other : header_.elements) {
    if (other.name != element.name) continue;
    return in_.textError(Reason::kSyntaxError, start,
                         "the element " + quoted(element.name) + " is declared twice",
                         "correct the PLY header, or export the file again");
  }
  in_.skipBlanks();
  std::int64_t count = 0;
  const char* place = in_.at();
  if (!in_.integer(count) || count < 0) {
    in_.moveTo(place);
    return wrong("a count of elements");
  }
  element.count = count;
  header_.elements.push_back(std::move(element));
  return {};
}

Result<PlyType> HeaderReader::type() {
  in_.skipBlanks();
  const char* start = in_.at();
  const std::string_view word = in_.word();
  for (const TypeName& known : kTypeNames) {
    if (known.name == word) return known.type;
  }
  in_.moveTo(start);
  return wrong("a type such as 'float' or 'int32'");
}

Status HeaderReader::property(const char* start) {
  if (header_.elements.empty()) {
    in_.moveTo(start);
    return wrong("'element'");
  }
  PlyElement& element = header_.elements.back();
  PlyProperty property;
  const char* first = in_.at();
  property.is_list = in_.word() == "list";
  if (property.is_list) {
    ASSIGN_OR_RETURN(property.count_type, type());
    if (!isInteger(property.count_type)) {
      return in_.textError(Reason::kSyntaxError, start, "a list whose count is not an integer",
                           "correct the PLY header, or export the file again");
    }
  } else {
    in_.moveTo(first);
  }
  ASSIGN_OR_RETURN(property.type, type());
  ASSIGN_OR_RETURN(property.name, name("the name of the property"));
  if (element.find(property.name) != nullptr) {
    return in_.textError(Reason::kSyntaxError, start,
                         "the property " + quoted(property.name) + " is declared twice",
                         "correct the PLY header, or export the file again");
  }
  element.properties.push_back(property);
  return {};
}

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
  const auto found = std::ranges::find(properties, property, &PlyProperty::name);
  return found == properties.end() ? nullptr : &*found;
}

std::uint64_t PlyElement::smallestSize(PlyEncoding encoding) const {
  if (encoding == PlyEncoding::kText) return 2 * properties.size();
  std::uint64_t size = 0;
  for (const PlyProperty& property : properties) {
    size += plyTypeSize(property.is_list ? property.count_type : property.type);
  }
  return size;
}

std::size_t PlyElement::fixedSize() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties) {
    if (property.is_list) return 0;
    size += plyTypeSize(property.type);
  }
  return size;
}

Result<PlyHeader> readPlyHeader(Scanner& in) {
  return HeaderReader(in).read();
}

}  // namespace moduli
