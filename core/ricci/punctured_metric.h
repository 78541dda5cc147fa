#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/intrinsic/intrinsic_triangulation.h"
#include "core/ricci/edge_pattern.h"
#include "core/ricci/scaled_face.h"
#include "core/ricci/vertex_scaling.h"

namespace moduli {

/// The flat metrics of a sphere whose vertex `infinity` is at infinity: one u per other vertex.
///
/// The link (neighbours of infinity) keeps u_i = -2 log x_{i, infinity}, the bound under which a
/// horosphere touches that of infinity: all its spokes have half chord 1. The finite faces form a
/// disk whose triangulation is Delaunay. See punctured_sphere.h for what it is for.
class PuncturedMetric {
 public:
  /// triangulation: of a sphere, without a loop at `infinity`. unknowns: vertices of one orbit are
  /// exchanged by a symmetry of the surface and keep one u; `infinity` is alone in its own.
  PuncturedMetric(IntrinsicTriangulation triangulation, Index infinity, Unknowns unknowns);

  /// Moves to u (per vertex) from the connectivity last accepted, with flips. A vertex below its
  /// bound joins the link, by a flip of the link's edge in front of it, and gets the bound.
  /// Fails with kNoConvergence for a u that is no number or where flips do not end.
  Status moveTo(Context& context, const Eigen::VectorXd& u);
  void accept();

  /// As CurvatureModel::setBase; per vertex. u() and moveTo() count from it.
  void setBase(const Eigen::VectorXd& base) { base_ = base; }

  /// Takes a vertex off the link whose inner angle is above pi, by a flip of its spoke, and raises
  /// its u so far that the new triangle takes the excess. Moves nothing: call moveTo(u()) next.
  /// Returns whether the link was long enough for it.
  bool release(Index vertex);

  const Eigen::VectorXd& u() const { return u_; }
  bool isFree(Index v) const { return v != infinity_ && !linked_[v]; }
  bool isLinked(Index v) const { return linked_[v]; }
  Index infinity() const { return infinity_; }
  /// The sum of angles of finite faces at each vertex.
  const std::vector<double>& angleSums() const { return angle_sums_; }
  /// Per unknown: the sum of 2 pi - angleSums() over its vertices; 0 where not all are free.
  Eigen::VectorXd gradient() const;
  /// The largest |2 pi - angleSums()| of the free vertices.
  double residual() const;
  /// The derivative of gradient() by u; the unknowns that are not free have rows of the identity.
  /// Lower triangle.
  const SparseMatrix& hessian();
  const Unknowns& unknowns() const { return unknowns_; }
  int patternVersion() const { return pattern_version_; }

  const IntrinsicTriangulation& triangulation() const { return triangulation_; }
  /// Per halfedge, at u; 1 on spokes.
  const std::vector<double>& scaledHalfChords() const { return scaled_; }
  /// Per halfedge; 0 in faces at infinity.
  const std::vector<double>& angles() const { return angles_; }
  bool finiteFace(Index h) const;

 private:
  Status flipAll(Context& context);
  void expose(Index h);
  void joinLink(Index v, Index spoke);
  void findLink();
  bool needsWork(Index h) const;
  bool broken(Index h) const;
  double half(Index h) const;
  void setU(Index v, double value);
  void measure();
  ScaledFace needle(Index h) const;
  std::vector<Index> freeUnknowns() const;

  IntrinsicTriangulation triangulation_;
  Index infinity_;
  Unknowns unknowns_;
  std::size_t accepted_flips_ = 0;
  Eigen::VectorXd base_, u_;
  std::vector<double> scale_;
  std::vector<bool> linked_;
  std::vector<Index> work_;
  std::vector<double> scaled_, half_tangents_, angles_, angle_sums_;
  EdgePattern pattern_;
  int pattern_version_ = 0;
  bool pattern_stale_ = true;
};

}  // namespace moduli
