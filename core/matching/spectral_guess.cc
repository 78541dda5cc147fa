#include "core/matching/spectral_guess.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/side_by_side.h"
#include "core/matching/coarse_fit.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// A near isometry as good as this needs no other explanation,
constexpr double kGoodDefect = 0.03;
/// and is the better one unless the other's defect is this part of its own, or the distances left
/// by the best Möbius map of space.
constexpr double kMobiusShare = 0.5;
/// Where it is none, so many different matches are refined to the end; the right one may be far
/// down the list of those that the lowest modes tell.
constexpr std::size_t kManyFinalists = 24;
/// Matches of at most so much more defect than the best are told of.
constexpr double kNearlyAsGood = 2;
/// So many of them are compared.
constexpr std::size_t kMostTried = 8;
/// Of those, boundaries and landmarks leave the ones out that miss them by more than another one by
/// this factor.
constexpr double kClearlyFarther = 2;
/// Places that modes tell are so uneven, over the root of the area: boundaries that are nearer than
/// this are met.
constexpr double kUneven = 0.02;
/// Answers whose coarse maps are this near to each other, in the mean over the root of the area,
/// are one: coarse maps err by one or two hundredths.
constexpr double kOneMap = 0.05;
/// One map found twice settles to changes that differ by some percent: of it, those answers are
/// left out that change the shape more than another one of less than this part.
constexpr double kClearlyLess = 0.95;
/// Changes by different maps are equal that differ by less than this part: so do copies of an
/// exactly symmetric body, by the rounding of its places.
constexpr double kEqually = 0.999;
/// Twice that of similarities (ShapeChange): less is no change.
constexpr double kNoChange = 2e-5;

/// Where surfaces lie on each other, so many modes are fitted to that at first; and a turn of the
/// normal by one radian counts as much as this distance, in roots of the area.
constexpr Eigen::Index kFirstModes = 20;
constexpr double kNormalShare = 0.1;

bool isClosed(const TriangleMesh& mesh) {
  return computeTopology(mesh.connectivity()).boundary_loops.empty();
}

/// Nothing where there is nothing to gain, or the mesh does not allow it.
Result<std::optional<ThinnedSurface>> thinnedTo(Context& context, const TriangleMesh& mesh,
                                                Index most) {
  std::optional<ThinnedSurface> none;
  if (mesh.vertexCount() <= most + most / 2 || !isClosed(mesh)) return none;
  Result<ThinnedSurface> thinned = thinSurface(context, mesh, most);
  RETURN_IF_ERROR(context.check());
  if (!thinned.ok()) return none;
  return std::optional(*std::move(thinned));
}

/// The energies of Möbius's metric are those of the whole surface, for curvature is far less
/// smooth.
Result<SpectralSurface> spectralOf(Context& context, const TriangleMesh& mesh,
                                   const std::optional<ThinnedSurface>& thinned,
                                   MatchMetric metric) {
  if (!thinned) return makeSpectralSurface(context, mesh, metric);
  std::vector<double> energies;
  if (metric == MatchMetric::kMobius) {
    ASSIGN_OR_RETURN(energies, willmoreEnergies(mesh));
    energies = gathered(mesh, *thinned, std::move(energies));
  }
  return makeSpectralSurface(context, thinned->mesh, metric, std::move(energies));
}

using SpectralPair = std::pair<SpectralSurface, SpectralSurface>;

Result<SpectralPair> spectralPair(Context& context, const MatchPair& pair, MatchMetric metric) {
  std::optional<Result<SpectralSurface>> first, second;
  sideBySide(
      context, [&](Context& own) { first.emplace(spectralOf(own, pair.a, pair.thin_a, metric)); },
      [&](Context& own) { second.emplace(spectralOf(own, pair.b, pair.thin_b, metric)); });
  RETURN_IF_ERROR(first->status());
  RETURN_IF_ERROR(second->status());
  return SpectralPair(**std::move(first), **std::move(second));
}

/// Fills in the rest of a guess from its match.
Status locate(Context& context, const MatchPair& pair, const SpectralPair& surfaces,
              SpectralGuess& guess) {
  const auto& [x, y] = surfaces;
  ASSIGN_OR_RETURN(guess.match, withAllModes(context, x, y, std::move(guess.match)));
  guess.samples = x.coarse.vertices;
  ASSIGN_OR_RETURN(guess.points, correspondingPoints(context, x, y, guess.match.functional));
  if (pair.thin_b) guess.points = onWhole(pair.b, *pair.thin_b, guess.points);
  if (pair.thin_a) {
    guess.vertices = pair.thin_a->vertices;
  } else {
    guess.vertices.resize(guess.points.size());
    std::iota(guess.vertices.begin(), guess.vertices.end(), 0);
  }
  return {};
}

