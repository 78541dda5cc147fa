#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/matching/cover_map.h"
#include "core/topology/homology.h"

/// Affine maps between flat tori: of all maps in their homotopy classes those of least dilatation,
/// which is the same everywhere.
///
///   ASSIGN_OR_RETURN(const CoverSurface a, straightCover(context, surface_a, lengths_a));
///   ASSIGN_OR_RETURN(const CoverSurface b, straightCover(context, surface_b, lengths_b));
///   ASSIGN_OR_RETURN(const TorusMap map, affineTorusMap(context, a, b, targets));
namespace moduli {

/// A flat torus of area 1 with a short basis of its lattice. Vectors are those of its faces'
/// coordinates, all turned alike.
struct TorusShape {
  std::vector<Eigen::Vector2d> steps;  ///< Per halfedge: from its tail to its head.
  std::array<Walk, 2> loops;           ///< A basis of the homology.
  Eigen::Matrix2d loop_periods;        ///< Column k: the sum of the steps along loop k.
  Eigen::Matrix2d periods;             ///< Columns: a Gauss-reduced basis, of determinant 1.
};

/// cover: of a torus. Fails as computeTreeCotree does. O(F).
Result<TorusShape> torusShape(const CoverSurface& cover);

/// The period ratio of a lattice: second column over first one, in the upper half plane where the
/// determinant is positive.
std::complex<double> periodRatio(const Eigen::Matrix2d& periods);

struct TorusMap {
  /// Column k: the coefficients, in B's short basis, of what A's short basis vector k goes to. Of
  /// determinant 1.
  Eigen::Matrix2i marking = Eigen::Matrix2i::Identity();
  Eigen::Matrix2d linear;         ///< On vectors of A's faces, B's: of determinant 1.
  std::complex<double> beltrami;  ///< The same on every face; |mu| < 1.
  double dilatation = 1;          ///< K = (1 + |mu|) / (1 - |mu|) on every face.
  double distance = 0;            ///< log(K) / 2; the tori's Teichmüller distance without targets.
  /// Without targets: of the logarithms of the conformal factors, 1 for a conformal copy.
  double correlation = 0;
  Index replaced = 0;  ///< With targets: how many contradicted their neighbours'.
  double offset = 0;   ///< With targets: the median of their distances from the images, in B.
  CoverMap map;        ///< No face folded.
};

struct TorusMapOptions {
  /// Without targets: markings whose distance is at most so much above the least are tried for the
  /// best correlation.
  double slack = 0.02;
};

/// The affine map from a to b, covers of tori. targets: per vertex of a, or empty. With targets the
/// marking is theirs, by linkTargets, and the shift the geometric median of what is left. Without,
/// the marking is one of least Teichmüller distance and the shift that of best correlation of the
/// conformal factors' low frequencies.
///
/// For a mirror image (marking of determinant -1) give a cover of A with its faces reversed. Fails
/// with kUnsupportedTopology (no tori), kFoldedMap (faces so thin that rounding turns them over),
/// and as linkTargets does. O(V) and the walks through b's faces. Stages: "homotopy", "affine".
/// Source: MATH 9.3; Teichmüller 1939.
Result<TorusMap> affineTorusMap(Context& context, const CoverSurface& a, const CoverSurface& b,
                                const std::vector<SurfacePoint>& targets,
                                const TorusMapOptions& options = {});

}  // namespace moduli
