#pragma once

#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/connectivity.h"
#include "core/spherical/map_quality.h"
#include "core/spherical/mobius.h"
#include "core/spherical/surface_point.h"

/// Sphere maps that meet landmarks exactly and stay bijective.
///
///   ASSIGN_OR_RETURN(const SphereMap map, mapToSphereLinear(context, surface, lengths));
///   ASSIGN_OR_RETURN(const LandmarkMap met,
///                    meetLandmarks(context, surface, lengths, map.points,
///                                  {{vertexPoint(surface, 17), target}}));
namespace moduli {

/// A point of the surface and the unit vector where it is to land.
struct Landmark {
  SurfacePoint point;
  Eigen::Vector3d target;
  std::string name = {};  ///< For messages; "": "landmark" and its number.
};

struct LandmarkMapOptions {
  /// First moves the whole sphere by the Möbius map that brings the landmarks nearest to their
  /// targets (alignLandmarks with the preference below), which costs no angle; by a rotation where
  /// the Möbius map would fold a face. Otherwise only the landmarks' surroundings move.
  bool align = true;
  double rotation_preference = 0.01;
  /// Radians. How far a landmark's pull spreads over the sphere: shorter keeps the map conformal
  /// farther away and bends it more near by.
  double stiffness = 0.2;
  double smoothing = 0.05;    ///< Radians, of the Beltrami coefficients between steps.
  double bound = 0.95;        ///< Smoothed coefficients are cut off at this modulus, in (0, 1).
  double longest_step = 0.1;  ///< Radians: how far landmarks go at once, before any halving.
  int max_halvings = 10;
  int polishing = 10;  ///< Rounds at the end, with the landmarks in place.
  /// Where landmarks contradict each other, goes as far as no face folds instead of failing.
  bool partly = false;
};

struct LandmarkMap {
  Points3 points;  ///< Per vertex, on the unit sphere; no face folded.
  /// |mu| of the map from the given points to these, over the flat faces; 0 for Möbius maps but for
  /// their bending of flat faces. The mean is weighted by the given faces' areas.
  double mean_beltrami = 0, max_beltrami = 0;
  MapQuality quality;             ///< From the surface's metric to the points.
  std::vector<double> distances;  ///< Per landmark, how far it is from its target, a chord.
  int steps = 0;                  ///< Of the homotopy; 0 where all landmarks were met already.
  int halvings = 0;
};

/// Moves a bijective map to the sphere so that all landmarks land on their targets (to 1e-12) while
/// every spherical triangle keeps its orientation, bending angles little. After the alignment the
/// landmarks travel along great circles in steps. In a step the smoothed and cut off Beltrami
/// coefficients of the map as it is prescribe the next one, by the generalized Laplace equation in
/// two overlapping stereographic charts in turn (relaxChart); should a face fold, the map's own
/// coefficients take their place, then the step is halved. Landmarks within faces pin the
/// combination of the corners. Where the landmarks are met already (to 1e-12) the points come back
/// unchanged. Near-optimal, not the extremal map. Commutes with rotations of points and targets
/// together.
///
/// lengths: per edge of the surface, for the dilatation alone. points: per vertex, a bijective map.
/// Fails with kUnsupportedTopology (not closed), kInvalidOption naming the landmark (not on the
/// surface; target not a unit vector to 1e-6 or, once aligned, opposite to where the landmark is;
/// two landmarks coincide, are sent to one place, or meet on their way), kFoldedMap (the given map
/// folds, or none without folds was found: the message names the landmark nearest to the fold, and
/// another one if it is near, too) and as SpdSolver. Two factorizations of a fourth-order operator
/// a step (four where the first attempt folds), about ten steps a radian, and four a round of
/// polishing. Source: after Lam and Lui 2014 (smoothed coefficients and the linear Beltrami system
/// in turn); MATH 2.3 (c), 9.1, 9.2.
Result<LandmarkMap> meetLandmarks(Context& context, const Connectivity& surface,
                                  const std::vector<double>& lengths, Points3 points,
                                  const std::vector<Landmark>& landmarks,
                                  const LandmarkMapOptions& options = {});

}  // namespace moduli
