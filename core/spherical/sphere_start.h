#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/linear_map.h"
#include "core/spherical/mobius.h"

/// First maps to the sphere, and what all such maps demand. Internal to this room.
namespace moduli::spherical {

/// Fails with kUnsupportedTopology unless the surface is closed, connected and of genus 0.
Status checkSphere(const Connectivity& surface);

/// Per vertex the unit normal, of the sum of its faces' normals weighted by their areas. Not finite
/// where the sum vanishes. positions: per vertex. Of a surface oriented outwards it has degree 1.
Points3 gaussMap(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions);

/// Tutte's map to the sphere: every vertex but those of face `pole` lies in the mean of its
/// neighbours in the plane, so that no face folds if the graph is three-connected; lifted and
/// centred. areas: per vertex. Fails as SpdSolver and centerByMobius do.
Result<Points3> tutteMap(Context& context, const Connectivity& surface,
                         const std::vector<double>& areas, Index pole);

}  // namespace moduli::spherical
