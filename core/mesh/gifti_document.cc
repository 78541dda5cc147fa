#include "core/mesh/gifti_document.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/mesh/xml_reader.h"

namespace moduli {
namespace {

enum class Element : std::uint8_t {
  kDocument,
  kGifti,
  kFileMeta,
  kArrayMeta,
  kItem,
  kName,
  kValue,
  kLabelTable,
  kLabel,
  kArray,
  kSystem,
  kDataSpace,
  kTransformedSpace,
  kMatrix,
  kData,
};

// Which element may stand in which.
struct Rule {
  Element parent;
  std::string_view name;
  Element element;
};
constexpr std::array kRules{
    Rule{Element::kDocument, "GIFTI", Element::kGifti},
    Rule{Element::kGifti, "MetaData", Element::kFileMeta},
    Rule{Element::kGifti, "LabelTable", Element::kLabelTable},
    Rule{Element::kGifti, "DataArray", Element::kArray},
    Rule{Element::kFileMeta, "MD", Element::kItem},
    Rule{Element::kArrayMeta, "MD", Element::kItem},
    Rule{Element::kItem, "Name", Element::kName},
    Rule{Element::kItem, "Value", Element::kValue},
    Rule{Element::kLabelTable, "Label", Element::kLabel},
    Rule{Element::kArray, "MetaData", Element::kArrayMeta},
    Rule{Element::kArray, "CoordinateSystemTransformMatrix", Element::kSystem},
    Rule{Element::kArray, "Data", Element::kData},
    Rule{Element::kSystem, "DataSpace", Element::kDataSpace},
    Rule{Element::kSystem, "TransformedSpace", Element::kTransformedSpace},
    Rule{Element::kSystem, "MatrixData", Element::kMatrix},
};

constexpr std::string_view kDamagedHint = "the file is damaged or of a faulty program";

bool keepsText(Element element) {
  return element == Element::kName || element == Element::kValue ||
         element == Element::kDataSpace || element == Element::kTransformedSpace ||
         element == Element::kMatrix || element == Element::kData;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && isSpace(text.back())) text.remove_suffix(1);
  return text;
}

Status syntaxError(std::string message) {
  return {Reason::kSyntaxError, std::move(message), std::string(kDamagedHint)};
}

// A count in an attribute: decimal digits.
Result<std::uint64_t> countIn(const XmlAttribute& attribute) {
  const auto value = parseInteger(trimmed(attribute.value));
  if (!value || *value < 0) {
    return syntaxError(std::string(attribute.name) + "=" + quoted(attribute.value) +
                       " is not a count");
  }
  return static_cast<std::uint64_t>(*value);
}

std::optional<GiftiType> typeFromName(std::string_view name) {
  if (name == "NIFTI_TYPE_UINT8") return GiftiType::kUint8;
  if (name == "NIFTI_TYPE_INT32") return GiftiType::kInt32;
  if (name == "NIFTI_TYPE_FLOAT32") return GiftiType::kFloat32;
  if (name == "NIFTI_TYPE_FLOAT64") return GiftiType::kFloat64;
  return std::nullopt;
}

std::optional<GiftiEncoding> encodingFromName(std::string_view name) {
  if (name == "ASCII") return GiftiEncoding::kAscii;
  if (name == "Base64Binary") return GiftiEncoding::kBase64;
  if (name == "GZipBase64Binary") return GiftiEncoding::kGzipBase64;
  return std::nullopt;
}

class GiftiHandler : public XmlHandler {
 public:
  Status open(std::string_view name, const std::vector<XmlAttribute>& attributes,
              std::size_t place) override;
  Status close(std::string_view name) override;
  Status text(std::string_view piece) override;
  GiftiDocument take() { return std::move(document_); }

 private:
  Element here() const { return path_.empty() ? Element::kDocument : path_.back(); }
  GiftiArray& array() { return document_.arrays.back(); }

