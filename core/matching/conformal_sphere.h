#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/spherical/landmark_alignment.h"
#include "core/spherical/mobius.h"

/// Conformal maps of surfaces of genus 0, to start maps between these from. Internal to this room.
namespace moduli {

struct ConformalSphere {
  std::vector<double> lengths;  ///< Per edge, mollified, in units of the root of the area.
  Points3 points;               ///< Per vertex on the unit sphere; no face folded.
};

/// A conformal map without folded faces: those of the robust map, or of the linear one where
/// needles keep that from its end, are unfolded (unfoldSphere), which costs nothing where there are
/// none. Limbs that are too long for the doubles of a conformal map are distorted. mesh: closed, of
/// genus 0. initial_delaunay: as in mapToSphereRobust. Fails as mollify, mapToSphereRobust and
/// unfoldSphere do, but for kNoConvergence.
Result<ConformalSphere> conformalSphere(Context& context, const TriangleMesh& mesh,
                                        bool initial_delaunay);

/// Points of a sphere, moved by the Möbius map that brings those of the pairs nearest to where they
/// ought to go, with a slight preference for rotations. Fails as alignLandmarks does. O(points).
Result<Points3> broughtNear(const Points3& points, const std::vector<PointPair>& pairs);

}  // namespace moduli
