#include <bit>
#include <charconv>
#include <cmath>
#include <string>

#include "core/base/text.h"
#include "core/mesh/base64.h"
#include "core/mesh/byte_order.h"
#include "core/mesh/deflate.h"
#include "core/mesh/gifti.h"
#include "core/mesh/vertex_data.h"

/// GIFTI surfaces and per-vertex values out.
namespace moduli {
namespace {

// XML has no other control characters than these three.
bool isXmlText(std::string_view text) {
  std::string printable(text);
  std::erase_if(printable, [](char c) { return c == '\n' || c == '\r' || c == '\t'; });
  return isPrintableUtf8(printable);
}

Status checkItems(const std::vector<GiftiMetaItem>& items) {
  for (const GiftiMetaItem& item : items) {
    if (!item.name.empty() && isXmlText(item.name) && isXmlText(item.value)) continue;
    return {Reason::kInvalidOption, "a GIFTI tag has no name, or is no text",
            "give names and values in UTF-8 without control characters"};
  }
  return {};
}

Status checkTags(const GiftiTags& tags) {
  for (const auto* items : {&tags.file, &tags.points, &tags.triangles}) {
    RETURN_IF_ERROR(checkItems(*items));
  }
  for (const GiftiCoordinateSystem& system : tags.coordinates) {
    if (isXmlText(system.data_space) && isXmlText(system.transformed_space)) continue;
    return {Reason::kInvalidOption, "the name of a GIFTI coordinate system is no text",
            "give a name such as NIFTI_XFORM_SCANNER_ANAT"};
  }
  return {};
}

Status checkRange(double value, bool doubles, const std::string& what, std::size_t number) {
  if (doubles || !std::isfinite(value) || std::isfinite(static_cast<float>(value))) return {};
  return {Reason::kInvalidOption,
          what + " " + std::to_string(number) + " lies beyond the range of NIFTI_TYPE_FLOAT32",
          "scale the values down, or write doubles"};
}

std::string_view encodingName(GiftiEncoding encoding) {
  switch (encoding) {
    case GiftiEncoding::kAscii:
      return "ASCII";
    case GiftiEncoding::kBase64:
      return "Base64Binary";
    case GiftiEncoding::kGzipBase64:
      break;
  }
  return "GZipBase64Binary";
}

template <typename Number>
void appendText(std::string& text, Number value) {
  std::array<char, 32> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text.append(buffer.data(), end);
}

// The numbers of one array in the making, row by row.
class Numbers {
 public:
  Numbers(GiftiEncoding encoding, std::size_t columns, std::size_t expected)
      : encoding_(encoding), columns_(columns) {
    bytes_.reserve(expected * 4);
  }

  void integer(Index value) {
    if (encoding_ == GiftiEncoding::kAscii) return spell(value);
    appendLittleEndian(bytes_, static_cast<std::uint32_t>(value));
  }
  void real(double value, bool doubles) {
    if (encoding_ == GiftiEncoding::kAscii) {
      return doubles ? spell(value) : spell(static_cast<float>(value));
    }
    if (doubles) return appendLittleEndian(bytes_, std::bit_cast<std::uint64_t>(value));
    appendLittleEndian(bytes_, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  }
  std::string data() const {
    switch (encoding_) {
      case GiftiEncoding::kAscii:
        return bytes_;
      case GiftiEncoding::kBase64:
        return encodeBase64(bytes_);
      case GiftiEncoding::kGzipBase64:
        break;
    }
    return encodeBase64(deflateBytes(bytes_));
  }

 private:
  template <typename Number>
  void spell(Number value) {
    appendText(bytes_, value);
    bytes_ += ++written_ % columns_ == 0 ? '\n' : ' ';
  }

  GiftiEncoding encoding_;
  std::size_t columns_;
  std::size_t written_ = 0;
  std::string bytes_;
};

class GiftiWriter {
 public:
  GiftiWriter(GiftiEncoding encoding, std::size_t arrays) : encoding_(encoding) {
    out_ =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n"
        "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"" +
        std::to_string(arrays) + "\">\n";
  }

  void metadata(const std::vector<GiftiMetaItem>& items) {
    if (items.empty()) {
      out_ += "<MetaData/>\n";
      return;
    }
    out_ += "<MetaData>\n";
    for (const GiftiMetaItem& item : items) {
      out_ += "<MD><Name>" + xmlText(item.name) + "</Name><Value>" + xmlText(item.value) +
              "</Value></MD>\n";
    }
    out_ += "</MetaData>\n";
  }

