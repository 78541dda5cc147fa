#include "core/matching/capped_disk.h"

#include <complex>
#include <utility>
#include <vector>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/unfold_sphere.h"
#include "core/spherical/disk_map.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/robust_disk.h"

namespace moduli {
namespace {

Points3 onHemisphere(const std::vector<std::complex<double>>& points) {
  Points3 result;
  for (const std::complex<double>& w : points) result.push_back(diskToSphere(w));
  result.push_back(-Eigen::Vector3d::UnitZ());
  return result;
}

bool folds(const Connectivity& surface, const Points3& points) {
  for (const auto& [a, b, c] : surface.faces()) {
    if (spherical::orientationSign(points[a], points[b], points[c]) <= 0) return true;
  }
  return false;
}

}  // namespace

Result<TriangleMesh> cappedDisk(const TriangleMesh& disk) {
  const Connectivity& surface = disk.connectivity();
  TriangleSoup soup{disk.positions(), surface.faces()};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) continue;
    sum += disk.positions()[surface.tail(h)];
    soup.faces.push_back({surface.head(h), surface.tail(h), disk.vertexCount()});
  }
  const auto count = static_cast<double>(soup.faces.size() - surface.faces().size());
  soup.vertices.emplace_back(sum / count);
  return TriangleMesh::fromSoup(std::move(soup));
}

Result<Points3> unfoldHemisphere(Context& context, const TriangleMesh& capped, Points3 points) {
  const Connectivity& surface = capped.connectivity();
  const Index pole = capped.vertexCount() - 1;
  points[pole] = -Eigen::Vector3d::UnitZ();
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.head(h) != pole) continue;
    Eigen::Vector3d& p = points[surface.tail(h)];
    p.z() = 0;
    p.normalize();
  }
  if (!folds(surface, points)) return points;
  return unfoldSphere(context, capped, std::move(points), pole);
}

Result<Points3> conformalHemisphere(Context& context, const TriangleMesh& disk,
                                    const TriangleMesh& capped, bool initial_delaunay) {
  const Connectivity& surface = disk.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, disk.edgeLengths()));
  const std::vector<double> lengths = unitLengths(mollified.lengths);
  const Result<IdealDisk> robust =
      mapToIdealDisk(context, surface, lengths, disk.positions(), initial_delaunay);
  if (robust.ok()) {
    Result<Points3> points = unfoldHemisphere(context, capped, onHemisphere(robust->points));
    if (points.status().reason() != Reason::kFoldedMap) return points;
  } else if (robust.status().reason() != Reason::kNoConvergence) {
    return robust.status();
  }
  ASSIGN_OR_RETURN(const DiskMap linear, mapToDiskLinear(context, surface, lengths));
  return unfoldHemisphere(context, capped, onHemisphere(linear.points));
}

}  // namespace moduli
