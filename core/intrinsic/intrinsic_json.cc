#include "core/intrinsic/intrinsic_json.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/intrinsic/assemble_surface.h"
#include "core/mesh/scanner.h"

namespace moduli {
namespace {

constexpr std::string_view kFormatName = "moduli-intrinsic-triangulation";
constexpr std::array<std::string_view, 3> kGeometries = {"euclidean", "hyperbolic", "spherical"};
constexpr std::size_t kCheckInterval = std::size_t{1} << 16;
/// Bytes of a file that tell its kind.
constexpr std::size_t kBeginning = 4096;

enum Key : std::size_t { kFormat, kVersion, kGeometry, kVertices, kFaces, kGluing, kLengths };
constexpr std::array<std::string_view, 7> kKeys = {"format", "version", "geometry", "vertices",
                                                   "faces",  "gluing",  "lengths"};
constexpr const char* kKeysHint =
    "its keys are format, version, geometry, vertices, faces, gluing (if need be) and lengths, "
    "once each";
constexpr const char* kFormHint =
    "faces, gluing and lengths are lists with three numbers for each face, format and geometry are "
    "texts, version and vertices whole numbers";
constexpr const char* kJsonHint = "the file is damaged or is no JSON; write it again";

bool isTable(std::size_t key) {
  return key >= kFaces;
}
bool isText(std::size_t key) {
  return key == kFormat || key == kGeometry;
}

/// What a file says, row after row.
struct Document {
  std::array<bool, kKeys.size()> has{};
  std::string format, geometry;
  std::int64_t version = 0, vertices = 0;
  std::vector<Triangle> faces;
  std::vector<Index> gluing;
  std::vector<double> lengths;
};

using Sax = nlohmann::json_sax<nlohmann::json>;

/// Takes the document apart as it is parsed. Nothing nests deeper than the form has it, so that
/// nesting takes no memory. After a false return status() says why.
class DocumentReader final : public Sax {
 public:
  DocumentReader(Context& context, std::size_t size, const IntrinsicJsonOptions& options)
      : context_(context), size_(size), options_(options) {}

  Status status() const { return status_; }
  Document take() { return std::move(document_); }

  bool null() override { return refuse("null"); }
  bool boolean(bool) override { return refuse("a truth value"); }
  bool binary(binary_t&) override { return refuse("binary data"); }

  bool number_integer(number_integer_t value) override { return whole(value); }

  bool number_unsigned(number_unsigned_t value) override {
    if (value <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return whole(static_cast<std::int64_t>(value));
    }
    if (depth_ == kRow && key_ == kLengths) return length(static_cast<double>(value));
    return takesWhole() ? outOfRange() : refuse("a number");
  }

  bool number_float(number_float_t value, const string_t& text) override {
    if (depth_ == kRow && key_ == kLengths) return length(value);
    // Whole numbers of more than 64 bits arrive here, too.
    if (takesWhole() && text.find_first_of(".eE") == std::string::npos) return outOfRange();
    return refuse("the number " + moduli::quoted(text));
  }

  bool string(string_t& value) override {
    if (depth_ != kTop || !isText(key_)) return refuse("a text");
    (key_ == kFormat ? document_.format : document_.geometry) = std::move(value);
    return true;
  }

  bool start_object(std::size_t) override {
    if (depth_ != kOutside) return refuse("an object");
    depth_ = kTop;
    return true;
  }

  bool key(string_t& name) override {
    const auto found = std::ranges::find(kKeys, name);
    if (found == kKeys.end()) {
      return fail(Reason::kSyntaxError,
                  "an intrinsic triangulation has no key " + moduli::quoted(name), kKeysHint);
    }
    key_ = static_cast<std::size_t>(found - kKeys.begin());
    if (std::exchange(document_.has[key_], true)) {
      return fail(Reason::kSyntaxError, "the key " + moduli::quoted(name) + " comes twice",
                  kKeysHint);
    }
    return true;
  }

  bool end_object() override {
    depth_ = kOutside;
    return true;
  }

  bool start_array(std::size_t) override {
    if (depth_ == kTop && isTable(key_)) {
      depth_ = kList;
      row_ = 0;
      return true;
    }
    if (depth_ != kList) return refuse("a list");
    depth_ = kRow;
    column_ = 0;
    if (row_ == options_.max_faces) {
      return fail(Reason::kMeshTooLarge,
                  "has more than " + std::to_string(options_.max_faces) + " faces",
                  "simplify the surface, or raise the limit with --max-faces");
    }
    if (row_ % kCheckInterval == 0) status_ = context_.check();
    if (key_ == kFaces) document_.faces.push_back({kNone, kNone, kNone});
    return status_.ok();
  }

