#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/field_alignment.h"
#include "core/spherical/mobius.h"
#include "core/spherical/surface_point.h"

/// Comparison of two surfaces mapped to the sphere, such as the halves of a brain, by a field.
namespace moduli {

struct MirroredSphere {
  Connectivity surface;  ///< The same vertices; face (a, b, c) has become (a, c, b).
  Points3 points;
};

/// The mirror image of a map to the sphere: x changes its sign, which turns every face over, so the
/// faces are turned back. Mirroring twice gives the map back. It maps the mirror image of the
/// surface conformally where the map did the surface. O(F).
MirroredSphere mirrorSphere(const Connectivity& surface, Points3 points);

/// A surface on the sphere and what is compared there. Refers to its parts.
struct Hemisphere {
  const Connectivity& surface;
  const Points3& points;               ///< Per vertex, a bijective map to the sphere.
  const std::vector<double>& weights;  ///< Per vertex, such as areas.
  const std::vector<double>& field;    ///< Per vertex, such as sulcal depth or curvature.
};

struct HemisphereOptions {
  bool mirror = false;  ///< Compare the first with the mirror image of the second.
  /// Points that correspond, on the first and on the second surface: they give the rotation.
  /// Without any, the fields themselves do.
  std::vector<std::pair<SurfacePoint, SurfacePoint>> landmarks;
  FieldSearchOptions search;
};

struct HemisphereComparison {
  /// p on the first sphere corresponds to rotation * p on the second (its mirror image, if asked).
  Eigen::Matrix3d rotation;
  double correlation_before = 0;        ///< Of the fields, without the rotation.
  double correlation_after = 0;         ///< With it. Both weighted by the first's weights.
  double mean_absolute_difference = 0;  ///< In units of the fields, weighted likewise.
  std::vector<double> carried;          ///< Per vertex of the first, the second's field there.
  std::vector<SurfacePoint> places;     ///< Per vertex of the first, where on the second.
};

/// Aligns two spheres by a rotation, finds for every vertex of the first its place on the second
/// and compares the fields. Möbius maps and landmark maps come before, on the points
/// (alignLandmarks, meetLandmarks). Fails with kInvalidOption (sizes; see bestRotation and
/// alignFields), kFoldedMap and kUnsupportedTopology as SphereLocator does, naming which one.
/// A few seconds for the search; O(V log V) with landmarks. Source: MATH 9.2, 10.
Result<HemisphereComparison> compareHemispheres(Context& context, const Hemisphere& first,
                                                const Hemisphere& second,
                                                const HemisphereOptions& options = {});

}  // namespace moduli
