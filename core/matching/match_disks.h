#pragma once

#include "core/matching/match_spheres.h"

/// Matching of surfaces of genus 0 with one boundary loop. Internal to this room.
namespace moduli {

/// A map of disks near a guess, boundary onto boundary, without folded faces: the automorphism of
/// the disk between their conformal maps that brings samples nearest to where they ought to go; for
/// near isometries, where that map misses the guess, and where there are landmarks, then
/// fitHomeomorphism, with targets of the boundary put in order along it. Soft landmarks are then
/// taken to their places as far as no face folds (flowOnHemisphere), and what comes of that is
/// evened out by another fit. Points of the boundary come with a weight of 0, on an edge of it.
/// Edges inside that join vertices of the boundary are split at their middles to that end: the map
/// is linear (on the sphere) on the parts of faces that this makes.
///
/// Fails with kFoldedMap (naming an exact landmark that is not met), and as checkBorderSides,
/// checkDistinct, checkBorderOrder (of exact ones), conformalHemisphere and fitHomeomorphism do.
Result<SphereCorrespondence> matchDisks(Context& context, const TriangleMesh& a,
                                        const TriangleMesh& b, const SpectralGuess& guess,
                                        const MatchOptions& options);

}  // namespace moduli