  bool end_array() override {
    if (depth_ == kList) {
      depth_ = kTop;
      return true;
    }
    if (column_ < 3) {
      return fail(Reason::kSyntaxError,
                  rowName() + " has " + std::to_string(column_) + " entries instead of 3",
                  kFormHint);
    }
    depth_ = kList;
    ++row_;
    return true;
  }

  bool parse_error(std::size_t read, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // "[json.exception...] parse error at line 1, column 9: syntax error while ... - ...; last
    // read: '...'": the middle is for people.
    std::string_view words = error.what();
    if (const auto start = words.find("] "); start != words.npos) words.remove_prefix(start + 2);
    if (const auto start = words.find(": "); start != words.npos) words.remove_prefix(start + 2);
    words = words.substr(0, words.find("; last read"));
    words = words.substr(0, kLongestWords);
    const std::string place = "byte " + std::to_string(read == 0 ? 0 : read - 1) + ": ";
    return fail(read > size_ ? Reason::kTruncatedFile : Reason::kSyntaxError,
                place + std::string(words), kJsonHint);
  }

 private:
  enum Depth { kOutside, kTop, kList, kRow };
  static constexpr std::size_t kLongestWords = 300;

  bool fail(Reason reason, const std::string& message, const char* hint) {
    status_ = Status(reason, options_.name + ": " + message, hint);
    return false;
  }

  std::string rowName() const {
    return std::string(kKeys[key_]) + "[" + std::to_string(row_) + "]";
  }

  std::string placeName() const {
    if (depth_ == kOutside) return "the document";
    if (depth_ == kTop) return std::string(kKeys[key_]);
    return depth_ == kList ? rowName() : rowName() + "[" + std::to_string(column_) + "]";
  }

  bool takesWhole() const {
    if (depth_ == kRow) return key_ != kLengths;
    return depth_ == kTop && !isText(key_) && !isTable(key_);
  }

  const char* wanted() const {
    if (depth_ == kOutside) return "an object";
    if (depth_ == kList) return "a list of three numbers";
    if (depth_ == kRow) return key_ == kLengths ? "a number" : "a whole number";
    return isTable(key_) ? "a list" : isText(key_) ? "a text" : "a whole number";
  }

  bool refuse(const std::string& found) {
    return fail(Reason::kSyntaxError, placeName() + " is " + found + " instead of " + wanted(),
                kFormHint);
  }

  bool outOfRange() {
    return fail(Reason::kIndexOutOfRange, placeName() + " is beyond 32 bits",
                "vertices and halfedges are counted from 0");
  }

  bool nextColumn() {
    if (column_ < 3) return true;
    return fail(Reason::kSyntaxError, rowName() + " has more than 3 entries", kFormHint);
  }

  bool whole(std::int64_t value) {
    if (depth_ == kRow && key_ == kLengths) return length(static_cast<double>(value));
    if (depth_ == kRow) return index(value);
    if (!takesWhole()) return refuse("a number");
    (key_ == kVersion ? document_.version : document_.vertices) = value;
    return true;
  }

  bool index(std::int64_t value) {
    if (!nextColumn()) return false;
    if (value != static_cast<Index>(value)) return outOfRange();
    if (key_ == kFaces) {
      document_.faces.back()[column_] = static_cast<Index>(value);
    } else {
      document_.gluing.push_back(static_cast<Index>(value));
    }
    ++column_;
    return true;
  }

  bool length(double value) {
    if (!nextColumn()) return false;
    document_.lengths.push_back(value);
    ++column_;
    return true;
  }

