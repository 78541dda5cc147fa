#pragma once

#include <optional>
#include <vector>

#include "core/base/context.h"
#include "core/matching/match_surfaces.h"
#include "core/matching/space_mobius.h"
#include "core/matching/spectral_match.h"
#include "core/matching/thinned_surface.h"

/// What a match begins with: where the modes of two surfaces take the vertices of one. Internal to
/// this room.
namespace moduli {

/// Two surfaces and what stands for them where they have many vertices. Refers to the surfaces,
/// which must live as long.
struct MatchPair {
  const TriangleMesh& a;
  const TriangleMesh& b;
  std::optional<ThinnedSurface> thin_a = {}, thin_b = {};

  const TriangleMesh& coarseA() const { return thin_a ? thin_a->mesh : a; }
  const TriangleMesh& coarseB() const { return thin_b ? thin_b->mesh : b; }
};

/// So many vertices tell the modes that surfaces are matched by, and a near isometry.
inline constexpr Index kThinnedVertices = 5000;

/// Closed surfaces of more vertices than `most` and half as many again are thinned to that, where
/// their mesh allows that. Fails with kCancelled and kDeadlineExceeded. Stage: "thin".
Result<MatchPair> makeMatchPair(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                Index most = kThinnedVertices);

/// A spectral match, and what it looked at.
struct SpectralGuess {
  MatchMethod method = MatchMethod::kNearIsometry;
  SpectralMatch match;
  std::vector<Index> vertices;       ///< Of a, ascending: those of coarseA.
  std::vector<SurfacePoint> points;  ///< Per one of these its point of b: correspondingPoints.
  std::vector<Index> samples;        ///< Numbers of some of these, evenly spread.
  /// Whether points are known by their places in space: errors are then no longer than relief.
  bool by_shape = false;
};

/// The wanted answer, and what others there are.
struct SpectralAnswer {
  SpectralGuess guess;
  std::vector<MatchAlternative> alternatives;
};

/// By either metric, whichever agrees better. Of answers that are nearly as good, as symmetric
/// surfaces have them, those whose boundaries miss each other least, of these those that miss the
/// landmarks (exact and soft) least, and of these on closed surfaces the one that changes the shape
/// least (CoarseFit); where that does not tell, the best by
/// its modes. options: `alternative` says which answer. Stage: "compare". Fails with kNoConvergence
/// (no correspondence), kInvalidOption (no such answer), and as makeSpectralSurface and
/// matchSpectra do.
Result<SpectralAnswer> guessSpectrally(Context& context, const MatchPair& pair,
                                       const MatchOptions& options);

/// Whether points of b, one per vertex of coarseA, lead to a map that changes the shape less than
/// those that others lead to (CoarseFit). False where they lead to none. Of closed surfaces. Fails
/// with kCancelled and kDeadlineExceeded. As long as two fits of 1200 vertices. Stage: "compare".
Result<bool> changesLess(Context& context, const MatchPair& pair,
                         const std::vector<SurfacePoint>& points,
                         const std::vector<SurfacePoint>& others, bool initial_delaunay);

/// Another guess for surfaces that lie on each other in space, but for errors that modes even out:
/// from where they are nearest, by their own metrics. pair: a where a map of space takes it. Fails
/// as makeSpectralSurface does.
Result<SpectralGuess> guessFromPlaces(Context& context, const MatchPair& pair,
                                      const SpectralGuess& guess);

/// The Möbius map of space nearest to a guess, its median over the root of b's area. Fails as
/// fitSpaceMobius does.
Result<SpaceMobiusFit> mobiusOf(const MatchPair& pair, const SpectralGuess& guess);

/// Over so much of the root of the area errors of points known by their places are evened out; they
/// are no longer than the relief that was smoothed away.
inline constexpr double kShapeSmoothing = 0.05;

/// A Möbius map of space is one of the surfaces if it misses half of the points by less than this
/// share of the root of the area.
inline constexpr double kNearMobius = 0.03;

}  // namespace moduli
