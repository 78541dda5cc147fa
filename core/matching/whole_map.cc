#include "core/matching/whole_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/matching/refinement.h"
#include "core/matching/relaxation.h"

namespace moduli {
namespace {

/// Over all vertices: at every level, and at the last one, where more is new.
constexpr int kSweeps = 1, kLastSweeps = 3;
constexpr double kTolerance = 2e-3;

/// Puts all vertices back in levels of equal ratios, of about twice as many vertices each, and
/// sweeps over them.
Status restoreAll(Context& context, Relaxation& map) {
  const double all = map.vertexCount(), here = map.mesh().vertexCount();
  const double levels = std::max(1.0, std::round(std::log2(all / here)));
  for (double level = 1; level <= levels; ++level) {
    const double wanted = here * std::pow(all / here, level / levels);
    RETURN_IF_ERROR(restoreVertices(context, map, static_cast<Index>(std::lround(wanted))));
    const std::vector<std::vector<Index>> sets = separatedSets(map.mesh(), map.inSweepOrder());
    const int sweeps = level < levels ? kSweeps : kLastSweeps;
    RETURN_IF_ERROR(map.relaxSets(context, sets, sweeps, kOverRelaxation));
  }
  return {};
}

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
  const RefinementOptions work{kLastSweeps, kTolerance, kWild};
  const auto all = static_cast<Index>(positions.size());
  RETURN_IF_ERROR(restoreAll(context, map));
  RETURN_IF_ERROR(repairMap(context, map, work));
  Points3 result;
  result.reserve(positions.size());
  for (Index v = 0; v < all; ++v) result.push_back(map.image(v).direction);
  return result;
}

}  // namespace moduli
