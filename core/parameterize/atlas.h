#pragma once

#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/affine_atlas.h"
#include "core/parameterize/packing.h"
#include "core/parameterize/parameterization.h"

/// Affine atlases with as few extraordinary points as there can be, for manifold splines.
namespace moduli {

struct AtlasOptions {
  /// Where the atlas is left out; they share the curvature evenly. Empty: as few as there can be,
  /// where chooseCones puts them: one for genus >= 2, none for genus 1, three for genus 0.
  std::vector<Index> extraordinary;
  bool initial_delaunay = true;  ///< As in FlatOptions, like the rest.
  bool refine = true;
  double margin = kIslandMargin;
  std::vector<bool> seams;
};

/// The least number of extraordinary points on a closed surface: 3 for genus 0, 0 for 1, 1 beyond.
Index leastExtraordinary(Index euler_characteristic);

/// Finds the discrete conformal metric of a closed connected surface that is flat but for the
/// extraordinary points (2 pi chi over their number each), of the area of the surface, and its
/// atlas by the stars of all other vertices: the result's `atlas`. The rest of the result is that
/// of parameterizeFlat.
///
/// Fails with kUnsupportedTopology (other surfaces), kInvalidOption (too few points: the theorem
/// that forbids it is named; points on a torus; vertices that do not exist or come twice),
/// kResidualTooLarge (transition maps that do not fit to 1e-9), and as chooseCones and
/// parameterizeFlat do. About 8 F. Source: Gu, He, Jin, Luo, Qin, Yau 2007; MATH 10.
Result<Parameterization> parameterizeAtlas(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const AtlasOptions& options);

}  // namespace moduli
