#include "server/service/subject.h"

#include <numeric>
#include <utility>
#include <variant>

#include "core/intrinsic/chordal_metric.h"
#include "server/rpc/convert.h"
#include "server/service/signing.h"

namespace moduli {
namespace {

Result<Subject> meshSubject(Context& context, TriangleSoup soup, const PrepareOptions& options) {
  const Context::Stage stage(context, "prepare");
  Subject subject;
  subject.soup = std::move(soup);
  ASSIGN_OR_RETURN(subject.prepared, prepareMesh(context, subject.soup, options));
  const PreparedMesh& prepared = *subject.prepared;
  subject.input_corners = inputCorners(subject.soup, prepared);
  subject.places = findVertexPlaces(subject.soup, prepared, subject.input_corners);
  subject.lengths = prepared.mesh.edgeLengths();
  subject.warnings = prepared.warnings;
  for (const RepairAction& action : prepared.actions) {
    subject.warnings.push_back("REPAIRED: " + action.action + " (" + std::to_string(action.count) +
                               ")");
  }
  return subject;
}

Result<Subject> intrinsicSubject(IntrinsicSurface surface, const PrepareOptions& options) {
  RETURN_IF_ERROR(checkIntrinsicPrepare(options));
  Subject subject;
  ASSIGN_OR_RETURN(subject.lengths, chordLengths(surface));
  if (surface.geometry != Geometry::kEuclidean) {
    subject.warnings.emplace_back(
        "CHORDAL_METRIC: what is mapped is the polyhedral surface whose edges are the chords of "
        "these");
  }
  const auto vertices = static_cast<std::size_t>(surface.connectivity.vertexCount());
  subject.places.place.resize(vertices);
  std::iota(subject.places.place.begin(), subject.places.place.end(), 0);
  subject.places.used.assign(vertices, true);
  subject.intrinsic = std::move(surface);
  return subject;
}

}  // namespace

const std::vector<Eigen::Vector3d>& Subject::positions() const {
  static const std::vector<Eigen::Vector3d> none;
  return prepared ? prepared->mesh.positions() : none;
}

Result<Subject> loadSubject(Context& context, const Backend& backend, const v1::MeshSource& source,
                            const v1::PrepareOptions& prepare) {
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, source));
  // Taken from where it is: GCC 12 takes the parts of a moved variant for uninitialized.
  Result<ParsedSurface> parsed = parseSurface(context, backend, file);
  RETURN_IF_ERROR(parsed.status());
  const PrepareOptions options = fromProto(prepare);
  if (auto* intrinsic = std::get_if<IntrinsicSurface>(&*parsed)) {
    return intrinsicSubject(std::move(*intrinsic), options);
  }
  return meshSubject(context, std::move(std::get<TriangleSoup>(*parsed)), options);
}

std::string sourceName(const v1::MeshSource& source, const std::string& otherwise) {
  if (!source.file_name().empty()) return source.file_name();
  return source.has_shape() ? source.shape() : otherwise;
}

Status aboutSurface(const std::string& name, const Status& status) {
  const bool stopped =
      status.reason() == Reason::kCancelled || status.reason() == Reason::kDeadlineExceeded;
  return status.ok() || stopped || status.message().starts_with(name) ? status
                                                                      : status.withContext(name);
}

}  // namespace moduli
