#include "server/service/matching.h"

#include <string>
#include <utility>
#include <vector>

#include "core/matching/match_surfaces.h"
#include "server/rpc/convert_matching.h"
#include "server/service/array_chunks.h"
#include "server/service/landmarks.h"
#include "server/service/subject.h"

namespace moduli {
namespace {

// What is sent is what stands in memory.
static_assert(sizeof(std::array<double, 3>) == 3 * sizeof(double));

/// One of the two surfaces with its name for messages.
struct Side {
  std::string name;
  Subject subject;
};

Result<Side> loadSide(Context& context, const Backend& backend, const v1::MeshSource& source,
                      const v1::PrepareOptions& prepare, const std::string& otherwise) {
  Side side;
  side.name = sourceName(source, otherwise);
  auto subject = loadSubject(context, backend, source, prepare);
  if (!subject.ok()) return aboutSurface(side.name, subject.status());
  if (subject->intrinsic) {
    return Status(Reason::kUnsupportedContent,
                  side.name + ": an intrinsic triangulation, which has no place in space",
                  "what is matched are meshes: give one");
  }
  side.subject = *std::move(subject);
  return side;
}

std::string vertices(Index count) {
  return std::to_string(count) + (count == 1 ? " vertex" : " vertices");
}

/// What has been done to a surface, and what its side of the map passes over.
void addWarnings(const Side& side, const InputPoints& points, v1::MatchCertificate& certificate) {
  const auto add = [&](const std::string& warning) {
    certificate.add_warnings(side.name + ": " + warning);
  };
  for (const std::string& warning : side.subject.warnings) add(warning);
  if (points.without_image > 0) {
    add("NO_IMAGE: " + vertices(points.without_image) + " of no face that is mapped");
  }
  if (points.beside_hole > 0) {
    add("BESIDE_HOLE: " + vertices(points.beside_hole) +
        " whose images lie in filled holes, put to the faces around them");
  }
}

std::vector<ArrayView> arraysOf(const MatchedMeshes& match, bool omit_arrays, bool inverse) {
  if (omit_arrays) return {};
  std::vector<ArrayView> arrays = {viewOf(v1::ArrayChunk::IMAGE_FACES, 1, match.map.faces),
                                   viewOf(v1::ArrayChunk::IMAGE_WEIGHTS, 3, match.map.weights)};
  if (!inverse) return arrays;
  arrays.push_back(viewOf(v1::ArrayChunk::INVERSE_FACES, 1, match.inverse.faces));
  arrays.push_back(viewOf(v1::ArrayChunk::INVERSE_WEIGHTS, 3, match.inverse.weights));
  return arrays;
}

}  // namespace

Result<MatchedMeshes> matchMeshes(Context& context, const Backend& backend,
                                  const v1::MatchSurfacesRequest& request) {
  ASSIGN_OR_RETURN(const Side a,
                   loadSide(context, backend, request.a(), request.prepare(), "the first surface"));
  ASSIGN_OR_RETURN(const Side b, loadSide(context, backend, request.b(), request.prepare(),
                                          "the second surface"));
  MatchOptions options = fromProto(request.options());
  const v1::MatchOptions& wanted = request.options();
  ASSIGN_OR_RETURN(options.landmarks,
                   matchLandmarks(wanted.landmarks(), wanted.curves(), a.subject, b.subject));
  ASSIGN_OR_RETURN(
      options.soft_landmarks,
      matchLandmarks(wanted.soft_landmarks(), wanted.soft_curves(), a.subject, b.subject));
  ASSIGN_OR_RETURN(const SurfaceMatch match, matchSurfaces(context, a.subject.prepared->mesh,
                                                           b.subject.prepared->mesh, options));
  MatchedMeshes result;
  result.result = toProto(match);
  result.map = inputPoints(a.subject, b.subject, match.images);
  if (request.inverse()) result.inverse = inputPoints(b.subject, a.subject, match.inverse);
  v1::MatchCertificate& certificate = *result.result.mutable_certificate();
  addWarnings(a, result.map, certificate);
  addWarnings(b, result.inverse, certificate);
  result.result.mutable_timing()->insert(context.timing().begin(), context.timing().end());
  return result;
}

std::function<std::optional<v1::MatchSurfacesResponse>()> matchParts(
    std::shared_ptr<const MatchedMeshes> match, const v1::MatchSurfacesRequest& request) {
  auto arrays = arraysOf(*match, request.omit_arrays(), request.inverse());
  return inParts<v1::MatchSurfacesResponse>(
      std::move(arrays), [match = std::move(match)](v1::MatchSurfacesResponse& response) {
        *response.mutable_match() = match->result;
      });
}

}  // namespace moduli
