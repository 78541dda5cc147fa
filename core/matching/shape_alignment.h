#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// Two surfaces that lie on each other in space, once the relief of one is smoothed away and a
/// similarity has brought them together.
struct ShapeAlignment {
  double smoothing = 0;    ///< Over what length, as a share of the root of the area.
  bool of_second = false;  ///< Whether the second is the one that is smoothed.
  double gap = 0;          ///< Samples of a to b: 95 % are nearer, over the root of b's area.
  std::vector<SurfacePoint> points;  ///< Per vertex of a the nearest point of b that looks its way.
  std::vector<double> gaps;          ///< Per vertex its distance from there, as gap.
};

/// Smooths one of two surfaces more and more, by the heat flow of its places in its own metric, and
/// brings it and the other together by a similarity that keeps orientation, point by nearest point
/// (Besl and McKay 1992; Chen and Medioni 1992) whose normals look the same way. Returns the
/// alignment of least gap; nothing where that is above `most`.
///
/// Why: inflated and folded copies of a surface, as those of a cortex, are no near isometries, but
/// lie in one place. What a metric tells of them has errors of a tenth of their size; smoothed
/// shapes tell places to a fiftieth. (Eisenberger, Lähner, Cremers 2020 compare smoothed shapes,
/// too.)
///
/// a, b: closed, one orientation. samples: of vertices of a, evenly spread, at least 4; targets:
/// where each is on b in space, roughly. Fails as mollify and SpdSolver do. One factorization for
/// each length tried (at most 12), O(samples V) for each step of an alignment, and O(V^2) for the
/// points. Stages: "shape", SpdSolver's.
Result<std::optional<ShapeAlignment>> alignShapes(Context& context, const TriangleMesh& a,
                                                  const TriangleMesh& b,
                                                  const std::vector<Index>& samples,
                                                  const std::vector<Eigen::Vector3d>& targets,
                                                  double most);

}  // namespace moduli
