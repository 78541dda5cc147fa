#include "server/service/cones.h"

#include <numbers>
#include <string>

#include "core/base/text.h"
#include "server/service/named_vertex.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

Status refuse(const v1::Cone& cone, const std::string& why, const std::string& hint) {
  return {Reason::kInvalidOption, "a cone at vertex " + std::to_string(cone.vertex()) + why, hint};
}

Status checkCurvature(const v1::Cone& cone, bool on_boundary) {
  const double limit = on_boundary ? kPi : 2 * kPi;
  if (cone.curvature() < limit) return {};
  const std::string curvature = " of curvature " + shortestDouble(cone.curvature()) + ": ";
  return on_boundary ? refuse(cone, curvature + "on the boundary it must be below pi",
                              "the angle there is pi less the curvature, and must be positive")
                     : refuse(cone, curvature + "inside the surface it must be below 2 pi",
                              "the angles there sum to 2 pi less the curvature, and must do so to "
                              "more than 0");
}

}  // namespace

Result<std::vector<Cone>> conesOnSurface(const ConeMessages& cones, const Connectivity& surface,
                                         const VertexPlaces& places) {
  std::vector<Cone> placed;
  std::vector<Index> holder(surface.vertexCount(), kNone);  // The input vertex of a cone there.
  for (const v1::Cone& cone : cones) {
    ASSIGN_OR_RETURN(const Index place, namedVertex("a cone", cone.vertex(), places));
    if (holder[place] == cone.vertex()) {
      return refuse(cone, " is given twice", "give each vertex one curvature");
    }
    if (holder[place] != kNone) {
      return refuse(
          cone,
          " and one at vertex " + std::to_string(holder[place]) + ", which repair has welded to it",
          "give one of the two");
    }
    holder[place] = cone.vertex();
    RETURN_IF_ERROR(checkCurvature(cone, surface.isBoundaryVertex(place)));
    placed.push_back({place, cone.curvature()});
  }
  return placed;
}

Result<BoundaryRule> boundaryRule(v1::ParameterizationOptions::Boundary wanted,
                                  const ConeMessages& messages, const std::vector<Cone>& cones,
                                  const Connectivity& surface) {
  using Options = v1::ParameterizationOptions;
  if (wanted == Options::STRAIGHT) return BoundaryRule::kStraight;
  if (wanted == Options::CIRCLE) return BoundaryRule::kCircle;
  for (std::size_t i = 0; i < cones.size(); ++i) {
    if (!surface.isBoundaryVertex(cones[i].vertex)) continue;
    if (wanted == Options::BOUNDARY_UNSPECIFIED) return BoundaryRule::kStraight;
    return refuse(messages[static_cast<int>(i)],
                  " is on the boundary, and a free one takes the curvature that comes out",
                  "ask for a straight boundary or a circle, or leave the cone out");
  }
  return BoundaryRule::kFree;
}

}  // namespace moduli
