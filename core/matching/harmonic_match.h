#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/matching/cover_map.h"
#include "core/matching/target_links.h"

/// From places that are only nearly right to a map between surfaces with handles without a folded
/// face.
///
///   ASSIGN_OR_RETURN(const CoverSurface cover, straightCover(context, b, lengths_b));
///   ASSIGN_OR_RETURN(const HarmonicMatch match,
///                    matchHarmonically(context, a, lengths_a, cover, targets));
///   match.map.images[v];  // on B
namespace moduli {

struct HarmonicMatchOptions {
  /// Errors of targets are evened out over this length, a share of the root of the area of A.
  /// Infinite: targets tell the homotopy class alone, and the map is harmonic.
  double smoothing = 0.06;
};

struct HarmonicMatch {
  CoverMap map;  ///< No face folded.
  double energy_ratio =
      1;                 ///< Energy over the area covered: at least 1, small near conformal maps.
  double smoothing = 0;  ///< What was used: longer than asked for where that folded faces.
  Index replaced = 0;    ///< Targets that contradicted their neighbours'; they do not pull.
  double closure = 0;    ///< As TargetLinks.
  double degree = 1;
  int iterations = 0;  ///< Newton steps of the last try.
};

/// The homotopy class of the targets by linkTargets, and in it the map that minimizes 1/2 sum of
/// w_e d_e^2 + 1/2 sum of (share of A's area) (distance from the target)^2 / smoothing^2 in the
/// metric of the cover: twice, the second time with hardly a pull of targets much farther from
/// their images than most. The cotan weights w_e are A's own and, where faces fold under these or
/// the energy is not convex, kept positive: then the minimum is the only one. Where a few
/// faces fold all the same, targets near them fall silent; where many do, smoothing is made longer,
/// and if no length helps, targets fall silent at the given one. Without the pull of targets no
/// face can fold (Colin de Verdière 1991) but by rounding. Of tori one vertex then stays at its
/// target.
///
/// lengths: per edge of `surface`, positive up to rounding. targets: per vertex. Fails with
/// kInvalidOption (smoothing not positive), kFoldedMap (faces too thin for doubles), and as
/// linkTargets, mollify and harmonicMap do. 4 to 8 factorizations of 2 V unknowns a try. Stages:
/// "homotopy", "harmonic". Source: MATH 9.4.
Result<HarmonicMatch> matchHarmonically(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const CoverSurface& cover,
                                        const std::vector<SurfacePoint>& targets,
                                        const HarmonicMatchOptions& options = {});

/// The same from a class that is known: linkTargets', or linkBordered's of surfaces with boundary.
Result<HarmonicMatch> matchHarmonically(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const CoverSurface& cover, const TargetLinks& targets,
                                        const HarmonicMatchOptions& options = {});

/// The same from a map without folded faces on: its images are the targets, and its class the one.
/// Fails likewise, but not as linkTargets does.
Result<HarmonicMatch> evenOut(Context& context, const Connectivity& surface,
                              const std::vector<double>& lengths, const CoverSurface& cover,
                              CoverMap map, const HarmonicMatchOptions& options = {});

}  // namespace moduli
