#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/matching/match_surfaces.h"
#include "core/matching/spectral_guess.h"

/// Matching of closed surfaces of genus 0. Internal to this room.
namespace moduli {

/// Per vertex of a a point of the sphere of b, without folded faces, and the same as points of b.
struct SphereCorrespondence {
  std::vector<SurfacePoint> images, inverse;
  std::vector<SurfacePoint> landmarks = {},
                            soft_landmarks = {};  ///< Where those of the options go.
  /// Of the parts of faces that the map is linear on, where those are not the faces themselves.
  std::optional<MapReport> report = {};
  std::optional<double> distance = {};  ///< isometricDistortion of the same.
};

/// A map of spheres near a guess: the Möbius map between their conformal maps that brings samples
/// nearest to where they ought to go; for near isometries then fitHomeomorphism, of a thinned
/// surface where there is one, and from there to the whole (mapWhole). Landmarks are met
/// at last, after soft ones have been as far as they can be, and what came of that evened out.
/// Fails as mapToSphereRobust, alignLandmarks, fitHomeomorphism and meetLandmarks do.
Result<SphereCorrespondence> matchSpheres(Context& context, const MatchPair& pair,
                                          const SpectralGuess& guess, const MatchOptions& options);

}  // namespace moduli