/// Of the fine samples, where they are and which way the surface looks there: 6 x samples. The
/// normals tell both sides of a thin part. origin: near both surfaces, for floats compare places.
Eigen::MatrixXd placesOf(const SpectralSurface& surface, const Eigen::Vector3d& origin,
                         double unit) {
  Eigen::MatrixXd places(6, surface.fine.vertices.size());
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const Index v = surface.fine.vertices[static_cast<std::size_t>(i)];
    places.col(i) << (surface.mesh.positions()[v] - origin) / unit,
        kNormalShare * surface.normals[v];
  }
  return places;
}

/// What vertices of the boundary have.
std::vector<Eigen::Vector3d> boundaryOf(const TriangleMesh& mesh,
                                        const std::vector<Eigen::Vector3d>& values) {
  std::vector<Eigen::Vector3d> result;
  for (const auto& loop : computeTopology(mesh.connectivity()).boundary_loops) {
    for (const Index h : loop) result.push_back(values[mesh.connectivity().tail(h)]);
  }
  return result;
}

/// Of the squared distances of points from the nearest of others.
double meanSquareGap(const std::vector<Eigen::Vector3d>& points,
                     const std::vector<Eigen::Vector3d>& others) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& q : others) least = std::min(least, (p - q).squaredNorm());
    sum += least;
  }
  return sum / static_cast<double>(points.size());
}

/// The mean distance of points from those of the same numbers.
double meanGap(const std::vector<Eigen::Vector3d>& points,
               const std::vector<Eigen::Vector3d>& others) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += (points[i] - others[i]).norm();
  return sum / static_cast<double>(points.size());
}

class Guessing {
 public:
  Guessing(Context& context, const MatchPair& pair, const MatchOptions& options)
      : context_(context),
        pair_(pair),
        wanted_(static_cast<std::size_t>(options.alternative)),
        initial_delaunay_(options.initial_delaunay),
        landmarks_(options.landmarks) {
    landmarks_.insert(landmarks_.end(), options.soft_landmarks.begin(),
                      options.soft_landmarks.end());
  }

  Result<SpectralAnswer> run() {
    ASSIGN_OR_RETURN(Answers own, answersBy(MatchMethod::kNearIsometry));
    if (!own.matches.empty() && own.matches.front().defect <= kGoodDefect) {
      return answerOf({&own}, own);
    }
    ASSIGN_OR_RETURN(Answers mobius, answersBy(MatchMethod::kMobius));
    ASSIGN_OR_RETURN(const bool is_mobius, isMobius(own, mobius));
    if (is_mobius) return answerOf({&own, &mobius}, mobius);
    RETURN_IF_ERROR(find(own, kManyFinalists));
    return answerOf({&own, &mobius}, own);
  }

 private:
  /// The matches by one metric, best first, and what they look at.
  struct Answers {
    MatchMethod method = MatchMethod::kNearIsometry;
    SpectralPair surfaces;
    std::vector<SpectralMatch> matches = {};
    std::size_t alike =
        0;  ///< So many of the first are nearly as good, and near landmarks and boundaries.
  };
  /// One of them.
  struct Answer {
    const Answers* by = nullptr;
    const SpectralMatch* match = nullptr;
  };

  Result<Answers> answersBy(MatchMethod method) {
    const bool mobius = method == MatchMethod::kMobius;
    ASSIGN_OR_RETURN(
        SpectralPair pair,
        spectralPair(context_, pair_, mobius ? MatchMetric::kMobius : MatchMetric::kOwn));
    Answers answers{method, std::move(pair)};
    RETURN_IF_ERROR(
        find(answers, landmarks_.empty() ? SpectralMatchOptions().finalists : kManyFinalists));
    return answers;
  }

