#include "core/matching/conformal_sphere.h"

#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/unfold_sphere.h"
#include "core/spherical/robust_map.h"
#include "core/spherical/sphere_map.h"

namespace moduli {
namespace {

/// Beside the mean squared distance of the landmarks: keeps the Möbius map from squeezing.
constexpr double kRotationPreference = 0.001;

}  // namespace

Result<ConformalSphere> conformalSphere(Context& context, const TriangleMesh& mesh,
                                        bool initial_delaunay) {
  const Connectivity& surface = mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, mesh.edgeLengths()));
  ConformalSphere sphere;
  sphere.lengths = unitLengths(mollified.lengths);
  Result<SphereMap> map =
      mapToSphereRobust(context, surface, sphere.lengths, mesh.positions(), initial_delaunay);
  if (map.status().reason() == Reason::kNoConvergence) {
    map = mapToSphereFolding(context, surface, sphere.lengths);
  }
  if (map.status().reason() == Reason::kNoConvergence) {
    // Of points at 0 every face is folded.
    map = SphereMap{Points3(mesh.vertexCount(), Eigen::Vector3d::Zero()), {}};
  }
  RETURN_IF_ERROR(map.status());
  ASSIGN_OR_RETURN(sphere.points, unfoldSphere(context, mesh, std::move(map->points)));
  return sphere;
}

Result<Points3> broughtNear(const Points3& points, const std::vector<PointPair>& pairs) {
  AlignmentOptions alignment;
  alignment.rotation_preference = kRotationPreference;
  ASSIGN_OR_RETURN(const LandmarkAlignment best, alignLandmarks(pairs, alignment));
  Points3 moved;
  for (const Eigen::Vector3d& p : points) moved.push_back(best.map(p).normalized());
  return moved;
}

}  // namespace moduli
