#include "core/spherical/sphere_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/spherical/linear_map.h"
#include "core/spherical/plane_lift.h"
#include "core/spherical/sphere_start.h"

namespace moduli {
namespace {

using spherical::ChartRelaxation;
using spherical::DipoleMap;
using spherical::PlanePoints;

/// Each chart reaches past the equator, to where the sphere's other chart has radius 1 / kReach. An
/// error z^k of the held vertices, k >= 2 (the lower ones are Möbius maps or were taken out), comes
/// back from one relaxation as kReach^(-2 k) of itself: at most 0.2.
constexpr double kReach = 1.5;
/// 0.2^6 = 6e-5: what the pole spoiled to first order in the edge length no longer shows.
constexpr int kRelaxations = 6;

struct PoledMap {
  Points3 points;        ///< Centred.
  Eigen::Vector3d pole;  ///< Where the plane's infinity went.
};

/// The dipole map with its pole in a face, on the sphere and centred.
Result<PoledMap> mapWithPole(Context& context, const DipoleMap& dipole, std::vector<double> areas,
                             Index face) {
  ASSIGN_OR_RETURN(const PlanePoints z, dipole.solve(context, face));
  Points3 points = balancedLift(z, areas);
  points.push_back(Eigen::Vector3d::UnitZ());  // Infinity comes along, without weight.
  areas.push_back(0);
  ASSIGN_OR_RETURN(MobiusCentering centered, centerByMobius(context, std::move(points), areas));
  PoledMap map;
  map.pole = centered.points.back();
  centered.points.pop_back();
  map.points = std::move(centered.points);
  return map;
}

/// Fewer folds first, then less dilatation. A map with a number that is no number never wins.
bool isBetter(const MapQuality& a, const MapQuality& b) {
  if (!(a.covering_degree > 0.5 && a.covering_degree < 1.5)) return false;
  if (a.flipped_faces != b.flipped_faces) return a.flipped_faces < b.flipped_faces;
  return a.mean_dilatation < b.mean_dilatation;
}

class LinearMap {
 public:
  LinearMap(const Connectivity& surface, const std::vector<double>& lengths)
      : surface_(surface), lengths_(lengths), areas_(vertexAreas(surface, lengths)) {}

  Result<SphereMap> compute(Context& context) {
    ASSIGN_OR_RETURN(const PoledMap start, startFromDipole(context));
    RETURN_IF_ERROR(consider(context, start.points));
    RETURN_IF_ERROR(relaxCharts(context, start));
    return std::move(*best_);
  }

 private:
  /// Twice with one factorization: the first map shows where the pole belongs.
  Result<PoledMap> startFromDipole(Context& context) {
    ASSIGN_OR_RETURN(const DipoleMap dipole, DipoleMap::make(context, surface_, lengths_));
    weights_ = dipole.weights();
    ASSIGN_OR_RETURN(const PoledMap first,
                     mapWithPole(context, dipole, areas_, spherical::largestFace(dipole.frames())));
    return mapWithPole(context, dipole, areas_,
                       spherical::centralFace(surface_, dipole.frames(), first.points));
  }

  /// Alternates between the charts around the pole and around its opposite. On meshes too coarse to
  /// hold a vertex still in each chart, or that lose their shape, the best map so far stands.
  Status relaxCharts(Context& context, const PoledMap& start) {
    std::array<std::optional<ChartRelaxation>, 2> charts;
    for (int side = 0; side < 2; ++side) {
      const Eigen::Vector3d pole = side == 0 ? start.pole : Eigen::Vector3d(-start.pole);
      ASSIGN_OR_RETURN(ChartRelaxation chart, ChartRelaxation::make(context, surface_, weights_,
                                                                    start.points, pole, kReach));
      if (!chart.isSound()) return {};
      charts[side].emplace(std::move(chart));
    }
    Points3 points = start.points;
    for (int step = 0; step < kRelaxations; ++step) {
      ASSIGN_OR_RETURN(points, charts[step % 2]->relax(context, std::move(points)));
      RETURN_IF_ERROR(consider(context, points));
    }
    return {};
  }

  /// Centres a candidate and keeps it if it is the best so far.
  Status consider(Context& context, const Points3& points) {
    Result<MobiusCentering> centered = centerByMobius(context, points, areas_);
    RETURN_IF_ERROR(context.check());
    if (!centered.ok()) return best_ ? Status() : centered.status();
    const MapQuality quality = measureSphereMap(surface_, lengths_, centered->points);
    if (best_ && !isBetter(quality, best_->quality)) return {};
    best_ =
        SphereMap{std::move(centered->points), quality, centered->residual, centered->iterations};
    return {};
  }

  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  std::vector<double> areas_;
  std::vector<double> weights_;
  std::optional<SphereMap> best_;
};

}  // namespace

Result<SphereMap> mapToSphereFolding(Context& context, const Connectivity& surface,
                                     const std::vector<double>& lengths) {
  RETURN_IF_ERROR(spherical::checkSphere(surface));
  const Context::Stage stage(context, "sphere map");
  return LinearMap(surface, lengths).compute(context);
}

Result<SphereMap> mapToSphereLinear(Context& context, const Connectivity& surface,
                                    const std::vector<double>& lengths) {
  ASSIGN_OR_RETURN(SphereMap map, mapToSphereFolding(context, surface, lengths));
  if (map.quality.flipped_faces > 0) {
    return Status(
        Reason::kFoldedMap,
        "the linear map to the sphere folds " + std::to_string(map.quality.flipped_faces) + " of " +
            std::to_string(surface.faceCount()) + " faces",
        "remesh it with fewer obtuse triangles; limbs more than some twenty times as long as "
        "thick exceed what doubles can tell apart on a sphere");
  }
  return map;
}

}  // namespace moduli