  /// Fills in the matches.
  Status find(Answers& answers, std::size_t finalists) {
    SpectralMatchOptions options;
    options.finalists = finalists;
    if (!landmarks_.empty()) options.enough = kGoodDefect;
    const auto& [x, y] = answers.surfaces;
    ASSIGN_OR_RETURN(answers.matches, matchSpectra(context_, x, y, options));
    const std::vector<SpectralMatch>& found = answers.matches;
    answers.alike = 0;
    // Landmarks may mean any near isometry that a symmetric surface has.
    const std::size_t most = landmarks_.empty() ? kMostTried : kManyFinalists;
    const double least = found.empty() ? 0 : kNearlyAsGood * found.front().defect;
    const double enough = landmarks_.empty() ? least : std::max(least, kGoodDefect);
    while (answers.alike < std::min(found.size(), most) &&
           (answers.alike == 0 || found[answers.alike].defect < enough)) {
      ++answers.alike;
    }
    if (!isClosed(pair_.a)) {
      RETURN_IF_ERROR(
          preferNearer(answers, [this](const SpectralGuess& guess) { return gapOf(guess); }));
    }
    if (landmarks_.empty()) return {};
    return preferNearer(answers, [this](const SpectralGuess& guess) { return missOf(guess); });
  }

  /// Puts the matches first that miss something least, of those nearly as good as the best.
  /// What agrees up to the guess's own unevenness is not decided by that.
  template <typename Miss>
  Status preferNearer(Answers& answers, const Miss& missOf) {
    if (answers.alike < 2) return {};
    std::vector<std::pair<double, SpectralMatch>> missing;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < answers.alike; ++n) {
      ASSIGN_OR_RETURN(const SpectralGuess guess, guessOf({&answers, &answers.matches[n]}));
      missing.emplace_back(missOf(guess), answers.matches[n]);
      least = std::min(least, missing.back().first);
    }
    const auto farther = std::stable_partition(
        missing.begin(), missing.end(),
        [&](const auto& miss) { return miss.first <= kClearlyFarther * least; });
    answers.alike = static_cast<std::size_t>(farther - missing.begin());
    for (std::size_t n = 0; n < missing.size(); ++n) {
      answers.matches[n] = std::move(missing[n].second);
    }
    return {};
  }

  /// Puts the match first, of those that are alike, that changes the shape least; of several that
  /// lead to the same map, the best by its modes. Of closed surfaces.
  Status preferByShape(Answers& answers) {
    std::vector<SpectralMatch>& matches = answers.matches;
    if (answers.alike < 2 || !isClosed(pair_.a)) return {};
    const Context::Stage stage(context_, "compare");
    const TriangleMesh &a = pair_.coarseA(), &b = pair_.coarseB();
    const bool back = b.vertexCount() < a.vertexCount();
    const Result<CoarseFit> fit =
        CoarseFit::make(context_, back ? b : a, back ? a : b, initial_delaunay_);
    RETURN_IF_ERROR(context_.check());
    if (!fit.ok()) return {};
    std::vector<std::optional<CoarseMap>> maps(answers.alike);
    parallelBlocks(maps.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        Context own = context_;
        own.setProgressSink({});
        maps[n] = coarseMapOf(own, answers, n, *fit, back);
      }
    });
    RETURN_IF_ERROR(context_.check());
    // Where the best by its modes has no coarse map, its shape is not known.
    if (!maps.front()) return {};
    const std::size_t best = leastChange(maps, std::sqrt((back ? a : b).area()));
    const auto first = matches.begin(), chosen = first + static_cast<std::ptrdiff_t>(best);
    std::rotate(first, chosen, chosen + 1);
    return {};
  }

  /// The number of the map that changes the shape least, or of the first of those that do not
  /// change it more: by rounding alone or, where they are the same map, by what that settles to.
  static std::size_t leastChange(const std::vector<std::optional<CoarseMap>>& maps, double unit) {
    const auto changeOf = [](const std::optional<CoarseMap>& map) {
      return map ? std::max(map->change.product(), kNoChange)
                 : std::numeric_limits<double>::infinity();
    };
    const auto least =
        std::min_element(maps.begin(), maps.end(),
                         [&](const auto& x, const auto& y) { return changeOf(x) < changeOf(y); });
    const auto best = std::find_if(maps.begin(), maps.end(), [&](const auto& map) {
      if (!map) return false;
      const bool is_same = meanGap(map->places, (*least)->places) < kOneMap * unit;
      return (is_same ? kClearlyLess : kEqually) * changeOf(map) <= changeOf(*least);
    });
    return static_cast<std::size_t>(best - maps.begin());
  }

  /// Nothing where there is none. back: of the map from b to a. To the finer mesh, vertices go onto
  /// the surface, not onto chords of it.
  std::optional<CoarseMap> coarseMapOf(Context& context, const Answers& answers, std::size_t n,
                                       const CoarseFit& fit, bool back) const {
    const auto& [a, b] = answers.surfaces;
    const Result<SpectralMatch> match = withAllModes(context, a, b, answers.matches[n]);
    if (!match.ok()) return {};
    const SpectralSurface &x = back ? b : a, &y = back ? a : b;
    Eigen::MatrixXd functional = match->functional;
    if (back) functional.transposeInPlace();  // Nearly its inverse.
    const auto points = correspondingPoints(context, x, y, functional);
    if (!points.ok()) return {};
    Result<CoarseMap> map = fit(context, *points, answers.method == MatchMethod::kMobius);
    return map.ok() ? std::optional(*std::move(map)) : std::nullopt;
  }

  /// The root mean square distance of landmarks from where the nearest vertices go.
  double missOf(const SpectralGuess& guess) const {
    double sum = 0;
    for (const MatchLandmark& landmark : landmarks_) {
      const Eigen::Vector3d from =
          spacePoint(pair_.a.connectivity(), pair_.a.positions(), landmark.a);
      const auto nearest =
          std::min_element(guess.vertices.begin(), guess.vertices.end(), [&](Index v, Index w) {
            return (pair_.a.positions()[v] - from).squaredNorm() <
                   (pair_.a.positions()[w] - from).squaredNorm();
          });
      const SurfacePoint& to =
          guess.points[static_cast<std::size_t>(nearest - guess.vertices.begin())];
      sum += (spacePoint(pair_.b.connectivity(), pair_.b.positions(), to) -
              spacePoint(pair_.b.connectivity(), pair_.b.positions(), landmark.b))
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(landmarks_.size()));
  }

  /// The root mean square distance of the boundaries from each other, each one's vertices from the
  /// other one's; at least what the modes' places are uneven.
  double gapOf(const SpectralGuess& guess) const {
    const std::vector<Eigen::Vector3d> there = boundaryOf(pair_.b, pair_.b.positions());
    std::vector<Eigen::Vector3d> places;
    for (const SurfacePoint& point : guess.points) {
      places.push_back(spacePoint(pair_.b.connectivity(), pair_.b.positions(), point));
    }
    const std::vector<Eigen::Vector3d> images = boundaryOf(pair_.a, places);
    const double gap = std::sqrt((meanSquareGap(images, there) + meanSquareGap(there, images)) / 2);
    return std::max(gap, kUneven * std::sqrt(pair_.b.area()));
  }

  /// Whether the surfaces are such that a Möbius map of space carries to each other. It has 10
  /// numbers, and a guess some hundred points: they do not agree by accident.
  Result<bool> isMobius(const Answers& own, const Answers& mobius) {
    if (own.matches.empty() || mobius.matches.empty()) return own.matches.empty();
    const SpectralMatch &isometry = own.matches.front(), &match = mobius.matches.front();
    if (match.defect < kMobiusShare * isometry.defect) return true;
    if (!isClosed(pair_.a)) return false;
    ASSIGN_OR_RETURN(const SpectralGuess guess, guessOf({&mobius, &match}));
    const Result<SpaceMobiusFit> fit = mobiusOf(pair_, guess);
    if (!fit.ok() || !(fit->median < kNearMobius)) return false;
    ASSIGN_OR_RETURN(const SpectralGuess other_guess, guessOf({&own, &isometry}));
    const Result<SpaceMobiusFit> other = mobiusOf(pair_, other_guess);
    return !other.ok() || fit->median < kMobiusShare * other->median;
  }

  Result<SpectralAnswer> answerOf(const std::vector<Answers*>& all, Answers& best) {
    if (best.matches.empty()) {
      return Status(Reason::kNoConvergence,
                    "no correspondence of the surfaces was found that keeps orientation",
                    "--mirror looks for one that turns it over; --landmarks tells points that "
                    "correspond");
    }
    RETURN_IF_ERROR(preferByShape(best));
    const std::vector<Answer> ranked = ranking(all, best);
    if (wanted_ >= ranked.size()) {
      return Status(Reason::kInvalidOption,
                    "there is no answer " + std::to_string(wanted_) +
                        ": beside the best there are " + std::to_string(ranked.size() - 1),
                    "the best one's list of others tells them");
    }
    SpectralAnswer answer;
    for (std::size_t i = 0; i < ranked.size(); ++i) {
      if (i != wanted_) {
        answer.alternatives.push_back({ranked[i].by->method, ranked[i].match->defect});
      }
    }
    ASSIGN_OR_RETURN(answer.guess, guessOf(ranked[wanted_]));
    return answer;
  }

  /// The best, and those that are nearly as good or better by their defects.
  static std::vector<Answer> ranking(const std::vector<Answers*>& all, const Answers& best) {
    const SpectralMatch& first = best.matches.front();
    std::vector<Answer> ranked = {{&best, &first}};
    for (const Answers* answers : all) {
      for (const SpectralMatch& match : answers->matches) {
        if (&match == &first || !(match.defect < kNearlyAsGood * first.defect)) continue;
        ranked.push_back({answers, &match});
      }
    }
    std::stable_sort(ranked.begin() + 1, ranked.end(), [](const Answer& x, const Answer& y) {
      return x.match->defect < y.match->defect;
    });
    return ranked;
  }

  Result<SpectralGuess> guessOf(const Answer& answer) {
    SpectralGuess guess;
    guess.method = answer.by->method;
    guess.match = *answer.match;
    RETURN_IF_ERROR(locate(context_, pair_, answer.by->surfaces, guess));
    return guess;
  }

  Context& context_;
  const MatchPair& pair_;
  std::size_t wanted_;
  bool initial_delaunay_;
  std::vector<MatchLandmark> landmarks_;
};

}  // namespace

