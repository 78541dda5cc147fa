#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/linalg/spd_solver.h"
#include "core/matching/face_distortion.h"
#include "core/matching/relaxation.h"
#include "core/mesh/connectivity.h"

namespace moduli {

/// How much a map of a surface distorts it, with the pull of attractions, and how all vertices
/// together have to move to make that less. Where Relaxation goes vertex by vertex, and so evens
/// out within a few edges, this reaches over the whole surface at once. Knows of no folds.
///
/// The energy is that of Relaxation: FaceDistortion of every face, less 4 areas, and the robust
/// pull, over the area. Refers to its parts, which must live as long.
class IsometricStep {
 public:
  using Tangents = Eigen::Matrix<double, 3, 2>;

  /// positions: per vertex, of a surface of area 1. attractions: per vertex.
  IsometricStep(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions,
                const std::vector<Attraction>& attractions);

  /// As Relaxation::setPull.
  void setPull(double pull, double scale) {
    pull_ = pull;
    scale_ = scale;
  }

  /// images: per vertex, in the unit of the attractions. 0 for isometries at their attractions.
  double excess(const std::vector<Eigen::Vector3d>& images) const;

  /// Gauss and Newton's step, tangential: per vertex orthogonal to its normal. Every face counts as
  /// a |J - J^-T|^2, which is its energy less 4 a, and whose square of a derivative is positive
  /// semidefinite. normals: per vertex of the surface that is mapped to, where the image is. Fails
  /// as SpdSolver does. One factorization of 2 V unknowns; the pattern is analysed once.
  Result<std::vector<Eigen::Vector3d>> operator()(Context& context,
                                                  const std::vector<Eigen::Vector3d>& images,
                                                  const std::vector<Eigen::Vector3d>& normals);

 private:
  /// What a face adds to a step's system: the lower triangle, row by row, and the right side.
  struct FaceTerms {
    std::array<double, 21> hessian;
    std::array<double, 6> right;
  };
  struct System;
  void makePattern();
  FaceTerms termsOf(Index f, const std::vector<Eigen::Vector3d>& images,
                    const std::vector<Tangents>& tangents) const;
  System systemAt(const std::vector<Eigen::Vector3d>& images,
                  const std::vector<Tangents>& tangents) const;

  const Connectivity& surface_;
  const std::vector<Attraction>& attractions_;
  std::vector<FaceDistortion> distortions_;
  std::vector<Eigen::Matrix<double, 2, 3>> gradients_;  ///< Per face, of its corners' hats.
  std::vector<double> masses_;                          ///< Per vertex: a third of its faces.
  double pull_ = 0, scale_ = 1;
  SparseMatrix pattern_;                     ///< Of every step's matrix.
  std::vector<std::array<int, 21>> places_;  ///< Per face, where its terms are added.
  std::optional<SpdSolver> solver_;
};

}  // namespace moduli
