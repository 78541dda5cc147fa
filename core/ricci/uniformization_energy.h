#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/mesh/double_cover.h"
#include "core/ricci/circle_packing.h"
#include "core/ricci/prescribe.h"
#include "core/ricci/ricci_objective.h"
#include "core/ricci/scheme.h"

namespace moduli {

struct UniformizationEnergyOptions {
  Scheme scheme = Scheme::kVertexScaling;
  bool initial_delaunay = true;  ///< As in PrescribeOptions; of kVertexScaling.
};

/// The Ricci energy whose minimizer is the metric of constant curvature of a surface, for
/// minimizers: uniformize() as a function and a start.
///
///   ASSIGN_OR_RETURN(const auto energy, UniformizationEnergy::make(context, surface, lengths));
///   ASSIGN_OR_RETURN(const Minimum minimum,
///                    minimize(context, energy->objective(), energy->start(), options));
///
/// One unknown per vertex: the logarithm u of its scale, the half chords being l / (2 mean l) at
/// u = 0, or of its circle (circle_packing.h). H2 where the Euler characteristic is negative, E2
/// where it is 0; there only differences of u mean anything. A boundary becomes geodesic: by the
/// double where edges are flipped, by curvature 0 on the triangles themselves where circles are
/// packed. Not every surface has a packing on its triangles; then the energy has no minimizer.
/// One thread at a time. Source: MATH 5.6, 6, 11.9.
class UniformizationEnergy {
 public:
  /// surface: connected. lengths: per edge, proper Euclidean triangles. Fails with
  /// kUnsupportedTopology for spheres and disks, as PrescribedCurvature and CirclePackingModel do.
  /// O(F) and the flips.
  static Result<std::unique_ptr<UniformizationEnergy>> make(
      Context& context, const Connectivity& surface, const std::vector<double>& lengths,
      const UniformizationEnergyOptions& options = {});

  UniformizationEnergy(const UniformizationEnergy&) = delete;
  UniformizationEnergy& operator=(const UniformizationEnergy&) = delete;

  RicciObjective& objective() { return *objective_; }
  /// Per vertex. Scaled to about the area of the minimizer in H2.
  const Eigen::VectorXd& start() const { return start_; }

  /// Of circle packings at u, where the objective is: "CLAMPED: ..." (the given metric is not the
  /// one that is packed), "BROKEN_FACES: ..." (no proper triangles), "SHRINKING_CIRCLES: ..." (a
  /// thousand times as small as one beside: where there is no packing, circles shrink for ever and
  /// gradients vanish at infinity). O(F).
  std::vector<std::string> remarks(const Eigen::VectorXd& u) const;

 private:
  explicit UniformizationEnergy(const Connectivity& surface) : surface_(surface) {}
  Geometry geometry() const;
  Status scaleVertices(Context& context, const std::vector<double>& lengths, bool initial_delaunay);
  Status packCircles(const std::vector<double>& lengths, Scheme scheme);

  const Connectivity surface_;
  std::optional<DoubleCover> cover_;
  std::optional<PrescribedCurvature> scaling_;
  std::optional<CirclePackingModel> circles_;
  std::optional<RicciObjective> objective_;
  Eigen::VectorXd start_;
};

}  // namespace moduli
