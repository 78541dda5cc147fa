#include "core/matching/harmonic_match.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/equivariant_map.h"

namespace moduli {
namespace {

/// Beyond it targets hardly pull at all.
constexpr double kLongestSmoothing = 0.5;
/// Of the median distance of targets from images.
constexpr double kFar = 8;
/// Targets so near to folded faces do not pull at last.
constexpr int kMostRings = 4;
/// Of all faces: fewer folds than that are matters of a few targets.
constexpr double kFewFolds = 0.01;
/// Of an edge: as far as it takes to tell which targets are wrong.
constexpr double kRoughly = 1e-2;

std::vector<double> pullsOf(const std::vector<double>& areas, const std::vector<bool>& replaced,
                            double smoothing) {
  const double whole = std::accumulate(areas.begin(), areas.end(), 0.0);
  std::vector<double> pulls(areas.size(), 0.0);
  for (std::size_t v = 0; v < areas.size(); ++v) {
    if (!replaced[v]) pulls[v] = areas[v] / whole / (smoothing * smoothing);
  }
  return pulls;
}

/// Weakens the pulls of targets much farther from their images than most.
void weakenFar(const HarmonicMap& map, const CoverPlane& plane, std::vector<double>& pulls) {
  std::vector<double> distances(pulls.size()), pulling;
  for (std::size_t v = 0; v < pulls.size(); ++v) {
    distances[v] = plane.wayTo(map.moves[v].col(2)).norm();
    if (pulls[v] > 0) pulling.push_back(distances[v]);
  }
  if (pulling.empty()) return;
  const auto middle = pulling.begin() + static_cast<std::ptrdiff_t>(pulling.size() / 2);
  std::nth_element(pulling.begin(), middle, pulling.end());
  const double scale = kFar * *middle;
  if (!(scale > 0)) return;
  for (std::size_t v = 0; v < pulls.size(); ++v) {
    const double ratio = distances[v] / scale;
    pulls[v] /= (1 + ratio * ratio) * (1 + ratio * ratio);
  }
}

/// The harmonic maps of one start, for pulls and weights as they come.
class HarmonicFit {
 public:
  HarmonicFit(Context& context, const Connectivity& surface, const std::vector<double>& lengths,
              const CoverSurface& cover, const TargetLinks& start)
      : context_(context),
        surface_(surface),
        cover_(cover),
        start_(start),
        cotan_(cotanWeights(surface, lengths)),
        positive_(positiveWeights(surface, lengths)),
        areas_(vertexAreas(surface, lengths)),
        at_(linksOf(surface, cover, start.map)) {
    options_.slides = start.slides;
  }

  /// Nothing where faces fold. Targets near folded faces fall silent where these are few; where it
  /// is the last way to keep the others, always.
  Result<std::optional<HarmonicMatch>> fit(double smoothing, bool is_last = false) {
    options_.pulls.clear();
    if (std::isfinite(smoothing)) RETURN_IF_ERROR(weighTargets(smoothing));
    Result<std::optional<HarmonicMatch>> match = attempt(cotan_, smoothing);
    for (int rings = 0; match.ok() && !*match && rings <= kMostRings; ++rings) {
      if (rings > 0) silenceFolds(rings);
      match = attempt(positive_, smoothing);
      const bool few = folded_ < kFewFolds * surface_.faceCount();
      if (!std::isfinite(smoothing) || !(few || is_last)) break;
    }
    return match;
  }

  /// Of the last try.
  Index folded() const { return folded_; }

 private:
  /// A rough map with all pulls tells which of them are wrong, and where to go on from.
  Status weighTargets(double smoothing) {
    HarmonicOptions roughly = options_;
    roughly.pulls = pullsOf(areas_, start_.replaced, smoothing);
    roughly.tolerance = kRoughly;
    ASSIGN_OR_RETURN(HarmonicMap rough,
                     harmonicMap(context_, cover_.geometry, surface_, positive_, at_, roughly));
    options_.pulls = std::move(roughly.pulls);
    weakenFar(rough, cover_.plane(), options_.pulls);
    at_ = std::move(rough.links);
    options_.moves = std::move(rough.moves);
    return {};
  }