Result<MatchPair> makeMatchPair(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                Index most) {
  MatchPair pair{a, b};
  Result<std::optional<ThinnedSurface>> first(std::nullopt), second(std::nullopt);
  sideBySide(
      context, [&](Context& own) { first = thinnedTo(own, a, most); },
      [&](Context& own) { second = thinnedTo(own, b, most); });
  ASSIGN_OR_RETURN(pair.thin_a, std::move(first));
  ASSIGN_OR_RETURN(pair.thin_b, std::move(second));
  return pair;
}

Result<SpectralAnswer> guessSpectrally(Context& context, const MatchPair& pair,
                                       const MatchOptions& options) {
  return Guessing(context, pair, options).run();
}

Result<bool> changesLess(Context& context, const MatchPair& pair,
                         const std::vector<SurfacePoint>& points,
                         const std::vector<SurfacePoint>& others, bool initial_delaunay) {
  const Context::Stage stage(context, "compare");
  const Result<CoarseFit> fit = CoarseFit::make(context, pair.coarseA(), pair.b, initial_delaunay);
  RETURN_IF_ERROR(context.check());
  if (!fit.ok()) return false;
  const Result<CoarseMap> map = (*fit)(context, points), other = (*fit)(context, others);
  RETURN_IF_ERROR(context.check());
  return map.ok() && (!other.ok() || map->change.product() < other->change.product());
}

