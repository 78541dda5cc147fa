#include "server/service/parameterizing.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include "core/parameterize/circle_domain.h"
#include "core/parameterize/disk.h"
#include "core/parameterize/hyperbolic.h"
#include "core/parameterize/layout_measures.h"
#include "core/parameterize/rectangle.h"
#include "core/parameterize/sphere.h"
#include "server/rpc/convert.h"
#include "server/rpc/convert_parameterization.h"
#include "server/service/array_chunks.h"
#include "server/service/flat_targets.h"
#include "server/service/named_vertex.h"
#include "server/service/registering.h"
#include "server/service/subject.h"

namespace moduli {
namespace {

// What is sent is what stands in memory.
static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
static_assert(sizeof(std::complex<double>) == 2 * sizeof(double));
static_assert(sizeof(Triangle) == 3 * sizeof(std::int32_t));

using Options = v1::ParameterizationOptions;

bool startsDelaunay(const Options& message) {
  return !message.has_initial_delaunay() || message.initial_delaunay();
}

bool refines(const Options& message) {
  return !message.has_refine() || message.refine();
}

Result<std::optional<MobiusMap>> mobiusOf(const Options& message) {
  if (message.mobius().empty()) return std::optional<MobiusMap>();
  std::array<std::complex<double>, 4> entries;
  for (int n = 0; n < 4; ++n) entries[n] = {message.mobius(n).re(), message.mobius(n).im()};
  ASSIGN_OR_RETURN(const MobiusMap map,
                   makeMobiusMap(entries[0], entries[1], entries[2], entries[3]));
  return std::optional<MobiusMap>(map);
}

/// The surface's vertices at the corners that a request names; with their numbers in messages.
Result<std::array<Index, 4>> cornersOnSurface(const Options& message, const Subject& subject) {
  std::array<Index, 4> corners;
  for (int n = 0; n < 4; ++n) {
    ASSIGN_OR_RETURN(corners[n], namedVertex("a corner", message.corners(n), subject.places));
    if (!subject.surface().isBoundaryVertex(corners[n])) {
      return Status{Reason::kInvalidOption,
                    "a corner at vertex " + std::to_string(message.corners(n)) +
                        ", which is not on the boundary",
                    "name four boundary vertices in their order, the surface on the left"};
    }
  }
  return corners;
}

Result<SphereOptions> sphereOptions(const Options& message) {
  ASSIGN_OR_RETURN(const std::optional<MobiusMap> mobius, mobiusOf(message));
  return SphereOptions{fromProto(message.method()), startsDelaunay(message), refines(message),
                       mobius};
}

Result<Parameterization> mapSurface(Context& context, const Options& message,
                                    const Subject& subject) {
  const Connectivity& surface = subject.surface();
  const std::vector<double>& lengths = subject.lengths;
  const std::vector<Eigen::Vector3d>& positions = subject.positions();
  switch (message.target()) {
    case Options::SPHERE: {
      ASSIGN_OR_RETURN(const SphereOptions options, sphereOptions(message));
      return parameterizeSphere(context, surface, lengths, positions, options);
    }
    case Options::DISK: {
      ASSIGN_OR_RETURN(const std::optional<MobiusMap> mobius, mobiusOf(message));
      return parameterizeDisk(
          context, surface, lengths, positions,
          {fromProto(message.method()), startsDelaunay(message), refines(message), mobius});
    }
    case Options::RECTANGLE: {
      RETURN_IF_ERROR(checkRectangle(surface));
      ASSIGN_OR_RETURN(const auto corners, cornersOnSurface(message, subject));
      return parameterizeRectangle(context, surface, lengths, positions,
                                   {corners, startsDelaunay(message), refines(message)});
    }
    case Options::CIRCLE_DOMAIN:
      return parameterizeCircleDomain(
          context, surface, lengths, positions,
          {fromProto(message.method()), startsDelaunay(message), refines(message)});
    case Options::HYPERBOLIC: {
      // Edges of another geometry are those of its triangulation, not to be flipped at first.
      const bool flat = !subject.intrinsic || subject.intrinsic->geometry == Geometry::kEuclidean;
      return parameterizeHyperbolic(context, surface, lengths,
                                    {flat && startsDelaunay(message), refines(message)});
    }
    default:
      break;
  }
  return mapToPlane(context, message, subject);
}

// Nothing where cut faces of a gluing make no list of faces.
std::optional<v1::LayoutMeasures> describeLayout(const Subject& subject,
                                                 const Parameterization& map) {
  std::vector<bool> fills;
  std::size_t faces = static_cast<std::size_t>(subject.surface().faceCount());
  if (subject.prepared) {
    for (const Index face : subject.prepared->input_face) fills.push_back(face == kNone);
    faces = subject.soup.faces.size();
  }
  const Result<LayoutMeasures> measures =
      measureLayout(subject.surface(), subject.lengths, map, fills);
  if (!measures.ok()) return std::nullopt;
  // Pieces of faces count each, in what is sent too.
  const auto given =
      fills.empty() ? subject.surface().faceCount() : std::count(fills.begin(), fills.end(), false);
  v1::LayoutMeasures message;
  message.set_faces(static_cast<int>(faces) + measures->mapped_faces - static_cast<int>(given));
  message.set_mapped_faces(measures->mapped_faces);
  message.set_islands(measures->islands);
  message.set_seam_length(measures->seam_length);
  return message;
}

v1::Parameterization describe(const Options& options, const Subject& subject,
                              const Parameterization& map) {
  v1::Parameterization result;
  result.set_target(options.target());
  result.set_refined(map.subdivision.has_value());
  const bool has_methods =
      !isFlatTarget(options.target()) && options.target() != Options::HYPERBOLIC;
  if (has_methods) result.set_method(toProto(map.method));
  *result.mutable_certificate() = toProto(map.certificate);
  if (map.modulus) result.set_modulus(*map.modulus);
  for (const Circle& circle : map.circles) *result.add_circles() = toProto(circle);
  if (map.hyperbolic) *result.mutable_hyperbolic() = toProto(*map.hyperbolic);
  describePlane(subject, map, result);
  if (map.subdivision) {
    result.set_added_vertices(static_cast<int>(map.subdivision->vertices.size()));
    result.set_added_faces(static_cast<int>(map.subdivision->faces.size()) -
                           subject.surface().faceCount());
  }
  return result;
}

std::vector<ArrayView> arraysOf(const ParameterizedSurface& surface) {
  std::vector<ArrayView> arrays = {viewOf(v1::ArrayChunk::POSITIONS, 3, surface.positions),
                                   viewOf(v1::ArrayChunk::FACES, 3, surface.faces),
                                   viewOf(v1::ArrayChunk::POINTS, 2, surface.points),
                                   viewOf(v1::ArrayChunk::CORNERS, 3, surface.corners)};
  if (!surface.parents.empty()) {
    arrays.push_back(viewOf(v1::ArrayChunk::PARENTS, 1, surface.parents));
  }
  if (!surface.carried.empty()) {
    arrays.push_back(viewOf(v1::ArrayChunk::CARRIED, 1, surface.carried));
  }
  if (surface.result.has_hyperbolic()) {
    arrays.push_back(viewOf(v1::ArrayChunk::GEODESICS, 7, surface.geodesics));
  }
  const std::string& atlas = surface.atlas;
  if (!atlas.empty()) {
    arrays.push_back({v1::ArrayChunk::ATLAS_JSON, atlas.size(), 1, atlas.data(), atlas.size()});
  }
  return arrays;
}

}  // namespace

Result<ParameterizedSurface> parameterizeMesh(Context& context, const Backend& backend,
                                              const v1::ParameterizeRequest& request) {
  ASSIGN_OR_RETURN(Subject subject,
                   loadSubject(context, backend, request.source(), request.prepare()));
  std::optional<ReferenceSphere> reference;
  if (request.options().has_registration()) {
    ASSIGN_OR_RETURN(reference, loadReference(context, backend, request, subject));
  }
  ASSIGN_OR_RETURN(Parameterization map, mapSurface(context, request.options(), subject));
  RegisteredSphere registered;
  if (reference) {
    ASSIGN_OR_RETURN(const SphereOptions options, sphereOptions(request.options()));
    ASSIGN_OR_RETURN(registered,
                     registerOnReference(context, *reference, subject, std::move(map), options));
    map = std::move(registered.map);
  }
  std::vector<std::string>& warnings = map.certificate.warnings;
  warnings.insert(warnings.begin(), subject.warnings.begin(), subject.warnings.end());
  ParameterizedSurface surface;
  surface.result = describe(request.options(), subject, map);
  if (auto layout = describeLayout(subject, map)) {
    *surface.result.mutable_layout() = *std::move(layout);
  }
  surface.result.mutable_timing()->insert(context.timing().begin(), context.timing().end());
  if (reference) *surface.result.mutable_registration() = registered.result;
  if (request.omit_arrays()) return surface;
  surface.carried = std::move(registered.carried);
  surface.geodesics = geodesicRows(subject.surface(), subject.positions(), map);
  surface.atlas = atlasText(subject, map);
  static_cast<MappedFaces&>(surface) =
      subject.intrinsic
          ? imageAlone(subject.surface(), map)
          : mapInputFaces(std::move(subject.soup), *subject.prepared, subject.input_corners, map);
  return surface;
}

std::function<std::optional<v1::ParameterizeResponse>()> parameterizationParts(
    std::shared_ptr<const ParameterizedSurface> surface, bool omit_arrays) {
  auto arrays = omit_arrays ? std::vector<ArrayView>() : arraysOf(*surface);
  return inParts<v1::ParameterizeResponse>(
      std::move(arrays), [surface = std::move(surface)](v1::ParameterizeResponse& response) {
        *response.mutable_parameterization() = surface->result;
      });
}

}  // namespace moduli
