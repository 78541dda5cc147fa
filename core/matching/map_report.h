#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/surface_point.h"

namespace moduli {

/// How good a map from a surface to another is, from where its vertices go. K is the dilatation of
/// a face: the ratio of the singular values of the linear map from it to the triangle of its
/// corners' images in space. Means and shares are weighted by the area of the source.
struct MapReport {
  Index folded_faces = 0;  ///< On the sphere, decided exactly.
  double mean_dilatation = 1;
  double dilatation_95 = 1;  ///< Least K that is not exceeded on 95 % of the area.
  double max_dilatation = 1;
  double area_distortion = 0;  ///< Standard deviation of log(area of the image / area of the face).
};

/// The point of a surface in space. positions: per vertex.
Eigen::Vector3d spacePoint(const Connectivity& surface,
                           const std::vector<Eigen::Vector3d>& positions,
                           const SurfacePoint& point);

/// Measures the faces of `surface` as they are and as `images` has them, both in space; folded
/// faces are not counted here. Faces without area are left out, images without area have the
/// dilatation infinity. positions, images: per vertex. O(F log F). Source: MATH 9.1.
MapReport measureSpaceMap(const Connectivity& surface,
                          const std::vector<Eigen::Vector3d>& positions,
                          const std::vector<Eigen::Vector3d>& images);

/// How far a map is from one that keeps all lengths but for one scale: the root mean square, by
/// area, of the logarithms of both singular values of its faces, less their mean; each logarithm
/// cut off at that of a thousand. 0 for similarities. As measureSpaceMap otherwise. O(F).
double isometricDistortion(const Connectivity& surface,
                           const std::vector<Eigen::Vector3d>& positions,
                           const std::vector<Eigen::Vector3d>& images);

/// How much a map changes a surface's shape, in geometric means: a map of half the change
/// everywhere has half of it, whatever joints and crumples have of their own.
struct ShapeChange {
  /// Mean over the area: of the root mean square of the logarithms of both singular values, less
  /// the middle one of all faces; each cut off as isometricDistortion does. A face has 1e-3 at
  /// least: so have similarities. No unit.
  double stretching = 0;
  /// Mean over the area: of the root mean square of the eigenvalues of the change of the second
  /// fundamental form, as the normals at the corners of a face tell it, times the root of the
  /// area, of either surface. A face has 1e-2 at least. No unit.
  double bending = 0;

  /// Both have floors of their own, which the meshes' roughness sets: their product compares
  /// ratios, and weighs neither.
  double product() const { return stretching * bending; }
};

/// positions, images: per vertex, as measureSpaceMap has them; normals, image_normals: of length 1,
/// of the surfaces there. Faces without area are left out. O(F log F).
ShapeChange shapeChange(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions,
                        const std::vector<Eigen::Vector3d>& normals,
                        const std::vector<Eigen::Vector3d>& images,
                        const std::vector<Eigen::Vector3d>& image_normals);

/// Mean distance in space from A's vertices to where they come back to, from A to B and back,
/// weighted by the areas around them. to: per vertex of A, in B; back: per vertex of B, in A.
double cycleError(const Connectivity& a, const std::vector<Eigen::Vector3d>& positions,
                  const std::vector<SurfacePoint>& to, const Connectivity& b,
                  const std::vector<SurfacePoint>& back);

}  // namespace moduli