  /// Nothing where faces fold, or where the energy is no convex one, as cotangents can make it.
  Result<std::optional<HarmonicMatch>> attempt(const std::vector<double>& weights,
                                               double smoothing) {
    Result<HarmonicMap> found =
        harmonicMap(context_, cover_.geometry, surface_, weights, at_, options_);
    if (&weights == &cotan_ && (found.status().reason() == Reason::kNotPositiveDefinite ||
                                found.status().reason() == Reason::kNoConvergence)) {
      return std::optional<HarmonicMatch>();
    }
    RETURN_IF_ERROR(found.status());
    folded_ = found->folded_faces;
    std::optional<HarmonicMatch> match;
    if (folded_ == 0) {
      CoverMap map = moved(surface_, cover_, start_.map, found->moves);
      folded_ = countFolded(surface_, map);
      if (folded_ == 0) match = matchOf(*found, std::move(map), smoothing);
    }
    at_ = std::move(found->links);
    options_.moves = std::move(found->moves);
    return match;
  }

  /// Targets near folded faces do not pull any more.
  void silenceFolds(int rings) {
    const std::vector<bool> folded = foldedFaces(surface_, at_);
    std::vector<bool> silent(surface_.vertexCount(), false);
    for (Index f = 0; f < surface_.faceCount(); ++f) {
      if (!folded[f]) continue;
      for (const Index v : surface_.face(f)) silent[v] = true;
    }
    for (int n = 0; n < rings; ++n) {
      const std::vector<bool> inner = silent;
      for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
        if (inner[surface_.tail(h)]) silent[surface_.head(h)] = true;
      }
    }
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      if (silent[v]) options_.pulls[v] = 0;
    }
  }

  HarmonicMatch matchOf(const HarmonicMap& found, CoverMap map, double smoothing) const {
    HarmonicMatch match;
    match.map = std::move(map);
    match.energy_ratio = found.energy / start_.area;
    match.smoothing = smoothing;
    match.replaced =
        static_cast<Index>(std::count(start_.replaced.begin(), start_.replaced.end(), true));
    match.closure = start_.closure;
    match.degree = start_.degree;
    match.iterations = found.iterations;
    return match;
  }

  Context& context_;
  const Connectivity& surface_;
  const CoverSurface& cover_;
  const TargetLinks& start_;
  std::vector<double> cotan_, positive_;
  std::vector<double> areas_;
  VertexLinks at_;  ///< Where the next search begins; options_.moves say how it got there.
  HarmonicOptions options_;
  Index folded_ = 0;
};

}  // namespace

Result<HarmonicMatch> matchHarmonically(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const CoverSurface& cover,
                                        const std::vector<SurfacePoint>& targets,
                                        const HarmonicMatchOptions& options) {
  ASSIGN_OR_RETURN(const TargetLinks start, linkTargets(context, surface, cover, targets));
  return matchHarmonically(context, surface, lengths, cover, start, options);
}

Result<HarmonicMatch> matchHarmonically(Context& context, const Connectivity& surface,
                                        const std::vector<double>& lengths,
                                        const CoverSurface& cover, const TargetLinks& start,
                                        const HarmonicMatchOptions& options) {
  if (!(options.smoothing > 0)) {
    return Status(Reason::kInvalidOption, "the smoothing is not positive");
  }
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  HarmonicFit fit(context, surface, unitLengths(mollified.lengths), cover, start);
  std::vector<double> smoothings;
  for (double s = options.smoothing; s <= kLongestSmoothing; s *= 2) smoothings.push_back(s);
  const std::size_t last = smoothings.size();
  if (last > 0) smoothings.push_back(options.smoothing);
  smoothings.push_back(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < smoothings.size(); ++i) {
    ASSIGN_OR_RETURN(std::optional<HarmonicMatch> match, fit.fit(smoothings[i], i == last));
    if (match) return *std::move(match);
  }
  return Status(Reason::kFoldedMap,
                "the harmonic map turns over " + std::to_string(fit.folded()) + " of " +
                    std::to_string(surface.faceCount()) + " faces",
                "simplify limbs that are long and thin");
}

Result<HarmonicMatch> evenOut(Context& context, const Connectivity& surface,
                              const std::vector<double>& lengths, const CoverSurface& cover,
                              CoverMap map, const HarmonicMatchOptions& options) {
  TargetLinks start;
  start.replaced.assign(surface.vertexCount(), false);
  start.closure = closureResidual(surface, linksOf(surface, cover, map));
  start.area = cover.area;
  start.degree = 1;
  start.map = std::move(map);
  return matchHarmonically(context, surface, lengths, cover, start, options);
}

}  // namespace moduli
