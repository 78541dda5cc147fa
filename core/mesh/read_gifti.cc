#include <limits>
#include <string>

#include "core/mesh/gifti.h"
#include "core/mesh/gifti_document.h"
#include "core/mesh/read_formats.h"

/// GIFTI surfaces: the points and the triangles among a file's arrays.
namespace moduli {
namespace {

constexpr std::string_view kPoints = "NIFTI_INTENT_POINTSET";
constexpr std::string_view kTriangles = "NIFTI_INTENT_TRIANGLE";

class GiftiReader {
 public:
  GiftiReader(ReadJob& job, const Scanner& text, InflateAllowance allowance)
      : job_(job), text_(text), allowance_(allowance) {}
  Result<GiftiSurface> read();

 private:
  Result<const GiftiArray*> only(const GiftiDocument& document, std::string_view intent) const;
  Status checkShape(const GiftiArray& array) const;
  Status checkTypes(const GiftiArray& points, const GiftiArray& triangles) const;
  Status points(const GiftiArray& array);
  Status triangles(const GiftiArray& array);
  Status fail(const GiftiArray& array, Reason reason, std::string message,
              std::string_view hint) const {
    return giftiArrayError(text_, array, {reason, std::move(message), std::string(hint)});
  }

  ReadJob& job_;
  const Scanner& text_;
  InflateAllowance allowance_;
  GiftiSurface surface_;
};

Result<GiftiSurface> GiftiReader::read() {
  ASSIGN_OR_RETURN(GiftiDocument document, parseGifti(job_.context, text_));
  ASSIGN_OR_RETURN(const GiftiArray* point_array, only(document, kPoints));
  ASSIGN_OR_RETURN(const GiftiArray* triangle_array, only(document, kTriangles));
  RETURN_IF_ERROR(checkShape(*point_array));
  RETURN_IF_ERROR(checkShape(*triangle_array));
  RETURN_IF_ERROR(checkTypes(*point_array, *triangle_array));
  RETURN_IF_ERROR(points(*point_array));
  RETURN_IF_ERROR(triangles(*triangle_array));
  surface_.tags.file = std::move(document.metadata);
  surface_.tags.points = point_array->metadata;
  surface_.tags.triangles = triangle_array->metadata;
  surface_.tags.coordinates = point_array->coordinates;
  return std::move(surface_);
}

Result<const GiftiArray*> GiftiReader::only(const GiftiDocument& document,
                                            std::string_view intent) const {
  const GiftiArray* found = nullptr;
  for (const GiftiArray& array : document.arrays) {
    if (array.intent != intent) continue;
    if (found != nullptr) {
      return fail(array, Reason::kUnsupportedContent, "the file has a second one",
                  "write one surface to a file");
    }
    found = &array;
  }
  if (found == nullptr) {
    return text_.textError(Reason::kUnsupportedContent, text_.at(),
                           "the file has no " + std::string(intent) + " array, so no surface",
                           "give the .surf.gii file, which has the points and the triangles");
  }
  return found;
}

Status GiftiReader::checkShape(const GiftiArray& array) const {
  const std::uint64_t rows = array.dimensions[0];
  if (array.rank != 2 || array.dimensions[1] != 3) {
    return fail(array, Reason::kSyntaxError, "is no table with 3 columns", "export the file again");
  }
  const bool of_triangles = array.intent == kTriangles;
  if (of_triangles && rows > job_.max_faces) {
    return fail(array, Reason::kMeshTooLarge, tooManyFacesMessage(job_.max_faces),
                kTooManyFacesHint);
  }
  if (!of_triangles && rows > std::numeric_limits<Index>::max()) {
    return fail(array, Reason::kCountTooLarge,
                countMessage(rows, "vertices", text_.size() - array.place),
                roomHint(Reason::kCountTooLarge));
  }
  if (of_triangles && rows == 0) {
    return fail(array, Reason::kEmpty, "the file has no triangles", kNoFacesHint);
  }
  return {};
}

Status GiftiReader::checkTypes(const GiftiArray& points, const GiftiArray& triangles) const {
  if (points.type == GiftiType::kInt32 || points.type == GiftiType::kUint8) {
    return fail(points, Reason::kUnsupportedContent, "coordinates are of type " + points.type_name,
                "write them as NIFTI_TYPE_FLOAT32");
  }
  if (triangles.type && triangles.type != GiftiType::kInt32) {
    return fail(triangles, Reason::kUnsupportedContent,
                "vertex numbers are of type " + triangles.type_name,
                "write them as NIFTI_TYPE_INT32");
  }
  return {};
}

Status GiftiReader::points(const GiftiArray& array) {
  const auto values = decodeGiftiArray(job_.context, array, allowance_);
  if (!values.ok()) return giftiArrayError(text_, array, values.status());
  std::vector<Eigen::Vector3d>& vertices = surface_.soup.vertices;
  vertices.reserve(values->size() / 3);
  for (std::size_t i = 0; i < values->size(); i += 3) {
    vertices.emplace_back((*values)[i], (*values)[i + 1], (*values)[i + 2]);
  }
  return {};
}

Status GiftiReader::triangles(const GiftiArray& array) {
  const auto values = decodeGiftiArray(job_.context, array, allowance_);
  if (!values.ok()) return giftiArrayError(text_, array, values.status());
  const std::size_t count = surface_.soup.vertices.size();
  std::vector<Triangle>& faces = surface_.soup.faces;
  faces.resize(values->size() / 3);
  for (std::size_t i = 0; i < values->size(); ++i) {
    const double vertex = (*values)[i];
    if (vertex < 0 || vertex >= static_cast<double>(count)) {
      return fail(array, Reason::kIndexOutOfRange,
                  indexMessage(static_cast<std::int64_t>(vertex), count) + ", numbered from 0",
                  kIndexHint);
    }
    faces[i / 3][i % 3] = static_cast<Index>(vertex);
  }
  return {};
}

Result<GiftiSurface> readSurface(ReadJob& job) {
  InflateAllowance allowance = InflateAllowance::forFile(job.scanner.size());
  ASSIGN_OR_RETURN(const std::string text, giftiText(job.context, job.scanner, allowance));
  const Scanner document(job.scanner.name(), text);
  return GiftiReader(job, document, allowance).read();
}

}  // namespace

Result<TriangleSoup> readGifti(ReadJob& job) {
  ASSIGN_OR_RETURN(GiftiSurface surface, readSurface(job));
  return std::move(surface.soup);
}

Result<GiftiSurface> readGiftiSurface(Context& context, std::string_view bytes,
                                      const ReadOptions& options) {
  RETURN_IF_ERROR(context.check());
  ReadJob job = readJob(context, bytes, options);
  RETURN_IF_ERROR(checkNotEmpty(job));
  return readSurface(job);
}

}  // namespace moduli