Result<SpectralGuess> guessFromPlaces(Context& context, const MatchPair& pair,
                                      const SpectralGuess& guess) {
  ASSIGN_OR_RETURN(const SpectralPair surfaces, spectralPair(context, pair, MatchMetric::kOwn));
  const auto& [x, y] = surfaces;
  const double unit = std::sqrt(pair.b.area());
  const Eigen::Vector3d& origin = pair.b.positions().front();
  const SampledModes from = {placesOf(x, origin, unit), {}}, to = {placesOf(y, origin, unit), {}};
  const SampleMaps maps = nearestSamples(from, to, Eigen::MatrixXd::Identity(6, 6));
  const Eigen::Index modes = std::min({kFirstModes, x.values.size(), y.values.size()});
  SpectralGuess other = guess;
  other.match.functional =
      fitFunctionalMap(sampleModes(x, x.fine), sampleModes(y, y.fine), maps, modes);
  RETURN_IF_ERROR(locate(context, pair, surfaces, other));
  return other;
}

Result<SpaceMobiusFit> mobiusOf(const MatchPair& pair, const SpectralGuess& guess) {
  std::vector<Eigen::Vector3d> points, targets;
  for (const Index i : guess.samples) {
    points.push_back(pair.a.positions()[guess.vertices[i]]);
    targets.push_back(spacePoint(pair.b.connectivity(), pair.b.positions(), guess.points[i]));
  }
  ASSIGN_OR_RETURN(SpaceMobiusFit fit, fitSpaceMobius(points, targets));
  fit.median /= std::sqrt(pair.b.area());
  return fit;
}

}  // namespace moduli
