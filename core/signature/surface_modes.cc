#include "core/signature/surface_modes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/forms/cotan.h"
#include "core/intrinsic/refine.h"
#include "core/linalg/generalized_eigen.h"

namespace moduli {
namespace {

constexpr double kShift = 4 * std::numbers::pi;
constexpr double kTolerance = 1e-8;
/// Cutting triangulations of needles costs no more than surfaces of this size do.
constexpr Index kMostAdded = 40000;
/// Where the taper starts, as a part of the last value.
constexpr double kTaperStart = 0.75;
/// Of log value.
constexpr double kNearby = 0.03;
constexpr double kFarWeight = 1e-3;

/// x^T (lumped - halfway mass) x / value of every pair but the first: h^2 / 16 on equilateral faces
/// with sides h. face_areas: sum 1.
Eigen::VectorXd lumpingLosses(const Connectivity& surface, const std::vector<double>& face_areas,
                              const EigenPairs& pairs) {
  Eigen::VectorXd losses = Eigen::VectorXd::Zero(pairs.values.size() - 1);
  for (Eigen::Index k = 0; k < losses.size(); ++k) {
    const auto x = pairs.vectors.col(k + 1);
    double sum = 0;
    for (Index f = 0; f < surface.faceCount(); ++f) {
      const auto& [a, b, c] = surface.face(f);
      const double ab = x[a] - x[b], bc = x[b] - x[c], ca = x[c] - x[a];
      sum += face_areas[f] / 24 * (ab * ab + bc * bc + ca * ca);
    }
    losses[k] = sum / std::max(pairs.values[k + 1], kTolerance);
  }
  return losses;
}

/// Means over pairs of nearly the same value: alike for all of a multiplet, and blind to where the
/// list ends.
Eigen::VectorXd averageNearby(const Eigen::VectorXd& losses, const Eigen::VectorXd& values) {
  Eigen::VectorXd means(losses.size());
  for (Eigen::Index k = 0; k < means.size(); ++k) {
    double sum = 0, total = 0;
    for (Eigen::Index j = 0; j < losses.size(); ++j) {
      const double apart = std::log(values[j] / values[k]) / kNearby;
      // Far ones count a little, for the last ones have no other neighbours.
      const double weight = (std::exp(-apart * apart / 2) + kFarWeight) *
                            modeTaper(values[j], values[values.size() - 1]);
      sum += weight * losses[j];
      total += weight;
    }
    means[k] = total > 0 ? sum / total : 0;
  }
  return means;
}

/// By Weyl's law of the last mode, on a surface of this area.
double lastWavelength(double area) {
  return std::sqrt(std::numbers::pi * area / static_cast<double>(kModeCount));
}

/// face_areas: sum 1.
Result<SurfaceModes> modesOn(Context& context, const Connectivity& surface,
                             const std::vector<double>& lengths,
                             const std::vector<double>& face_areas) {
  SurfaceModes modes;
  const auto n = static_cast<Eigen::Index>(surface.vertexCount());
  modes.areas.assign(surface.vertexCount(), 0.0);
  for (Index f = 0; f < surface.faceCount(); ++f) {
    for (const Index v : surface.face(f)) modes.areas[v] += face_areas[f] / 3;
  }
  EigenOptions options;
  options.count = std::min<Eigen::Index>(kModeCount + 1, surface.vertexCount());
  options.shift = kShift;
  options.tolerance = kTolerance;
  ASSIGN_OR_RETURN(
      const EigenPairs pairs,
      smallestEigenpairs(context, stiffnessMatrix(surface, cotanWeights(surface, lengths)),
                         Eigen::Map<const Eigen::VectorXd>(modes.areas.data(), n), options));
  modes.largest_residual = pairs.largest_residual;
  const Context::Stage stage(context, "eigen");
  const Eigen::Index known = options.count - 1;
  modes.functions = Eigen::MatrixXd::Zero(n, kModeCount);
  modes.functions.leftCols(known) = pairs.vectors.rightCols(known);
  const Eigen::VectorXd raw = pairs.values.tail(known).cwiseMax(kTolerance);
  const Eigen::VectorXd loss = averageNearby(lumpingLosses(surface, face_areas, pairs), raw);
  modes.values.resize(kModeCount);
  double last = 0;
  for (Eigen::Index k = 0; k < kModeCount; ++k) {
    // Corrections must not exchange two values: the last one is that of the taper.
    last =
        k < known ? std::max(last, raw[k] * (1 + loss[k] * raw[k])) : last + 4 * std::numbers::pi;
    modes.values[k] = last;
  }
  return modes;
}

}  // namespace

Result<SurfaceModes> surfaceModes(Context& context, const Connectivity& surface,
                                  const std::vector<double>& lengths, double edges_per_wave) {
  std::vector<double> areas = faceAreas(surface, lengths);
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  RefineOptions options;
  options.longest = lastWavelength(total) / edges_per_wave;
  options.most_added = kMostAdded;
  const Result<RefinedSurface> finer = refineDelaunay(context, surface, lengths, options);
  if (!finer.ok() && finer.status().reason() != Reason::kNoConvergence) return finer.status();
  const Connectivity& used = finer.ok() ? finer->surface : surface;
  const std::vector<double>& used_lengths = finer.ok() ? finer->lengths : lengths;
  if (finer.ok()) areas = faceAreas(used, used_lengths);
  for (double& area : areas) area /= total;
  return modesOn(context, used, used_lengths, areas);
}

double modeTaper(double value, double last) {
  const double t = std::clamp((1 - value / last) / (1 - kTaperStart), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace moduli
