#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/hyperbolic/developing.h"
#include "core/parameterize/parameterization.h"

namespace moduli {

/// The group of a hyperbolic surface that is laid out, and its shortest closed geodesics.
struct DiskGeodesics {
  std::vector<Su11> generators;         ///< Of a closed surface, in the layout's coordinates.
  std::vector<GeodesicPath> geodesics;  ///< Ascending; without those on the boundary.
  double relation_residual = 0;         ///< Of the group; with a boundary, that of the double.
  /// All geodesics up to this length are known; of those longer than the shortest, some only are
  /// given.
  double complete_to = 0;
};

/// Of a closed surface, or of one with a boundary, which is found in its double. The shortest
/// geodesics, and of those up to half as long again as many as pictures have room for. Fails as
/// computeFuchsianGroup, orbitPolygon, systoles and followGeodesic do.
Result<DiskGeodesics> diskGeodesics(Context& context, const HyperbolicTriangles& triangles,
                                    const Development& development);

}  // namespace moduli
