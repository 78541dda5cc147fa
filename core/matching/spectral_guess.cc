#include "core/matching/spectral_guess.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/side_by_side.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

/// A near isometry as good as this needs no other explanation,
constexpr double kGoodDefect = 0.03;
/// and is the better one unless the other's defect is this part of its own, or the distances left
/// by the best Möbius map of space.
constexpr double kMobiusShare = 0.5;
/// Matches of at most so much more defect than the best are told of.
constexpr double kNearlyAsGood = 2;
/// So many of them are compared by landmarks; another one than the best by its modes has to miss
/// them by less than this part.
constexpr std::size_t kMostTried = 8;
constexpr double kClearlyNearer = 0.5;

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

class Guessing {
 public:
  Guessing(Context& context, const MatchPair& pair, const MatchOptions& options)
      : context_(context),
        pair_(pair),
        wanted_(static_cast<std::size_t>(options.alternative)),
        landmarks_(options.landmarks) {
    landmarks_.insert(landmarks_.end(), options.soft_landmarks.begin(),
                      options.soft_landmarks.end());
  }

  Result<SpectralAnswer> run() {
    ASSIGN_OR_RETURN(const Answers own, answersBy(MatchMethod::kNearIsometry));
    std::vector<const Answers*> all = {&own};
    std::optional<Result<Answers>> mobius;
    if (own.matches.empty() || own.matches.front().defect > kGoodDefect) {
      mobius.emplace(answersBy(MatchMethod::kMobius));
      RETURN_IF_ERROR(mobius->status());
      all.push_back(&**mobius);
    }
    std::vector<SpectralGuess> guesses;
    for (const Answers* answers : all) {
      if (answers->matches.empty()) continue;
      ASSIGN_OR_RETURN(SpectralGuess guess, guessOf({answers, &answers->matches.front()}));
      guesses.push_back(std::move(guess));
    }
    if (guesses.empty()) {
      return Status(Reason::kNoConvergence,
                    "no correspondence of the surfaces was found that keeps orientation",
                    "--mirror looks for one that turns it over; --landmarks tells points that "
                    "correspond");
    }
    const bool second = guesses.size() == 2 && isMobius(guesses.front(), guesses.back());
    return answerOf(all, std::move(second ? guesses.back() : guesses.front()));
  }

 private:
  using Pair = std::pair<SpectralSurface, SpectralSurface>;

  /// The matches by one metric, best first, and what they look at.
  struct Answers {
    MatchMethod method = MatchMethod::kNearIsometry;
    Pair surfaces;
    std::vector<SpectralMatch> matches;
  };
  /// One of them.
  struct Answer {
    const Answers* by = nullptr;
    const SpectralMatch* match = nullptr;
  };

  Result<Pair> spectralPair(MatchMetric metric) {
    std::optional<Result<SpectralSurface>> first, second;
    sideBySide(
        context_,
        [&](Context& context) {
          first.emplace(spectralOf(context, pair_.a, pair_.thin_a, metric));
        },
        [&](Context& context) {
          second.emplace(spectralOf(context, pair_.b, pair_.thin_b, metric));
        });
    RETURN_IF_ERROR(first->status());
    RETURN_IF_ERROR(second->status());
    return Pair(**std::move(first), **std::move(second));
  }

  Result<Answers> answersBy(MatchMethod method) {
    const bool mobius = method == MatchMethod::kMobius;
    ASSIGN_OR_RETURN(Pair pair, spectralPair(mobius ? MatchMetric::kMobius : MatchMetric::kOwn));
    ASSIGN_OR_RETURN(std::vector<SpectralMatch> matches,
                     matchSpectra(context_, pair.first, pair.second));
    Answers answers{method, std::move(pair), std::move(matches)};
    if (!landmarks_.empty()) {
      RETURN_IF_ERROR(preferByLandmarks(answers));
    }
    return answers;
  }

  /// Puts the match first that misses the landmarks least, of those nearly as good as the best.
  Status preferByLandmarks(Answers& answers) {
    std::vector<SpectralMatch>& matches = answers.matches;
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < std::min(matches.size(), kMostTried); ++n) {
      if (n > 0 && !(matches[n].defect < kNearlyAsGood * matches[0].defect)) break;
      ASSIGN_OR_RETURN(const SpectralGuess guess, guessOf({&answers, &matches[n]}));
      // What agrees up to the guess's own unevenness is decided by the defect.
      const double miss = missOf(guess);
      if (miss >= kClearlyNearer * least) continue;
      least = miss;
      best = n;
    }
    std::rotate(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(best),
                matches.begin() + static_cast<std::ptrdiff_t>(best) + 1);
    return {};
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

  /// Whether the second guess is of surfaces that a Möbius map of space carries to each other. It
  /// has 10 numbers, and the guess some hundred points: they do not agree by accident.
  bool isMobius(const SpectralGuess& isometry, const SpectralGuess& mobius) const {
    if (mobius.match.defect < kMobiusShare * isometry.match.defect) return true;
    if (!isClosed(pair_.a)) return false;
    const Result<SpaceMobiusFit> fit = mobiusOf(pair_, mobius), other = mobiusOf(pair_, isometry);
    if (!fit.ok() || !(fit->median < kNearMobius)) return false;
    return !other.ok() || fit->median < kMobiusShare * other->median;
  }

  Result<SpectralAnswer> answerOf(const std::vector<const Answers*>& all, SpectralGuess best) {
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
    answer.guess = std::move(best);
    if (wanted_ > 0) {
      ASSIGN_OR_RETURN(answer.guess, guessOf(ranked[wanted_]));
    }
    return answer;
  }

  /// The best, and those that are nearly as good or better by their defects.
  static std::vector<Answer> ranking(const std::vector<const Answers*>& all,
                                     const SpectralGuess& best) {
    std::vector<Answer> ranked(1);
    for (const Answers* answers : all) {
      for (const SpectralMatch& match : answers->matches) {
        const Answer answer{answers, &match};
        if (answers->method == best.method && &match == &answers->matches.front()) {
          ranked.front() = answer;
        } else if (match.defect < kNearlyAsGood * best.match.defect) {
          ranked.push_back(answer);
        }
      }
    }
    std::stable_sort(ranked.begin() + 1, ranked.end(), [](const Answer& x, const Answer& y) {
      return x.match->defect < y.match->defect;
    });
    return ranked;
  }

  Result<SpectralGuess> guessOf(const Answer& answer) {
    const auto& [x, y] = answer.by->surfaces;
    SpectralGuess guess;
    guess.method = answer.by->method;
    ASSIGN_OR_RETURN(guess.match, withAllModes(context_, x, y, *answer.match));
    guess.samples = x.coarse.vertices;
    ASSIGN_OR_RETURN(guess.points, correspondingPoints(context_, x, y, guess.match.functional));
    if (pair_.thin_b) guess.points = onWhole(pair_.b, *pair_.thin_b, guess.points);
    if (pair_.thin_a) {
      guess.vertices = pair_.thin_a->vertices;
    } else {
      guess.vertices.resize(guess.points.size());
      std::iota(guess.vertices.begin(), guess.vertices.end(), 0);
    }
    return guess;
  }

  Context& context_;
  const MatchPair& pair_;
  std::size_t wanted_;
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
