#include "core/matching/spectral_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
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
constexpr Eigen::Index kSignedModes = 5;   // The constant and four with both signs each.
constexpr double kLeastOrientation = 0.3;  // Of a map that is one.
constexpr double kDifferent = 0.1;         // Of the mean biharmonic distance.

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

std::vector<Eigen::Index> modesUpTo(Eigen::Index first, Eigen::Index last, Eigen::Index step) {
  std::vector<Eigen::Index> steps;
  for (Eigen::Index k = std::min(first, last); k < last; k += step) steps.push_back(k);
  steps.push_back(last);
  return steps;
}

/// A map between the samples and how good it is.
struct Candidate {
  SampleMaps maps;
  MatrixXd functional;
  double defect = 0, orientation = 0;
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
        orientation_(a, b, coarse_) {}

  Result<std::vector<Candidate>> coarseCandidates() {
    const Context::Stage stage(context_, "align");
    const SampledModes x = sampleModes(a_, a_.coarse), y = sampleModes(b_, b_.coarse);
    const std::vector<SampleMaps> starts = allStarts(x, y);
    const std::size_t jobs = starts.size() * kFirstModes.size();
    std::vector<std::optional<Candidate>> results(jobs);
    std::mutex mutex;
    Status failure;
    parallelBlocks(jobs, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t job = begin; job < end; ++job) {
        const Status status = refine(x, y, starts[job / kFirstModes.size()],
                                     kFirstModes[job % kFirstModes.size()], results[job]);
        if (status.ok()) continue;
        const std::lock_guard lock(mutex);
        failure = status;
        return;
      }
    });
    RETURN_IF_ERROR(failure);
    std::vector<Candidate> found;
    for (auto& result : results) {
      if (result) found.push_back(*std::move(result));
    }
    std::stable_sort(found.begin(), found.end(), better);
    return different(std::move(found), y);
  }

  /// On the fine samples, to the middle modes.
  Result<std::vector<SpectralMatch>> finish(const std::vector<Candidate>& candidates) {
    const Context::Stage stage(context_, "refine");
    const SampledModes x = sampleModes(a_, a_.fine), y = sampleModes(b_, b_.fine);
    std::vector<SpectralMatch> matches;
    std::vector<Result<SpectralMatch>> results(candidates.size(), SpectralMatch());
    parallelBlocks(candidates.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) results[i] = finish(x, y, candidates[i]);
    });
    for (auto& result : results) {
      ASSIGN_OR_RETURN(SpectralMatch match, std::move(result));
      matches.push_back(std::move(match));
    }
    std::stable_sort(matches.begin(), matches.end(),
                     [](const auto& p, const auto& q) { return p.defect < q.defect; });
    return matches;
  }

 private:
  Result<SpectralMatch> finish(const SampledModes& x, const SampledModes& y,
                               const Candidate& candidate) const {
    SampleMaps maps = nearestSamples(x, y, candidate.functional);
    SpectralMatch match;
    const Eigen::Index middle = std::min(kMiddleModes, modes_);
    ASSIGN_OR_RETURN(
        match.functional,
        refineFunctionalMap(context_, x, y, modesUpTo(coarse_, middle, kFineStep), maps));
    match.defect = orthogonalityDefect(match.functional);
    match.orientation = candidate.orientation;
    return match;
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

  Status refine(const SampledModes& x, const SampledModes& y, const SampleMaps& start,
                Eigen::Index first, std::optional<Candidate>& result) const {
    Candidate candidate;
    candidate.maps = start;
    ASSIGN_OR_RETURN(
        candidate.functional,
        refineFunctionalMap(context_, x, y, modesUpTo(first, coarse_, 1), candidate.maps));
    candidate.defect = orthogonalityDefect(candidate.functional);
    candidate.orientation = orientation_(candidate.functional, candidate.maps);
    const double turned = options_.mirror ? -candidate.orientation : candidate.orientation;
    if (turned > kLeastOrientation) result = std::move(candidate);
    return {};
  }

  /// Mean squared biharmonic distance of two maps' images.
  double apart(const Candidate& p, const Candidate& q, const SampledModes& y) const {
    double sum = 0;
    const VectorXd weights = b_.values.segment(1, coarse_ - 1).cwiseInverse();
    for (std::size_t i = 0; i < p.maps.there.size(); ++i) {
      if (p.maps.there[i] == q.maps.there[i]) continue;
      const VectorXd gap = y.functions.col(p.maps.there[i]).segment(1, coarse_ - 1) -
                           y.functions.col(q.maps.there[i]).segment(1, coarse_ - 1);
      sum +=
          a_.coarse.weights[static_cast<Eigen::Index>(i)] * gap.cwiseProduct(weights).squaredNorm();
    }
    return sum;
  }

  std::vector<Candidate> different(std::vector<Candidate> sorted, const SampledModes& y) const {
    // Mean over all pairs of points: each function has mean square 1.
    const double mean = 2 * b_.values.segment(1, coarse_ - 1).cwiseAbs2().cwiseInverse().sum();
    std::vector<Candidate> kept;
    for (Candidate& candidate : sorted) {
      if (kept.size() == options_.finalists) break;
      const bool known = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
        return apart(candidate, other, y) < kDifferent * kDifferent * mean;
      });
      if (!known) kept.push_back(std::move(candidate));
    }
    return kept;
  }

  Context& context_;
  const SpectralSurface& a_;
  const SpectralSurface& b_;
  const SpectralMatchOptions& options_;
  Eigen::Index modes_, coarse_;
  OrientationTest orientation_;
};

}  // namespace

Result<std::vector<SpectralMatch>> matchSpectra(Context& context, const SpectralSurface& a,
                                                const SpectralSurface& b,
                                                const SpectralMatchOptions& options) {
  Aligner aligner(context, a, b, options);
  ASSIGN_OR_RETURN(const std::vector<Candidate> candidates, aligner.coarseCandidates());
  ASSIGN_OR_RETURN(std::vector<SpectralMatch> matches, aligner.finish(candidates));
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
  SampleMaps maps = nearestSamples(x, y, match.functional);
  ASSIGN_OR_RETURN(match.functional,
                   refineFunctionalMap(context, x, y, modesUpTo(has, modes, kFineStep), maps));
  return match;
}

}  // namespace moduli
