#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/flat_charts.h"
#include "core/intrinsic/subdivide.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/discrete_metric.h"

namespace moduli {

/// The faces of a surface as straight triangles of a flat metric of it. Internal to this room.
struct FlatFaces {
  Connectivity surface;  ///< Of the faces.
  FlatCharts charts;
  Index folded = 0;                             ///< Faces that the metric turns over.
  std::optional<Subdivision> subdivision = {};  ///< Where faces were cut.
};

/// The faces as they are. metric: of the surface, or of its double. O(F + flips).
FlatFaces flatFaces(const Connectivity& surface, const DiscreteMetric& metric);

/// The same with those faces cut along the edges of the metric's triangulation that turn over, and
/// no more of the others than it takes (subdivide.h); new vertices lie on edges, where they cross
/// the triangulation's. Fails with kCancelled and kDeadlineExceeded, and with kFoldedMap where a
/// face has a vertex twice. O(F + crossings).
Result<FlatFaces> refineFlatFaces(Context& context, const Connectivity& surface,
                                  const DiscreteMetric& metric);

}  // namespace moduli
