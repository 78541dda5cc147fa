#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/forms/cotan.h"
#include "core/mesh/double_cover.h"
#include "core/spherical/disk_finish.h"
#include "core/spherical/disk_map.h"

namespace moduli {
namespace {

/// n.x = offset.
struct Plane {
  Eigen::Vector3d normal;
  double offset = 0;
};

/// The least-squares plane of the boundary vertices' points.
Plane boundaryPlane(const Connectivity& surface, const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!surface.isBoundaryVertex(v)) continue;
    mean += points[v];
    ++count;
  }
  mean /= count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!surface.isBoundaryVertex(v)) continue;
    const Eigen::Vector3d off = points[v] - mean;
    spread += off * off.transpose();
  }
  // Eigenvalues ascend.
  const Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

/// Positions of the double whose second copy is mirrored in the plane of the boundary: closer to a
/// round surface, whose Gauss map may serve as a start, than two copies in one place.
std::vector<Eigen::Vector3d> doubledPositions(const Connectivity& surface, const DoubleCover& cover,
                                              const std::vector<Eigen::Vector3d>& positions) {
  if (positions.empty()) return {};
  const Plane plane = boundaryPlane(surface, positions);
  std::vector<Eigen::Vector3d> doubled(cover.involution.size());
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    doubled[v] = positions[v];
    if (cover.involution[v] == v) continue;
    const double height = plane.normal.dot(positions[v]) - plane.offset;
    doubled[cover.involution[v]] = positions[v] - 2 * height * plane.normal;
  }
  return doubled;
}

/// Moves the boundary's circle to the equator by a Möbius map along its axis, which is turned to
/// the north where the first copy lies: there the boundary, with that copy on its left, runs
/// counter-clockwise.
void straighten(const Connectivity& surface, Points3& points) {
  Plane plane = boundaryPlane(surface, points);
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (!surface.isBoundaryEdge(e)) continue;
    const Index h = surface.halfedge(e);
    turning += points[surface.tail(h)].cross(points[surface.head(h)]);
  }
  if (plane.normal.dot(turning) < 0) plane = {-plane.normal, -plane.offset};
  // T_c along the axis carries height d = 2 c / (1 + c^2) to 0.
  const double d = std::clamp(plane.offset, -1.0, 1.0);
  const Eigen::Vector3d center = d / (1 + std::sqrt((1 - d) * (1 + d))) * plane.normal;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(plane.normal, Eigen::Vector3d::UnitZ());
  for (Eigen::Vector3d& p : points) p = (turn * ballTranslate(center, p)).normalized();
}

struct Symmetric {
  std::vector<std::complex<double>> points;  ///< Of the first copy, in the disk.
  double asymmetry = 0;
};

/// The mean of the map and its mirror image, projected from the south pole: the northern hemisphere
/// seen from outside keeps its orientation.
Symmetric symmetrized(const Connectivity& surface, const DoubleCover& cover,
                      const Points3& points) {
  Symmetric result;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    const Eigen::Vector3d image =
        points[cover.involution[v]].cwiseProduct(Eigen::Vector3d(1, 1, -1));
    result.asymmetry = std::max(result.asymmetry, (points[v] - image).norm());
    const Eigen::Vector3d mean = (points[v] + image).normalized();
    result.points.push_back(std::complex<double>(mean.x(), mean.y()) / (1 + mean.z()));
  }
  return result;
}

}  // namespace

Result<DiskMap> mapToDiskDoubleCover(Context& context, const Connectivity& surface,
                                     const std::vector<double>& lengths,
                                     const std::vector<Eigen::Vector3d>& positions,
                                     const HeatFlowOptions& options) {
  RETURN_IF_ERROR(spherical::checkDisk(surface));
  if (!positions.empty() && positions.size() != static_cast<std::size_t>(surface.vertexCount())) {
    return Status(Reason::kInvalidOption, "there must be one position per vertex or none");
  }
  const Context::Stage stage(context, "disk map");
  ASSIGN_OR_RETURN(const DoubleCover cover, doubleCover(surface));
  std::vector<double> doubled(cover.edge.size());
  for (std::size_t e = 0; e < doubled.size(); ++e) doubled[e] = lengths[cover.edge[e]];
  HeatFlowOptions flow_options = options;
  flow_options.accept_folds = true;  // The mean with the mirror image decides.
  ASSIGN_OR_RETURN(HeatFlowMap flow,
                   mapToSphereHeatFlow(context, cover.connectivity, doubled,
                                       doubledPositions(surface, cover, positions), flow_options));
  const std::vector<double> areas = vertexAreas(surface, unitLengths(lengths));
  straighten(surface, flow.points);
  Symmetric symmetric = symmetrized(surface, cover, flow.points);
  for (const std::complex<double>& w : symmetric.points) {
    if (!(std::abs(w) < 1 + 1e-9)) {
      return Status(Reason::kFoldedMap, "the harmonic map of the double mixes its two halves",
                    "use the method robust");
    }
  }
  ASSIGN_OR_RETURN(DiskMap map,
                   spherical::centeredDiskMap(context, surface, lengths, areas, symmetric.points));
  ASSIGN_OR_RETURN(map, spherical::withTipsReset(context, surface, lengths, areas, std::move(map)));
  map.iterations = static_cast<int>(flow.energies.size()) - 1;
  map.flips = flow.flips;
  map.asymmetry = symmetric.asymmetry;
  if (!options.accept_folds) RETURN_IF_ERROR(spherical::checkUnfolded(surface, map));
  return map;
}

}  // namespace moduli