  void labels() { out_ += "<LabelTable/>\n"; }

  void openArray(std::string_view intent, std::string_view type, std::size_t rows,
                 std::size_t columns) {
    out_.append("<DataArray Intent=\"NIFTI_INTENT_").append(intent);
    out_.append("\" DataType=\"NIFTI_TYPE_").append(type);
    out_ += "\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"";
    out_ += columns > 1 ? "2" : "1";
    out_ += "\" Dim0=\"" + std::to_string(rows) + "\"";
    if (columns > 1) out_ += " Dim1=\"" + std::to_string(columns) + "\"";
    out_.append(" Encoding=\"").append(encodingName(encoding_));
    out_ += "\" Endian=\"LittleEndian\" ExternalFileName=\"\" ExternalFileOffset=\"0\">\n";
  }

  void system(const GiftiCoordinateSystem& system) {
    out_ += "<CoordinateSystemTransformMatrix>\n<DataSpace>" + xmlText(system.data_space) +
            "</DataSpace>\n<TransformedSpace>" + xmlText(system.transformed_space) +
            "</TransformedSpace>\n<MatrixData>";
    for (std::size_t i = 0; i < system.matrix.size(); ++i) {
      appendText(out_, system.matrix[i]);
      out_ += i % 4 == 3 ? '\n' : ' ';
    }
    out_ += "</MatrixData>\n</CoordinateSystemTransformMatrix>\n";
  }

  void closeArray(const Numbers& numbers) {
    out_ += "<Data>" + numbers.data() + "</Data>\n</DataArray>\n";
  }

  std::string take() {
    out_ += "</GIFTI>\n";
    return std::move(out_);
  }

 private:
  GiftiEncoding encoding_;
  std::string out_;
};

void writePoints(GiftiWriter& out, const TriangleSoup& soup, const GiftiWriteOptions& options) {
  out.openArray("POINTSET", options.doubles ? "FLOAT64" : "FLOAT32", soup.vertices.size(), 3);
  out.metadata(options.tags.points);
  for (const GiftiCoordinateSystem& system : options.tags.coordinates) out.system(system);
  if (options.tags.coordinates.empty()) out.system({});
  Numbers numbers(options.encoding, 3, 3 * soup.vertices.size());
  for (const Eigen::Vector3d& p : soup.vertices) {
    for (const double x : p) numbers.real(x, options.doubles);
  }
  out.closeArray(numbers);
}

void writeTriangles(GiftiWriter& out, const TriangleSoup& soup, const GiftiWriteOptions& options) {
  out.openArray("TRIANGLE", "INT32", soup.faces.size(), 3);
  out.metadata(options.tags.triangles);
  Numbers numbers(options.encoding, 3, 3 * soup.faces.size());
  for (const Triangle& t : soup.faces) {
    for (const Index v : t) numbers.integer(v);
  }
  out.closeArray(numbers);
}

}  // namespace

Result<std::string> writeGiftiSurface(const TriangleSoup& soup, const GiftiWriteOptions& options) {
  RETURN_IF_ERROR(checkTags(options.tags));
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    for (const double x : soup.vertices[v]) {
      RETURN_IF_ERROR(checkRange(x, options.doubles, "vertex", v));
    }
  }
  GiftiWriter out(options.encoding, 2);
  out.metadata(options.tags.file);
  out.labels();
  writePoints(out, soup, options);
  writeTriangles(out, soup, options);
  return out.take();
}

Result<std::string> writeGiftiShape(const VertexData& data, const GiftiWriteOptions& options) {
  RETURN_IF_ERROR(checkTags(options.tags));
  std::vector<GiftiMetaItem> name;
  if (!data.name.empty()) name.push_back({"Name", data.name});
  RETURN_IF_ERROR(checkItems(name));
  for (std::size_t v = 0; v < data.values.size(); ++v) {
    RETURN_IF_ERROR(checkRange(data.values[v], options.doubles, "the value of vertex", v));
  }
  GiftiWriter out(options.encoding, 1);
  out.metadata(options.tags.file);
  out.labels();
  out.openArray("SHAPE", options.doubles ? "FLOAT64" : "FLOAT32", data.values.size(), 1);
  out.metadata(name);
  Numbers numbers(options.encoding, 1, data.values.size());
  for (const double x : data.values) numbers.real(x, options.doubles);
  out.closeArray(numbers);
  return out.take();
}

}  // namespace moduli
