#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "core/base/context.h"
#include "core/intrinsic/subdivide.h"
#include "core/spherical/robust_map.h"

namespace moduli {

/// A surface with finer faces where a map of it folded.
struct RefinedSurface {
  Subdivision subdivision;
  Connectivity surface;         ///< Of the subdivision's faces.
  std::vector<double> lengths;  ///< Per edge of `surface`.
  Points3 points;               ///< On the sphere: those given, then the new vertices.
};

/// Where points of the sphere go in the plane, if the map goes on.
using SpherePointImage = std::function<std::complex<double>(const Eigen::Vector3d&)>;

/// Cuts the faces of a surface that an ideal polyhedron turns over, and no more of the others than
/// it takes (subdivide.h); new vertices lie on edges, where they cross the polyhedron's.
///
/// surface, lengths: what was mapped. ideal: of the surface or, where it has a boundary, of its
/// double, whose first vertices and faces are the surface's.
/// folded: per face of the surface. Orientation is judged on the sphere, or in the plane where
/// there is an image. Fails with kCancelled and kDeadlineExceeded.
Result<RefinedSurface> refineFolds(Context& context, const Connectivity& surface,
                                   const std::vector<double>& lengths, const IdealPolyhedron& ideal,
                                   const std::vector<bool>& folded,
                                   const SpherePointImage& image = {});

/// The height of a plane triangle over its longest side, relative to that, negative where it is
/// turned over.
double planeTriangleQuality(const std::complex<double>& a, const std::complex<double>& b,
                            const std::complex<double>& c);

}  // namespace moduli
