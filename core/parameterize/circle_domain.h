#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"

namespace moduli {

struct CircleDomainOptions {
  /// With several loops robust or auto; others are for the disk alone.
  MapMethod method = MapMethod::kAuto;
  bool initial_delaunay = true;  ///< As in PrescribeOptions; the robust method tries both.
  bool refine = true;            ///< As in SphereOptions.
};

/// Maps a connected surface of genus 0 with boundary to the unit disk less round holes: the longest
/// boundary loop to the unit circle, the others to the circles of the holes, normalized as koebe()
/// says; two loops to a concentric annulus, one to the disk.
///
/// Loops are closed by caps, the sphere is mapped by the robust method, the caps are taken off, and
/// Koebe's iteration makes the loops round by exact conformal maps of the plane. A cap is one fan
/// of triangles: vertex scaling makes the surface flat, and with it the map conformal, whatever the
/// cap does; harmonic maps would need one that is a fine mesh of a disk. The result's `circles`
/// belong to the loops, the outer one first and then in computeTopology's order; `modulus` is that
/// of an annulus. lengths, positions: as parameterizeSphere's. Fails with kUnsupportedTopology
/// (closed, or with handles), kInvalidOption (method), kFoldedMap, kNoConvergence, and as the
/// solvers do. A map to the sphere, and the elementary maps of koebe(). Source: MATH 5.5; Koebe
/// 1910.
Result<Parameterization> parameterizeCircleDomain(Context& context, const Connectivity& surface,
                                                  const std::vector<double>& lengths,
                                                  const std::vector<Eigen::Vector3d>& positions,
                                                  const CircleDomainOptions& options = {});

}  // namespace moduli
