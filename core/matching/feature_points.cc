#include "core/matching/feature_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace moduli {
namespace {

constexpr double kAlone = 0.25;  // Within this distance nothing is larger.
constexpr double kApart = 0.15;  // Features are no nearer than this.
constexpr std::size_t kMost = 12;

/// The heat kernel signature at one time.
Eigen::VectorXd heatKernel(const Eigen::VectorXd& values, const Eigen::MatrixXd& functions,
                           double time) {
  const Eigen::VectorXd decay = (-time * values.array()).exp();
  return functions.cwiseAbs2() * decay;
}

bool isLocalMaximum(const EdgeGraph& graph, const Eigen::VectorXd& field, Index v) {
  for (const auto& [u, length] : graph.neighbours(v)) {
    if (field[u] > field[v]) return false;
  }
  const auto near = graph.within(v, kAlone);
  return std::none_of(near.begin(), near.end(),
                      [&](const auto& other) { return field[other.first] > field[v]; });
}

std::vector<Index> maxima(const EdgeGraph& graph, const Eigen::VectorXd& field) {
  std::vector<Index> found;
  for (Index v = 0; v < graph.vertexCount(); ++v) {
    if (isLocalMaximum(graph, field, v)) found.push_back(v);
  }
  std::stable_sort(found.begin(), found.end(),
                   [&](Index a, Index b) { return field[a] > field[b]; });
  return found;
}

}  // namespace

Eigen::VectorXd biharmonicCentrality(const Eigen::VectorXd& values,
                                     const Eigen::MatrixXd& functions,
                                     const std::vector<double>& areas) {
  const Eigen::Index modes = values.size() - 1;
  const Eigen::VectorXd weight = values.tail(modes).cwiseAbs2().cwiseInverse();
  const Eigen::VectorXd own = functions.rightCols(modes).cwiseAbs2() * weight;
  Eigen::VectorXd root = (own.array() + weight.sum()).sqrt();
  const Eigen::Map<const Eigen::VectorXd> shares(areas.data(), root.size());
  return root / root.dot(shares);
}

std::vector<Index> featurePoints(const EdgeGraph& graph, const Eigen::VectorXd& centrality,
                                 const Eigen::VectorXd& values, const Eigen::MatrixXd& functions) {
  std::vector<Index> candidates = maxima(graph, centrality);
  // Two times between that of the lowest and that of the highest mode.
  const double ratio = values[1] / values[values.size() - 1];
  for (const double part : {2.0 / 7, 4.0 / 7}) {
    const double time = 4 * std::log(10.0) / values[values.size() - 1] * std::pow(1 / ratio, part);
    const std::vector<Index> more = maxima(graph, heatKernel(values, functions, time));
    candidates.insert(candidates.end(), more.begin(), more.end());
  }
  std::vector<Index> kept;
  std::vector<char> taken(static_cast<std::size_t>(graph.vertexCount()), 0);
  for (const Index v : candidates) {
    if (kept.size() == kMost) break;
    if (taken[v] != 0) continue;
    kept.push_back(v);
    for (const auto& [u, distance] : graph.within(v, kApart)) taken[u] = 1;
  }
  return kept;
}

}  // namespace moduli
