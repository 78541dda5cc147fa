#include "core/matching/spectral_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDistanceRatio = 0.25;  // Of log distances and centralities of triplets.
constexpr double kWaveWeight = 3;        // Of dissimilar waves beside dissimilar distances.
constexpr std::array<Eigen::Index, 4> kFirstModes = {4, 6, 10, 14};
constexpr Eigen::Index kCoarseModes = 20, kMiddleModes = 60, kFineStep = 10;
/// After these many modes mirror images are left out, and after every second of them all but the
/// best different maps: the many starts that lead nowhere are told by their defects early.
constexpr std::array<Eigen::Index, 5> kLooks = {8, 10, 12, 14, 16};
constexpr std::size_t kContenders = 32;
/// A map of so many times the best one's defect halfway is not among the answers: these have at
/// most twice it at the end.
constexpr double kHopeless = 4;
constexpr Eigen::Index kSignedModes = 5;  // The constant and four with both signs each.
constexpr double kLeastTurned = 0.3;      // Of a map that keeps the wanted orientation.
constexpr double kDifferent = 0.1;        // Of the mean biharmonic distance.

/// Three features of a and where they go.
struct Triplet {
  std::array<std::size_t, 3> from, to;
  double cost = 0;
};

double waveDifference(const SpectralSurface& a, const SpectralSurface& b, Index i, Index j) {
  const VectorXd x = a.waves.row(i), y = b.waves.row(j);
  return (x - y).cwiseAbs().sum() / (x + y).sum();
}

/// Costs of features as partners; infinite for those that cannot be.
MatrixXd featureCosts(const SpectralSurface& a, const SpectralSurface& b) {
  MatrixXd costs(a.features.size(), b.features.size());
  for (Eigen::Index i = 0; i < costs.rows(); ++i) {
    for (Eigen::Index j = 0; j < costs.cols(); ++j) {
      const Index v = a.features[i], w = b.features[j];
      const bool alike = std::abs(std::log(a.centrality[v] / b.centrality[w])) < kDistanceRatio;
      costs(i, j) = alike ? kWaveWeight * waveDifference(a, b, v, w)
                          : std::numeric_limits<double>::infinity();
    }
  }
  return costs;
}

/// Distances between features.
MatrixXd featureDistances(const SpectralSurface& surface) {
  MatrixXd distances(surface.features.size(), surface.features.size());
  for (std::size_t i = 0; i < surface.features.size(); ++i) {
    distances.row(static_cast<Eigen::Index>(i)) = surface.from_features.row(surface.features[i]);
  }
  return distances;
}

/// The likeliest first.
std::vector<Triplet> likelyTriplets(const SpectralSurface& a, const SpectralSurface& b,
                                    std::size_t most) {
  const MatrixXd costs = featureCosts(a, b);
  const MatrixXd da = featureDistances(a), db = featureDistances(b);
  std::vector<Triplet> found;
  const auto mismatch = [&](std::size_t i, std::size_t k, std::size_t j, std::size_t l) {
    return std::abs(std::log(da(i, k) / db(j, l)));
  };
  const std::size_t na = a.features.size(), nb = b.features.size();
  Triplet t;
  auto& [i0, i1, i2] = t.from;
  auto& [j0, j1, j2] = t.to;
  for (i0 = 0; i0 < na; ++i0) {
    for (i1 = i0 + 1; i1 < na; ++i1) {
      for (j0 = 0; j0 < nb; ++j0) {
        for (j1 = 0; j1 < nb; ++j1) {
          if (j1 == j0 || !std::isfinite(costs(i0, j0) + costs(i1, j1))) continue;
          const double side = mismatch(i0, i1, j0, j1);
          if (!(side < kDistanceRatio)) continue;
          for (i2 = i1 + 1; i2 < na; ++i2) {
            for (j2 = 0; j2 < nb; ++j2) {
              if (j2 == j0 || j2 == j1 || !std::isfinite(costs(i2, j2))) continue;
              const double left = mismatch(i0, i2, j0, j2), right = mismatch(i1, i2, j1, j2);
              if (!(left < kDistanceRatio) || !(right < kDistanceRatio)) continue;
              // Wide triplets tell more.
              const double width = std::min({da(i0, i1), da(i0, i2), da(i1, i2)});
              t.cost = (side + left + right + costs(i0, j0) + costs(i1, j1) + costs(i2, j2)) /
                       (width + 0.3);
              found.push_back(t);
            }
          }
        }
      }
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Triplet& x, const Triplet& y) { return x.cost < y.cost; });
  if (found.size() > most) found.resize(most);
  return found;
}

