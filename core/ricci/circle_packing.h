#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/geometry.h"
#include "core/linalg/spd_solver.h"
#include "core/mesh/connectivity.h"
#include "core/ricci/curvature_model.h"
#include "core/ricci/scheme.h"

namespace moduli {

/// Circle packing metrics on fixed triangles: a circle of radius r_i around every vertex, and for
/// every edge a number I_ij that stays (the cosine of the angle at which two circles meet, or their
/// inversive distance), from which come the lengths
///
///   l^2    = r_i^2 + r_j^2 + 2 I r_i r_j             u = log r             Euclidean
///   cosh l = cosh r_i cosh r_j + I sinh r_i sinh r_j u = log tanh(r / 2)   hyperbolic, u < 0
///   cos l  = cos r_i cos r_j - I sin r_i sin r_j     u = log tan(r / 2)    spherical
///
///   ASSIGN_OR_RETURN(auto model, CirclePackingModel::make(surface, Geometry::kHyperbolic,
///                                                         Scheme::kTangential, lengths));
///   RETURN_IF_ERROR(model.moveTo(context, model.initial()));
///   model.curvature();
///
/// The curvature is the gradient of an energy that is convex for I >= 0 in the Euclidean plane
/// (strictly but for constants) and in the hyperbolic one (strictly). Circles that meet at up to a
/// right angle (0 <= I <= 1) make proper triangles whatever their radii; separated ones may not:
/// then the angles are pi and 0, 0, and the energy stays convex. Spherical metrics have curvatures
/// and derivatives here, but no convex energy.
///
/// On fixed triangles not every target is reached. With 0 <= I = cos Phi <= 1 there is a solution,
/// and one only (Euclidean: up to a factor), if and only if Gauss and Bonnet allow the target and,
/// for every set A of vertices but the empty one and that of all,
///   sum of K over A > 2 pi chi(F_A) - sum over Lk(A) of (pi - Phi(e)),
/// F_A being the cells all of whose vertices are in A, and Lk(A) the pairs of a vertex in A and the
/// edge opposite to it in a face without other vertices in A. For one vertex of degree d and
/// circles that touch, it reads K > 2 pi - d pi: an angle stays below pi.
///
/// Copyable. One thread at a time; works on all processors where it pays, with the same bytes on
/// any number of them. About 60 bytes per face beside the connectivity and the matrix.
/// Source: MATH 6.1 to 6.3, 6.5, 6.8; Thurston, "The geometry and topology of 3-manifolds",
/// chapter 13; Chow and Luo 2003; Guo 2011 and Luo 2011 (inversive distance).
class CirclePackingModel final : public CurvatureModel {
 public:
  /// surface: closed or with boundary; loops and double edges are allowed. lengths: per edge, in
  /// the geometry's unit of curvature, every face a proper triangle; who has a Euclidean mesh and
  /// wants a hyperbolic metric first makes hyperbolic lengths of its own, for instance by
  /// sinh(l / 2) = c l_Euclidean, which keeps triangles proper for every c.
  /// scheme: kTangential (I = 1), kInversiveDistance (the I of the given lengths) or kThurston (the
  /// same, clamped to [0, 1], which changes the metric; see clampedFraction).
  ///
  /// Initial radii come from r_i^{jk} = (l_ij + l_ik - l_jk) / 2 in the faces at i. For
  /// kInversiveDistance their minimum: then all circles are separate or touch, I >= 1. This would
  /// leave nothing of a metric after clamping; kThurston takes their maximum (I <= 1) or their
  /// mean, whichever changes the lengths less, in the sum of |log|: on well-shaped triangles the
  /// maximum changes some hundredth of the edges. kTangential starts from the mean.
  ///
  /// Fails with kInvalidOption (another scheme, number of lengths, a length that is not finite, a
  /// face that is no proper triangle). O(F).
  static Result<CirclePackingModel> make(Connectivity surface, Geometry geometry, Scheme scheme,
                                         const std::vector<double>& lengths);

  Geometry geometry() const override { return geometry_; }
  Eigen::Index size() const override { return surface_.vertexCount(); }

  /// u: size() entries. Fails with kNoConvergence where a step was too long: hyperbolic u not
  /// below 0, circles too large for the sphere, lengths that are no doubles (hyperbolic: of 700 and
  /// more); who came from a good place halves the step. Fails with kInvalidOption for another size
  /// of u, and kCancelled, kDeadlineExceeded. O(F).
  Status moveTo(Context& context, const Eigen::VectorXd& u) override;

  /// No entries before the first moveTo.
  const Eigen::VectorXd& curvature() const override { return curvature_; }

  /// O(F). The pattern never changes; spherical matrices are not semi-definite.
  const SparseMatrix& hessian() override;
  int patternVersion() const override { return 0; }

  bool hasThirdDerivatives() const override { return true; }
  /// O(F). Source: face_thirds.h.
  Eigen::VectorXd thirdContraction(const SparseMatrix& weights) const override;

  /// The u of the initial radii.
  const Eigen::VectorXd& initial() const { return initial_; }

  /// kThurston: the part of the edges whose I was outside [0, 1].
  std::optional<double> clampedFraction() const { return clamped_fraction_; }

  const Connectivity& surface() const { return surface_; }
  /// I per edge.
  const std::vector<double>& inversiveDistances() const { return distance_; }

  /// Per edge the length at u; before the first moveTo, as given.
  const std::vector<double>& lengths() const { return lengths_; }
  /// Per halfedge the angle at its tail at u.
  const std::vector<double>& angles() const { return angles_; }
  /// The number of faces that are no proper triangles at u.
  Index brokenFaces() const;

 private:
  CirclePackingModel(Connectivity surface, Geometry geometry)
      : surface_(std::move(surface)), geometry_(geometry) {}
  Status checkLengths() const;
  void findRadii(Scheme scheme);
  void findDistances(Scheme scheme);
  void makePattern();
  void measureCircles(const Eigen::VectorXd& u);
  void measureEdges();
  Status checkEdges() const;
  void measureFaces();
  TriangleValues sides(Index f) const;
  void differentiateFace(Index f);
  TriangleValues contractFace(Index f, const SparseMatrix& weights) const;

  Connectivity surface_;
  Geometry geometry_;
  Eigen::VectorXd initial_;
  std::vector<double> distance_;  ///< I per edge.
  std::vector<double> root_;      ///< Per edge the square root of (I + 1) / 2.
  std::optional<double> clamped_fraction_;
  std::vector<Index> slot_;  ///< Per edge the place of its entry among the values of hessian_.

  // At u: per vertex the radius, F and C of it (MATH 6.1), per edge, per halfedge.
  std::vector<double> radius_, sine_, cosine_;
  std::vector<double> lengths_;
  std::vector<double> angles_;
  Eigen::VectorXd curvature_;
  std::vector<double> own_, cross_;  ///< Entries of the faces' matrices: at the tail; along h.
  SparseMatrix hessian_;
};

}  // namespace moduli
