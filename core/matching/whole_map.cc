#include "core/matching/whole_map.h"

#include <cmath>
#include <utility>

#include "core/matching/refinement.h"
#include "core/matching/relaxation.h"

namespace moduli {
namespace {

/// Over all vertices, whenever there are twice as many: what is smooth is at rest already.
constexpr int kSweeps = 4;
constexpr double kTolerance = 2e-3;

}  // namespace

Result<Points3> mapWhole(Context& context, const ThinnedSurface& thinned, const TriangleMesh& whole,
                         const SphericalTarget& b, const Points3& points) {
  const Context::Stage stage(context, "whole");
  const auto& positions = whole.positions();
  double area_b = 0;
  for (const auto& [i, j, k] : b.sphere.surface().faces()) {
    area_b += (b.positions[j] - b.positions[i]).cross(b.positions[k] - b.positions[i]).norm() / 2;
  }
  const SphereDomain domain(b.sphere, b.positions, std::sqrt(area_b));
  const double unit = std::sqrt(whole.area());
  std::vector<Eigen::Vector3d> scaled = positions;
  for (Eigen::Vector3d& p : scaled) p /= unit;
  const std::vector<Attraction> none(positions.size());
  Relaxation map(thinned.rings, scaled, domain, none);
  for (std::size_t i = 0; i < points.size(); ++i) {
    map.setImage(thinned.vertices[i], domain.at(points[i]));
  }
  const RefinementOptions work{kSweeps, kTolerance, kWild};
  const auto all = static_cast<Index>(positions.size());
  RETURN_IF_ERROR(restoreVertices(context, map, all, work));
  RETURN_IF_ERROR(repairMap(context, map, work));
  Points3 result;
  result.reserve(positions.size());
  for (Index v = 0; v < all; ++v) result.push_back(map.image(v).direction);
  return result;
}

}  // namespace moduli
