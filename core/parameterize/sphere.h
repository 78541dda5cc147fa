#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"
#include "core/spherical/mobius_map.h"

namespace moduli {

struct SphereOptions {
  MapMethod method = MapMethod::kAuto;
  bool initial_delaunay = true;  ///< As in PrescribeOptions; the robust method tries both.
  /// Cut the faces that no map of the given ones keeps from folding; otherwise they are an error.
  bool refine = true;
  std::optional<MobiusMap> mobius = {};  ///< Applied last.
};

/// Maps a closed connected surface of genus 0 to the unit sphere, conformally but for the mesh,
/// with the vertices' mean (weighted by the areas around them) at the centre: unique up to a
/// rotation.
///
/// lengths: per edge, positive up to rounding (mollified if need be). positions: per vertex, or
/// empty where there are none; a good start, and with kAuto more: where limbs are longer than
/// doubles reach, so that cutting faces is no help, parts of the surface in space are laid out
/// without folds, less conformally, with a warning UNFOLDED. Fails with kUnsupportedTopology
/// (another surface; the message says what it is and which map it has), kFoldedMap naming the
/// number of faces (the linear and the flowing map; the robust one with `refine` off), and as the
/// solvers do. Robust: some 5 factorizations, about 6 F; linear: about 3 F. Source: MATH 2.
Result<Parameterization> parameterizeSphere(Context& context, const Connectivity& surface,
                                            const std::vector<double>& lengths,
                                            const std::vector<Eigen::Vector3d>& positions,
                                            const SphereOptions& options = {});

}  // namespace moduli