  Status openFile(const std::vector<XmlAttribute>& attributes);
  Status openArray(const std::vector<XmlAttribute>& attributes);
  Status arrayAttribute(const XmlAttribute& attribute, std::optional<std::uint64_t>& rank);
  Status closeItem();
  Status closeMatrix();
  Status closeFile() const;

  GiftiDocument document_;
  std::vector<Element> path_;
  std::string text_;
  GiftiMetaItem item_;
  bool has_data_ = false;
  bool has_matrix_ = false;
  std::optional<std::uint64_t> expected_arrays_;
};

Status GiftiHandler::open(std::string_view name, const std::vector<XmlAttribute>& attributes,
                          std::size_t place) {
  const auto rule = std::ranges::find_if(
      kRules, [&](const Rule& r) { return r.parent == here() && r.name == name; });
  if (rule == kRules.end()) {
    if (path_.empty())
      return syntaxError("the outermost element is " + quoted(name) + ", not GIFTI");
    return syntaxError("an element " + quoted(name) + " has no place here in a GIFTI file");
  }
  path_.push_back(rule->element);
  text_.clear();
  switch (rule->element) {
    case Element::kGifti:
      return openFile(attributes);
    case Element::kItem:
      item_ = {};
      return {};
    case Element::kArray:
      return openArray(attributes);
    case Element::kSystem:
      array().coordinates.emplace_back();
      has_matrix_ = false;
      return {};
    case Element::kData:
      if (has_data_) return syntaxError("a DataArray has a second Data element");
      has_data_ = true;
      array().place = place;
      return {};
    default:
      return {};
  }
}

Status GiftiHandler::text(std::string_view piece) {
  if (keepsText(here())) {
    text_ += piece;
  } else if (here() != Element::kLabel && !trimmed(piece).empty()) {
    return syntaxError(quoted(trimmed(piece)) + " stands between elements");
  }
  return {};
}

Status GiftiHandler::close(std::string_view /*name*/) {
  const Element element = here();
  path_.pop_back();
  switch (element) {
    case Element::kGifti:
      return closeFile();
    case Element::kItem:
      return closeItem();
    case Element::kName:
      item_.name = trimmed(text_);
      return {};
    case Element::kValue:
      item_.value = trimmed(text_);
      return {};
    case Element::kArray:
      return has_data_ ? Status() : syntaxError("a DataArray has no Data element");
    case Element::kSystem:
      return has_matrix_ ? Status() : syntaxError("a coordinate system has no MatrixData");
    case Element::kDataSpace:
      array().coordinates.back().data_space = trimmed(text_);
      return {};
    case Element::kTransformedSpace:
      array().coordinates.back().transformed_space = trimmed(text_);
      return {};
    case Element::kMatrix:
      return closeMatrix();
    case Element::kData:
      array().data = std::move(text_);
      text_ = {};
      return {};
    default:
      return {};
  }
}

Status GiftiHandler::openFile(const std::vector<XmlAttribute>& attributes) {
  for (const XmlAttribute& attribute : attributes) {
    if (attribute.name != "NumberOfDataArrays") continue;
    ASSIGN_OR_RETURN(expected_arrays_, countIn(attribute));
  }
  return {};
}

Status GiftiHandler::openArray(const std::vector<XmlAttribute>& attributes) {
  document_.arrays.emplace_back();
  has_data_ = false;
  std::optional<std::uint64_t> rank;
  array().intent = "NIFTI_INTENT_NONE";
  for (const XmlAttribute& attribute : attributes) {
    RETURN_IF_ERROR(arrayAttribute(attribute, rank));
  }
  if (array().type_name.empty()) return syntaxError("a DataArray has no DataType");
  if (array().encoding_name.empty()) return syntaxError("a DataArray has no Encoding");
  if (array().rank == 0 || rank.value_or(array().rank) != array().rank) {
    return syntaxError("a DataArray's Dimensionality and its Dim0, Dim1... do not agree");
  }
  return {};
}

Status GiftiHandler::arrayAttribute(const XmlAttribute& attribute,
                                    std::optional<std::uint64_t>& rank) {
  const std::string_view name = attribute.name;
  GiftiArray& array = this->array();
  if (name == "Intent") {
    array.intent = attribute.value;
  } else if (name == "DataType") {
    array.type_name = attribute.value;
    array.type = typeFromName(attribute.value);
  } else if (name == "Encoding") {
    array.encoding_name = attribute.value;
    array.encoding = encodingFromName(attribute.value);
  } else if (name == "Endian") {
    array.endian = attribute.value;
  } else if (name == "ArrayIndexingOrder") {
    array.column_major = attribute.value == "ColumnMajorOrder";
    if (!array.column_major && attribute.value != "RowMajorOrder") {
      return syntaxError("ArrayIndexingOrder=" + quoted(attribute.value) +
                         " is neither RowMajorOrder nor ColumnMajorOrder");
    }
  } else if (name == "Dimensionality") {
    ASSIGN_OR_RETURN(rank, countIn(attribute));
  } else if (name.size() == 4 && name.starts_with("Dim") && name[3] >= '0' && name[3] <= '5') {
    // Each once, as XML has it; that none is left out shows in the number of them.
    const auto axis = static_cast<std::size_t>(name[3] - '0');
    ASSIGN_OR_RETURN(array.dimensions[axis], countIn(attribute));
    array.rank = std::max(array.rank, axis + 1);
  }
  return {};
}

Status GiftiHandler::closeItem() {
  if (item_.name.empty()) return syntaxError("an MD element has no Name");
  const bool of_file = here() == Element::kFileMeta;
  (of_file ? document_.metadata : array().metadata).push_back(std::move(item_));
  return {};
}

Status GiftiHandler::closeMatrix() {
  Scanner numbers("", text_);
  for (double& entry : array().coordinates.back().matrix) {
    numbers.skipSpace();
    if (!numbers.number(entry)) return syntaxError("MatrixData has not 16 numbers");
  }
  numbers.skipSpace();
  if (!numbers.atEnd()) return syntaxError("MatrixData has more than 16 numbers");
  has_matrix_ = true;
  return {};
}

Status GiftiHandler::closeFile() const {
  const std::uint64_t found = document_.arrays.size();
  if (expected_arrays_.value_or(found) == found) return {};
  return syntaxError("NumberOfDataArrays is " + std::to_string(*expected_arrays_) +
                     ", but there are " + std::to_string(found));
}

}  // namespace