  Context& context_;
  const std::size_t size_;
  const IntrinsicJsonOptions& options_;
  Depth depth_ = kOutside;
  std::size_t key_ = 0;     ///< The key whose value is read.
  std::size_t row_ = 0;     ///< Of its table.
  std::size_t column_ = 0;  ///< Entries that the row has so far.
  Document document_;
  Status status_;
};

Result<Document> parse(Context& context, std::string_view bytes,
                       const IntrinsicJsonOptions& options) {
  // The parser takes a zero byte for the end.
  if (const std::size_t zero = bytes.find('\0'); zero != std::string_view::npos) {
    return Status(Reason::kSyntaxError, "byte " + std::to_string(zero) + ": a zero byte", kJsonHint)
        .withContext(options.name);
  }
  DocumentReader reader(context, bytes.size(), options);
  nlohmann::json::sax_parse(bytes.begin(), bytes.end(), &reader);
  RETURN_IF_ERROR(reader.status());
  return reader.take();
}

Status checkHead(const Document& document) {
  for (std::size_t key = 0; key < kKeys.size(); ++key) {
    if (document.has[key] || key == kGluing) continue;
    return {Reason::kSyntaxError, "the key '" + std::string(kKeys[key]) + "' is missing",
            kKeysHint};
  }
  if (document.format != kFormatName) {
    return {Reason::kUnsupportedContent, "the format is " + moduli::quoted(document.format),
            "this program reads the format '" + std::string(kFormatName) + "'"};
  }
  if (document.version != 1) {
    return {Reason::kUnsupportedContent,
            "version " + std::to_string(document.version) + " of the format is not known",
            "this program reads version 1"};
  }
  if (std::ranges::find(kGeometries, document.geometry) == kGeometries.end()) {
    return {Reason::kSyntaxError, "there is no geometry " + moduli::quoted(document.geometry),
            "it is euclidean, hyperbolic or spherical"};
  }
  if (document.vertices < 1 || document.vertices > std::numeric_limits<Index>::max()) {
    return {Reason::kIndexOutOfRange,
            "the number of vertices is " + std::to_string(document.vertices),
            "give how many vertices the faces use"};
  }
  return {};
}

Status checkRows(const Document& document) {
  const std::size_t faces = document.faces.size();
  const auto complain = [faces](Key key, std::size_t rows) {
    return Status(Reason::kSyntaxError,
                  std::string(kKeys[key]) + " has " + std::to_string(rows) + " rows for " +
                      std::to_string(faces) + " faces",
                  "give one row for each face");
  };
  if (document.lengths.size() != 3 * faces) return complain(kLengths, document.lengths.size() / 3);
  if (document.has[kGluing] && document.gluing.size() != 3 * faces) {
    return complain(kGluing, document.gluing.size() / 3);
  }
  return {};
}

SurfaceTables tablesOf(Document document) {
  SurfaceTables tables;
  const auto geometry = std::ranges::find(kGeometries, document.geometry) - kGeometries.begin();
  tables.geometry = static_cast<Geometry>(geometry);
  tables.vertex_count = static_cast<Index>(document.vertices);
  tables.faces = std::move(document.faces);
  if (document.has[kGluing]) tables.twin = std::move(document.gluing);
  tables.lengths = std::move(document.lengths);
  return tables;
}

/// "  "key": [", a row for each face and "]".
template <typename Entry>
void writeTable(std::string& text, Key key, Index faces, const Entry& entry) {
  text.append("  \"").append(kKeys[key]).append("\": [");
  for (Index h = 0; h < 3 * faces; ++h) {
    text.append(h == 0 ? "\n    [" : h % 3 == 0 ? ",\n    [" : ", ").append(entry(h));
    if (h % 3 == 2) text.push_back(']');
  }
  text.append(key == kLengths ? "\n  ]\n" : "\n  ],\n");
}

}  // namespace

Result<IntrinsicSurface> readIntrinsicJson(Context& context, std::string_view bytes,
                                           const IntrinsicJsonOptions& options) {
  RETURN_IF_ERROR(context.check());
  if (bytes.empty()) {
    return Status(Reason::kEmpty, options.name + ": byte 0: the file is empty", kJsonHint);
  }
  ASSIGN_OR_RETURN(Document document, parse(context, bytes, options));
  RETURN_IF_ERROR(checkHead(document).withContext(options.name));
  RETURN_IF_ERROR(checkRows(document).withContext(options.name));
  auto surface = assembleSurface(context, tablesOf(std::move(document)));
  if (surface.ok()) return surface;
  return surface.status().withContext(options.name);
}

std::string writeIntrinsicJson(const IntrinsicSurface& surface) {
  const Connectivity& c = surface.connectivity;
  std::string text = "{\n";
  text.append("  \"format\": \"").append(kFormatName).append("\",\n  \"version\": 1,\n");
  text.append("  \"geometry\": \"");
  text.append(kGeometries[static_cast<std::size_t>(surface.geometry)]).append("\",\n");
  text.append("  \"vertices\": ").append(std::to_string(c.vertexCount())).append(",\n");
  writeTable(text, kFaces, c.faceCount(), [&](Index h) { return std::to_string(c.tail(h)); });
  writeTable(text, kGluing, c.faceCount(), [&](Index h) { return std::to_string(c.twin(h)); });
  writeTable(text, kLengths, c.faceCount(),
             [&](Index h) { return shortestDouble(surface.lengths[c.edge(h)]); });
  text.append("}\n");
  return text;
}

bool looksLikeIntrinsicJson(std::string_view beginning) {
  return beginning.substr(0, kBeginning).find(kFormatName) != std::string_view::npos;
}

}  // namespace moduli
