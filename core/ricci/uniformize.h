#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/double_cover.h"
#include "core/ricci/discrete_metric.h"
#include "core/ricci/scheme.h"

namespace moduli {

struct UniformizeOptions {
  bool initial_delaunay = true;  ///< As in PrescribeOptions.
  RicciSolver solver = RicciSolver::kNewton;
};

/// The metric of constant curvature in the discrete conformal class of a surface.
struct Uniformization {
  DiscreteMetric metric;             ///< Of the surface; with a boundary, of its double.
  std::optional<DoubleCover> cover;  ///< With a boundary.
};

/// Uniformizes a connected surface by its topology: H2 where the Euler characteristic is negative,
/// E2 where it is 0. A boundary becomes geodesic. lengths: per edge, proper Euclidean triangles.
/// Fails with kUnsupportedTopology for spheres and disks (spheres: punctured_sphere.h), and as
/// PrescribedCurvature does. Source: MATH 5.6, 6.
Result<Uniformization> uniformize(Context& context, const Connectivity& surface,
                                  const std::vector<double>& lengths,
                                  const UniformizeOptions& options = {});

}  // namespace moduli
