#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/intrinsic/intrinsic_triangulation.h"
#include "core/ricci/curvature_model.h"
#include "core/ricci/edge_pattern.h"
#include "core/ricci/scaled_face.h"

namespace moduli {

/// Which unknown scales a vertex. Vertices that share one form an orbit.
struct Unknowns {
  std::vector<Index> of_vertex;
  Index count = 0;

  /// One unknown per vertex.
  static Unknowns all(Index vertices);
};

/// Vertex scaling: half chords times e^{(u_i + u_j) / 2}.
///
/// With flips the metric at u is that of the Delaunay triangulation, reached by Ptolemy flips: it
/// is proper for every u, its curvature is a continuously differentiable function of u, and every
/// admissible curvature has a solution. Without, the triangles stay and broken ones have the angles
/// (pi, 0, 0), the convex extension of the energy. Each of the two faces of an edge is asked for
/// its half chord; boundary edges are never flipped (use a double to have them solved for all
/// cases). Source: MATH 6.4, 6.7; Luo 2004; Bobenko, Pinkall and Springborn 2015; Gu, Luo, Sun, Wu
/// 2018; Springborn 2019.
class VertexScalingModel : public CurvatureModel {
 public:
  enum class Flips : bool { kOff, kOn };

  VertexScalingModel(Geometry geometry, IntrinsicTriangulation triangulation, Unknowns unknowns,
                     Flips flips);

  Geometry geometry() const override { return geometry_; }
  Eigen::Index size() const override { return unknowns_.count; }
  /// O(F) and the flips; fails also with kNoConvergence where |u| is beyond 600 or a triangle has
  /// no angles: hyperbolic sides of hundreds, spherical ones that do not fit on the sphere.
  Status moveTo(Context& context, const Eigen::VectorXd& u) override;
  /// With flips only. Source: vertex_relaxation.h.
  Result<bool> relax(Context& context, const Eigen::VectorXd& target,
                     const std::vector<bool>& fixed, double residual, Eigen::VectorXd& u) override;
  bool setBase(const Eigen::VectorXd& base) override;
  void accept() override { accepted_flips_ = triangulation_.history().size(); }
  const Eigen::VectorXd& curvature() const override { return curvature_; }
  const SparseMatrix& hessian() override;
  int patternVersion() const override { return pattern_version_; }
  /// Of the Euclidean and the hyperbolic plane. Where flips change the triangulation, the quantity
  /// that a flipped edge carries is 0, and the energy is convex and twice continuously
  /// differentiable across. O(F). Source: MATH 6.5, 6.7; Springborn 2019.
  bool hasEnergy() const override { return geometry_ != Geometry::kSpherical; }
  double energy() const override;
  bool hasThirdDerivatives() const override { return true; }
  /// Third derivatives jump where flips change the triangulation: between, the energy is analytic.
  /// O(F). Source: face_thirds.h.
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

  /// The triangulation at u, with unscaled half chords.
  const IntrinsicTriangulation& triangulation() const { return triangulation_; }
  /// Per halfedge, at u.
  const std::vector<double>& scaledHalfChords() const { return scaled_; }
  /// Per halfedge the angle at its tail, at u.
  const std::vector<double>& angles() const { return angles_; }
  /// Per vertex, at u.
  std::vector<double> vertexCurvatures() const;
  /// Area at u.
  double area() const;
  bool proper() const { return proper_; }

 private:
  void measure();
  TriangleValues contractFace(Index h, const SparseMatrix& weights) const;
  ScaledFace needle(Index h) const;

  Geometry geometry_;
  IntrinsicTriangulation triangulation_;
  Unknowns unknowns_;
  Flips flips_;
  std::vector<bool> on_boundary_;
  std::size_t accepted_flips_ = 0;
  Eigen::VectorXd base_;                                 ///< Per unknown: u counts from here.
  std::vector<double> change_;                           ///< u per vertex.
  std::vector<double> scale_;                            ///< e^{u/2} per vertex.
  std::vector<double> scaled_, half_tangents_, angles_;  ///< Per halfedge; of the corner at tail.
  bool proper_ = true;
  Eigen::VectorXd curvature_;
  EdgePattern pattern_;
  int pattern_version_ = 0;
  bool pattern_stale_ = true;
};

}  // namespace moduli
