#include "core/parameterize/sphere.h"

#include <algorithm>
#include <utility>

#include "core/intrinsic/mollify.h"
#include "core/matching/conformal_sphere.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/ideal_certificate.h"
#include "core/parameterize/refine.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/heat_flow.h"
#include "core/spherical/sphere_map.h"

namespace moduli {
namespace {

const char* const kMap = "the map to the sphere";

class SphereMapping {
 public:
  SphereMapping(Context& context, const Connectivity& surface, const std::vector<double>& lengths,
                const std::vector<Eigen::Vector3d>& positions, const SphereOptions& options)
      : context_(context),
        surface_(surface),
        lengths_(lengths),
        positions_(positions),
        options_(options) {}

  Result<Parameterization> run() {
    RETURN_IF_ERROR(map());
    return std::move(result_);
  }

 private:
  Status map() {
    switch (options_.method) {
      case MapMethod::kLinear:
        return linear();
      case MapMethod::kHeatFlow:
        return heatFlow();
      case MapMethod::kRobust:
        return robust();
      case MapMethod::kAuto:
        break;
    }
    Status status = robust();
    if (status.reason() == Reason::kNoConvergence) {
      // Clusters of needles; harmonic maps have no trouble with them.
      result_ = Parameterization();
      const Status other = linear();
      if (other.reason() != Reason::kFoldedMap) return other;
    }
    if (status.ok() || !options_.refine || positions_.empty()) return status;
    if (status.reason() != Reason::kFoldedMap && status.reason() != Reason::kNoConvergence) {
      return status;
    }
    const Status other = unfolded();
    RETURN_IF_ERROR(context_.check());
    return other.ok() ? other : status;
  }

  /// Limbs that are longer than doubles reach are distorted instead of folded, and the certificate
  /// tells how much.
  Status unfolded() {
    result_ = Parameterization();
    result_.method = MapMethod::kRobust;
    ASSIGN_OR_RETURN(const TriangleMesh mesh,
                     TriangleMesh::fromSoup({positions_, surface_.faces()}));
    ASSIGN_OR_RETURN(ConformalSphere sphere,
                     conformalSphere(context_, mesh, options_.initial_delaunay));
    result_.certificate.warnings.emplace_back(
        "UNFOLDED: as doubles have it the conformal map turns faces over; there it was laid out "
        "anew, less conformally");
    return finish(std::move(sphere.points), surface_, lengths_);
  }

  Status linear() {
    result_.method = MapMethod::kLinear;
    ASSIGN_OR_RETURN(SphereMap map, mapToSphereLinear(context_, surface_, lengths_));
    result_.certificate.centering_residual = map.centering_residual;
    return finish(std::move(map.points), surface_, lengths_);
  }

  Status heatFlow() {
    result_.method = MapMethod::kHeatFlow;
    ASSIGN_OR_RETURN(HeatFlowMap map,
                     mapToSphereHeatFlow(context_, surface_, lengths_, positions_));
    result_.certificate.centering_residual = map.centering_residual;
    result_.certificate.flips = static_cast<int>(map.flips);
    return finish(std::move(map.points), surface_, lengths_);
  }

  Status robust() {
    result_.method = MapMethod::kRobust;
    for (const bool initial_delaunay : {options_.initial_delaunay, !options_.initial_delaunay}) {
      Result<IdealPolyhedron> ideal = solve(initial_delaunay);
      if (ideal.status().reason() == Reason::kNoConvergence) {
        if (!folding_) failure_ = ideal.status();
        continue;
      }
      RETURN_IF_ERROR(ideal.status());
      const Index folded = countFolds(*ideal);
      if (folded == 0) return keep(*ideal);
      failure_ = foldedMap(kMap, folded, surface_.faceCount(),
                           "--refine auto cuts these faces; finer or less obtuse ones avoid it");
      start_ = startOf(ideal->metric);
      if (!folding_ || folded < least_folds_) {
        least_folds_ = folded;
        folding_ = *std::move(ideal);
      }
    }
    if (!folding_ || !options_.refine) return failure_;
    return refine(*folding_);
  }

  Result<IdealPolyhedron> solve(bool initial_delaunay) {
    PuncturedSphereOptions options;
    options.initial_delaunay = initial_delaunay;
    options.infinity = start_.infinity;
    options.start = start_.u;
    return mapToIdealPolyhedron(context_, surface_, lengths_, positions_, options);
  }

  std::vector<bool> folds(const IdealPolyhedron& ideal) const {
    return foldedFaces(surface_, ideal.points, [](const auto& a, const auto& b, const auto& c) {
      return spherical::orientationSign(a, b, c);
    });
  }

  Index countFolds(const IdealPolyhedron& ideal) const {
    const std::vector<bool> folded = folds(ideal);
    return static_cast<Index>(std::count(folded.begin(), folded.end(), true));
  }

  Status keep(IdealPolyhedron& ideal) {
    certifyIdeal(ideal, result_.certificate);
    return finish(std::move(ideal.points), surface_, lengths_);
  }

  Status refine(const IdealPolyhedron& ideal) {
    certifyIdeal(ideal, result_.certificate);
    ASSIGN_OR_RETURN(RefinedSurface refined,
                     refineFolds(context_, surface_, lengths_, ideal, folds(ideal)));
    result_.subdivision = std::move(refined.subdivision);
    return finish(std::move(refined.points), refined.surface, refined.lengths);
  }

  /// Moves the points as asked, and measures what comes out.
  Status finish(Points3 points, const Connectivity& surface, const std::vector<double>& lengths) {
    if (options_.mobius) {
      for (Eigen::Vector3d& point : points) point = (*options_.mobius)(point);
      result_.certificate.centering_residual.reset();
    }
    MapQuality& quality = result_.certificate.quality;
    quality = measureSphereMap(surface, lengths, points);
    if (quality.flipped_faces > 0) {
      return foldedMap(kMap, quality.flipped_faces, surface.faceCount(),
                       options_.mobius
                           ? "the Möbius map crowds parts more than doubles tell apart"
                           : "its limbs are thinner than doubles tell apart on a sphere");
    }
    result_.sphere = std::move(points);
    result_.corner = vertexCorners(surface);
    return {};
  }

  Context& context_;
  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const std::vector<Eigen::Vector3d>& positions_;
  const SphereOptions& options_;
  Status failure_;
  IdealStart start_;
  std::optional<IdealPolyhedron> folding_;  ///< The one with the fewest folds.
  Index least_folds_ = 0;
  Parameterization result_;
};

}  // namespace

Result<Parameterization> parameterizeSphere(Context& context, const Connectivity& surface,
                                            const std::vector<double>& lengths,
                                            const std::vector<Eigen::Vector3d>& positions,
                                            const SphereOptions& options) {
  RETURN_IF_ERROR(checkGenusZero(surface, kMap, 0, 0));
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  ASSIGN_OR_RETURN(Parameterization result,
                   SphereMapping(context, surface, mollified.lengths, positions, options).run());
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

}  // namespace moduli