std::uint64_t GiftiArray::count() const {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 63;
  std::uint64_t product = 1;
  for (std::size_t i = 0; i < rank; ++i) {
    const std::uint64_t factor = dimensions[i];
    if (factor == 0) return 0;
    product = product > kMost / factor ? kMost : product * factor;
  }
  return product;
}

Result<std::string> giftiText(Context& context, const Scanner& file, InflateAllowance& allowance) {
  const std::string_view bytes(file.at(), file.left());
  if (!isGzip(bytes)) return std::string(bytes);
  Result<std::string> text = inflateBytes(context, bytes, allowance.left, allowance);
  if (text.ok() || text.status().reason() == Reason::kCancelled ||
      text.status().reason() == Reason::kDeadlineExceeded) {
    return text;
  }
  const Status& status = text.status();
  return file.byteError(status.reason(), file.at(), status.message(), status.hint());
}

Result<GiftiDocument> parseGifti(Context& context, const Scanner& document) {
  GiftiHandler handler;
  RETURN_IF_ERROR(readXml(context, document, handler));
  return handler.take();
}

bool looksLikeGifti(std::string_view bytes) {
  constexpr std::size_t kSample = 1024;
  std::string inflated;
  if (isGzip(bytes)) {
    inflated = inflateBeginning(bytes, kSample);
    bytes = inflated;
  }
  Scanner scanner("", bytes.substr(0, kSample));
  scanner.skipByteOrderMark();
  scanner.skipSpace();
  const std::string_view beginning(scanner.at(), scanner.left());
  return beginning.starts_with('<') && beginning.find("GIFTI") != std::string_view::npos;
}

}  // namespace moduli
