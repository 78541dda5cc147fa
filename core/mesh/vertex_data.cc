#include "core/mesh/vertex_data.h"

#include <algorithm>
#include <bit>
#include <string>

#include "core/mesh/byte_order.h"
#include "core/mesh/freesurfer.h"
#include "core/mesh/gifti_document.h"
#include "core/mesh/read_formats.h"

namespace moduli {
namespace {

struct ValuesJob {
  Context& context;
  Scanner in;
  std::size_t vertex_count;
};

std::string otherCount(std::uint64_t found, std::size_t vertex_count) {
  return "the file has " + std::to_string(found) + " values, but the surface has " +
         std::to_string(vertex_count) + " vertices";
}
constexpr std::string_view kOtherCountHint = "give the values of this very surface";

// Fails unless the values of a FreeSurfer file are one a vertex and there to the last byte.
Status checkValues(const ValuesJob& job) {
  const Scanner& in = job.in;
  if (in.size() < kFreeSurferValuesHeaderSize) {
    return in.byteError(Reason::kTruncatedFile, in.end(), "the file ends within its header",
                        roomHint(Reason::kTruncatedFile));
  }
  const char* count_place = in.at() + kFreeSurferMagicSize;
  const auto count = loadNumber<std::uint32_t>(count_place, std::endian::big);
  const std::size_t body = in.size() - kFreeSurferValuesHeaderSize;
  Scanner behind = in;
  behind.advance(kFreeSurferValuesHeaderSize);
  if (const Reason room = behind.roomFor(count, 4); room != Reason::kOk) {
    return in.byteError(room, count_place, countMessage(count, "values", body), roomHint(room));
  }
  if (body > std::size_t{4} * count) {
    return in.byteError(Reason::kSyntaxError, in.end() - (body - std::size_t{4} * count),
                        "bytes stand behind the last value", "export the file again");
  }
  if (count != job.vertex_count) {
    return in.byteError(Reason::kUnsupportedContent, count_place,
                        otherCount(count, job.vertex_count), kOtherCountHint);
  }
  return {};
}

Result<VertexData> readFreeSurferValues(ValuesJob& job) {
  RETURN_IF_ERROR(checkValues(job));
  VertexData data;
  data.values.resize(job.vertex_count);
  const char* value = job.in.at() + kFreeSurferValuesHeaderSize;
  for (std::size_t v = 0; v < job.vertex_count; ++v, value += 4) {
    if (v % kCheckInterval == 0) RETURN_IF_ERROR(job.context.check());
    data.values[v] = std::bit_cast<float>(loadNumber<std::uint32_t>(value, std::endian::big));
  }
  return data;
}

Result<const GiftiArray*> valueArray(const Scanner& text, const GiftiDocument& document) {
  const GiftiArray* found = nullptr;
  for (const GiftiArray& array : document.arrays) {
    if (array.intent == "NIFTI_INTENT_NODE_INDEX") {
      return giftiArrayError(
          text, array,
          {Reason::kUnsupportedContent, "the file has values for some of the vertices only",
           "write a value for every vertex"});
    }
    if (array.intent != "NIFTI_INTENT_SHAPE" && array.intent != "NIFTI_INTENT_NONE") continue;
    if (found != nullptr) {
      return giftiArrayError(text, array,
                             {Reason::kUnsupportedContent, "the file has a second array of values",
                              "write one array of values to a file"});
    }
    found = &array;
  }
  if (found != nullptr) return found;
  return text.textError(Reason::kUnsupportedContent, text.at(),
                        "the file has no NIFTI_INTENT_SHAPE or NIFTI_INTENT_NONE array",
                        "give a .shape.gii or .func.gii file with one value a vertex");
}

Result<VertexData> readGiftiValues(ValuesJob& job) {
  InflateAllowance allowance = InflateAllowance::forFile(job.in.size());
  ASSIGN_OR_RETURN(const std::string text, giftiText(job.context, job.in, allowance));
  const Scanner document(job.in.name(), text);
  ASSIGN_OR_RETURN(const GiftiDocument parsed, parseGifti(job.context, document));
  ASSIGN_OR_RETURN(const GiftiArray* array, valueArray(document, parsed));
  const auto fail = [&](std::string message, std::string_view hint) {
    return giftiArrayError(document, *array,
                           {Reason::kUnsupportedContent, std::move(message), std::string(hint)});
  };
  if (array->dimensions[0] != array->count()) {
    return fail("has several values a vertex", "write one value a vertex");
  }
  if (array->count() != job.vertex_count) {
    return fail(otherCount(array->count(), job.vertex_count), kOtherCountHint);
  }
  auto values = decodeGiftiArray(job.context, *array, allowance);
  if (!values.ok()) return giftiArrayError(document, *array, values.status());
  VertexData data{*std::move(values), {}};
  for (const GiftiMetaItem& item : array->metadata) {
    if (item.name == "Name") data.name = item.value;
  }
  return data;
}

// The number on the line at the cursor, and nothing else but a comment.
Result<double> numberOfLine(Scanner& in) {
  double value = 0;
  if (!in.number(value)) {
    return in.textError(Reason::kSyntaxError, in.at(), in.found() + " is not a number",
                        "write one number a line");
  }
  in.skipBlanks();
  if (!in.atEnd() && !isLineEnd(in.peek()) && in.peek() != '#') {
    return in.textError(Reason::kSyntaxError, in.at(), in.found() + " stands behind the number",
                        "write one number a line");
  }
  return value;
}

Result<VertexData> readTextValues(ValuesJob& job) {
  Scanner& in = job.in;
  const char* start = in.at();
  VertexData data;
  data.values.reserve(std::min(job.vertex_count, in.size() / 2 + 1));
  in.skipByteOrderMark();
  for (in.skipSpaceAndComments(); !in.atEnd(); in.skipSpaceAndComments()) {
    if (data.values.size() % kCheckInterval == 0) RETURN_IF_ERROR(job.context.check());
    ASSIGN_OR_RETURN(const double value, numberOfLine(in));
    data.values.push_back(value);
  }
  if (data.values.size() == job.vertex_count) return data;
  return in.textError(Reason::kUnsupportedContent, start,
                      otherCount(data.values.size(), job.vertex_count), kOtherCountHint);
}

}  // namespace

Result<VertexData> readVertexData(Context& context, std::string_view bytes, std::string_view name,
                                  std::size_t vertex_count) {
  RETURN_IF_ERROR(context.check());
  ValuesJob job{context, Scanner(name, bytes), vertex_count};
  if (bytes.empty()) {
    return job.in.byteError(Reason::kEmpty, bytes.data(), "the file is empty",
                            "export the values again");
  }
  if (looksLikeGifti(bytes)) return readGiftiValues(job);
  const auto kind = freeSurferFile(bytes);
  if (kind == FreeSurferFile::kValues) return readFreeSurferValues(job);
  if (kind) {
    return job.in.byteError(Reason::kUnsupportedContent, bytes.data(),
                            "the file holds a surface, no values of vertices",
                            "give a file such as lh.sulc or lh.thickness");
  }
  if (looksLikeText(bytes)) return readTextValues(job);
  return job.in.byteError(Reason::kUnknownFormat, bytes.data(),
                          "the content is no GIFTI file, no curvature file of FreeSurfer and no "
                          "text",
                          "convert the values to one of these formats");
}

}  // namespace moduli