/// Columns by which samples are compared before there is a functional map.
MatrixXd placesBy(const SpectralSurface& surface, const std::array<std::size_t, 3>& features) {
  const auto& vertices = surface.coarse.vertices;
  MatrixXd places(4, vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    for (int c = 0; c < 3; ++c) {
      places(c, column) =
          surface.from_features(vertices[i], static_cast<Eigen::Index>(features[c]));
    }
    places(3, column) = surface.centrality[vertices[i]];
  }
  return places;
}

/// Nearest samples of both under distances to three features and the centrality.
SampleMaps startOf(const SpectralSurface& a, const SpectralSurface& b, const Triplet& triplet) {
  const SampledModes x = {placesBy(a, triplet.from), {}}, y = {placesBy(b, triplet.to), {}};
  return nearestSamples(x, y, MatrixXd::Identity(4, 4));
}

/// A map between the samples and how good it is.
struct Candidate {
  SampleMaps maps;
  MatrixXd functional;
  double defect = 0, orientation = 0;
  double turned = 0;  ///< The orientation, as it is wanted.
};

bool better(const Candidate& x, const Candidate& y) {
  return x.defect < y.defect;
}

class Aligner {
 public:
  Aligner(Context& context, const SpectralSurface& a, const SpectralSurface& b,
          const SpectralMatchOptions& options)
      : context_(context),
        a_(a),
        b_(b),
        options_(options),
        modes_(std::min(a.values.size(), b.values.size())),
        coarse_(std::min(kCoarseModes, modes_)),
        middle_(std::min(kMiddleModes, modes_)),
        orientation_(a, b, coarse_) {}

