#pragma once

#include <array>
#include <complex>
#include <vector>

#include "core/mesh/connectivity.h"
#include "core/spherical/mobius.h"

/// How good a map of a surface to the sphere or to the plane is, computed from its final points.
namespace moduli {

/// Where the bins of MapQuality::dilatation_histogram end: bin i holds the K below bound i and not
/// below the bound before it, the last bin all K from 5 on.
inline constexpr std::array<double, 6> kDilatationBounds = {1.05, 1.1, 1.25, 1.5, 2, 5};

/// K is the quasi-conformal dilatation of a face: the ratio of the singular values of the linear
/// map from the face to its image (on the sphere: to the triangle of chords), whichever way it is
/// turned; infinite where the image has no area. Means and shares are weighted by the area of the
/// source.
struct MapQuality {
  Index flipped_faces = 0;     ///< Turned over or without area, decided exactly.
  double covering_degree = 0;  ///< Sum of signed solid angles / 4 pi; 0 for maps to the plane.
  double max_dilatation = 1;
  double mean_dilatation = 1;
  double dilatation_95 = 1;                  ///< Least K that is not exceeded on 95 % of the area.
  std::vector<double> dilatation_histogram;  ///< Share of the area in each bin; 7 bins, sum 1.
  /// Standard deviation of log(area of the image / area of the face), which no scale changes;
  /// infinite where an image has no area. On the sphere the image is the triangle of chords.
  double area_distortion = 0;
};

/// Measures a map to the unit sphere. lengths: per edge, proper triangles. points: per vertex.
/// A face is flipped unless its solid angle is positive, that is unless its corners run
/// counter-clockwise seen from outside. O(F log F). Source: MATH 2.9, 9.1.
MapQuality measureSphereMap(const Connectivity& surface, const std::vector<double>& lengths,
                            const Points3& points);

/// Measures a map to the plane. lengths: per edge, proper triangles. points: per vertex.
/// A face is flipped unless its signed area is positive. O(F log F). Source: MATH 9.1.
MapQuality measurePlaneMap(const Connectivity& surface, const std::vector<double>& lengths,
                           const std::vector<std::complex<double>>& points);

/// The same of a map with seams. corner: per halfedge h the point of tail(h) in its face.
MapQuality measurePlaneMap(const Connectivity& surface, const std::vector<double>& lengths,
                           const std::vector<std::complex<double>>& points,
                           const std::vector<Index>& corner);

/// Signed solid angle of a spherical triangle, positive when a, b, c run counter-clockwise seen
/// from outside. Relative accuracy also for tiny triangles.
double signedSolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c);

}  // namespace moduli
