#pragma once

#include <vector>

#include "core/intrinsic/geometry.h"
#include "core/intrinsic/intrinsic_triangulation.h"

namespace moduli {

/// What judges a discrete metric; computed from its final lengths.
struct MetricCertificate {
  double curvature_residual = 0;     ///< max |K - target|, radians; in E2 less its mean.
  double gauss_bonnet_residual = 0;  ///< |sum K + curvature * area - 2 pi chi|, radians.
  double smallest_angle = 0;         ///< Radians.
  int newton_iterations = 0;
  int flips = 0;                  ///< Between the given triangulation and the final one.
  std::vector<double> residuals;  ///< Before each step and at the end.
};

/// A metric of constant curvature with cones, as triangles of its geometry.
struct DiscreteMetric {
  Geometry geometry = Geometry::kEuclidean;
  /// The final connectivity; its history leads back to the given one. Its half chords are those
  /// before scaling.
  IntrinsicTriangulation triangulation;
  std::vector<double> u;  ///< Per vertex: half chords are multiplied by e^{(u_i + u_j) / 2}.
  std::vector<double> half_chords;  ///< Per halfedge, scaled.
  std::vector<double> angles;       ///< Per halfedge, at its tail.
  MetricCertificate certificate;
};

}  // namespace moduli