  Result<std::vector<Candidate>> coarseCandidates() {
    const Context::Stage stage(context_, "align");
    const SampledModes x = sampleModes(a_, a_.coarse), y = sampleModes(b_, b_.coarse);
    const std::vector<SampleMaps> starts = allStarts(x, y);
    std::vector<Candidate> found;
    for (Eigen::Index k = std::min(kFirstModes.front(), coarse_); k <= coarse_; ++k) {
      if (std::find(kFirstModes.begin(), kFirstModes.end(), k) != kFirstModes.end()) {
        for (const SampleMaps& start : starts) found.push_back(Candidate{start, {}, 0, 0});
      }
      const bool look = std::find(kLooks.begin(), kLooks.end(), k) != kLooks.end();
      parallelBlocks(found.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && context_.check().ok(); ++i) {
          refine(x, y, k, found[i]);
          if (look || k == coarse_) judge(found[i]);
        }
      });
      RETURN_IF_ERROR(context_.check());
      if (look) std::erase_if(found, [](const Candidate& c) { return c.turned < -kLeastTurned; });
      if (look && (k / 2) % 2 == 0) found = different(std::move(found), y, k, kContenders);
    }
    std::erase_if(found, [](const Candidate& c) { return !(c.turned > kLeastTurned); });
    return different(std::move(found), y, coarse_, options_.finalists);
  }

  /// On the fine samples, to the middle modes.
  Result<std::vector<SpectralMatch>> finish(std::vector<Candidate> maps) {
    const Context::Stage stage(context_, "refine");
    const SampledModes x = sampleModes(a_, a_.fine), y = sampleModes(b_, b_.fine);
    for (Eigen::Index k = coarse_;; k = std::min(k + kFineStep, middle_)) {
      parallelBlocks(maps.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && context_.check().ok(); ++i) {
          maps[i].maps = nearestSamples(x, y, maps[i].functional);
          maps[i].functional = fitFunctionalMap(x, y, maps[i].maps, k);
          maps[i].defect = orthogonalityDefect(maps[i].functional);
        }
      });
      RETURN_IF_ERROR(context_.check());
      std::stable_sort(maps.begin(), maps.end(), better);
      if (k == middle_) break;
      if (2 * k >= middle_) {
        const double least = maps.empty() ? 0 : maps.front().defect;
        const double most = std::max(kHopeless * least, options_.enough);
        std::erase_if(maps, [most](const Candidate& c) { return c.defect > most; });
      }
    }
    std::vector<SpectralMatch> matches;
    for (Candidate& map : maps) {
      matches.push_back({std::move(map.functional), map.defect, map.orientation});
    }
    return matches;
  }

 private:
  static void refine(const SampledModes& x, const SampledModes& y, Eigen::Index k,
                     Candidate& candidate) {
    candidate.functional = fitFunctionalMap(x, y, candidate.maps, k);
    candidate.maps = nearestSamples(x, y, candidate.functional);
  }

  void judge(Candidate& candidate) const {
    candidate.defect = orthogonalityDefect(candidate.functional);
    candidate.orientation = orientation_(candidate.functional, candidate.maps);
    candidate.turned = options_.mirror ? -candidate.orientation : candidate.orientation;
  }

  std::vector<SampleMaps> allStarts(const SampledModes& x, const SampledModes& y) const {
    std::vector<SampleMaps> starts;
    for (const Triplet& triplet : likelyTriplets(a_, b_, options_.triplets)) {
      starts.push_back(startOf(a_, b_, triplet));
    }
    const Eigen::Index signed_modes = std::min(kSignedModes, modes_);
    for (int signs = 0; signs < 1 << (signed_modes - 1); ++signs) {
      MatrixXd functional = MatrixXd::Identity(signed_modes, signed_modes);
      for (Eigen::Index k = 1; k < signed_modes; ++k) {
        if ((signs >> (k - 1) & 1) != 0) functional(k, k) = -1;
      }
      starts.push_back(nearestSamples(x, y, functional));
    }
    return starts;
  }

  /// Whether the mean squared distance of two maps' images is less than `most`, by the first k
  /// modes. The distance is the biharmonic one.
  bool isNear(const Candidate& p, const Candidate& q, const SampledModes& y, Eigen::Index k,
              double most) const {
    double sum = 0;
    for (std::size_t i = 0; i < p.maps.there.size() && sum < most; ++i) {
      if (p.maps.there[i] == q.maps.there[i]) continue;
      double squared = 0;
      const auto here = y.functions.col(p.maps.there[i]), there = y.functions.col(q.maps.there[i]);
      for (Eigen::Index m = 1; m < k; ++m) {
        const double gap = (here[m] - there[m]) / b_.values[m];
        squared += gap * gap;
      }
      sum += a_.coarse.weights[static_cast<Eigen::Index>(i)] * squared;
    }
    return sum < most;
  }

  /// The best maps of k modes, each far from all better ones; best first.
  std::vector<Candidate> different(std::vector<Candidate> maps, const SampledModes& y,
                                   Eigen::Index k, std::size_t most) const {
    std::stable_sort(maps.begin(), maps.end(), better);
    // Mean over all pairs of points: each function has mean square 1.
    const double mean = 2 * b_.values.segment(1, k - 1).cwiseAbs2().cwiseInverse().sum();
    std::vector<Candidate> kept;
    for (Candidate& map : maps) {
      if (kept.size() == most) break;
      const bool known = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
        return isNear(map, other, y, k, kDifferent * kDifferent * mean);
      });
      if (!known) kept.push_back(std::move(map));
    }
    return kept;
  }

  Context& context_;
  const SpectralSurface& a_;
  const SpectralSurface& b_;
  const SpectralMatchOptions& options_;
  Eigen::Index modes_, coarse_, middle_;
  OrientationTest orientation_;
};

}  // namespace

Result<std::vector<SpectralMatch>> matchSpectra(Context& context, const SpectralSurface& a,
                                                const SpectralSurface& b,
                                                const SpectralMatchOptions& options) {
  Aligner aligner(context, a, b, options);
  ASSIGN_OR_RETURN(std::vector<Candidate> candidates, aligner.coarseCandidates());
  ASSIGN_OR_RETURN(std::vector<SpectralMatch> matches, aligner.finish(std::move(candidates)));
  if (!matches.empty()) {
    ASSIGN_OR_RETURN(matches.front(), withAllModes(context, a, b, std::move(matches.front())));
  }
  return matches;
}

Result<SpectralMatch> withAllModes(Context& context, const SpectralSurface& a,
                                   const SpectralSurface& b, SpectralMatch match) {
  const Context::Stage stage(context, "refine");
  const Eigen::Index modes = std::min(a.values.size(), b.values.size());
  const Eigen::Index has = match.functional.rows();
  if (has >= modes) return match;
  const SampledModes x = sampleModes(a, a.fine), y = sampleModes(b, b.fine);
  for (Eigen::Index k = has; k < modes;) {
    RETURN_IF_ERROR(context.check());
    k = std::min(k + kFineStep, modes);
    const SampleMaps maps = nearestSamples(x, y, match.functional);
    match.functional = fitFunctionalMap(x, y, maps, k);
  }
  return match;
}

}  // namespace moduli
