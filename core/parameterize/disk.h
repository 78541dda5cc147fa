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

struct DiskOptions {
  MapMethod method = MapMethod::kAuto;
  bool initial_delaunay = true;          ///< As in PrescribeOptions; the robust method tries both.
  bool refine = true;                    ///< As in SphereOptions.
  std::optional<MobiusMap> mobius = {};  ///< Applied last; has to keep the disk.
};

/// Maps a connected surface of genus 0 with one boundary loop to the unit disk, conformally but for
/// the mesh, boundary vertices on the circle, with the vertices' mean (weighted by the areas around
/// them) at the centre: unique up to a rotation.
///
/// lengths, positions: as parameterizeSphere's. Methods: robust sends a boundary vertex to infinity
/// and flattens the rest on a half plane; heat flow maps the double to the sphere (the double
/// cover); linear solves linear systems of the surface alone. Fails with kUnsupportedTopology,
/// kInvalidOption (a Möbius map that moves the circle), kFoldedMap, and as the solvers do.
/// Robust: some 5 factorizations, 6 to 9 F; linear: 2 F. Source: MATH 2.5, 2.8.
Result<Parameterization> parameterizeDisk(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const std::vector<Eigen::Vector3d>& positions,
                                          const DiskOptions& options = {});

}  // namespace moduli
