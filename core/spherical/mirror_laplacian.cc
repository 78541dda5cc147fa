#include "core/spherical/mirror_laplacian.h"

#include <algorithm>
#include <utility>

#include "core/mesh/double_cover.h"
#include "core/spherical/delaunay_weights.h"

namespace moduli::spherical {

Result<MirrorLaplacian> MirrorLaplacian::make(Context& context, const Connectivity& surface,
                                              const std::vector<double>& lengths) {
  ASSIGN_OR_RETURN(const DoubleCover cover, doubleCover(surface));
  std::vector<double> doubled(cover.edge.size());
  for (std::size_t e = 0; e < doubled.size(); ++e) doubled[e] = lengths[cover.edge[e]];
  ASSIGN_OR_RETURN(const WeightedSurface metric,
                   delaunayWeights(context, cover.connectivity, doubled));

  MirrorLaplacian result;
  result.flips_ = metric.flips;
  result.edges_.reserve(metric.weights.size());
  const Index count = surface.vertexCount();
  // The first copy keeps the surface's numbers; the boundary is on both sides.
  const auto original = [&](Index v) { return std::min(v, cover.involution[v]); };
  const auto side = [&](Index v) { return v >= count ? -1 : surface.isBoundaryVertex(v) ? 0 : 1; };
  for (Index e = 0; e < metric.surface.edgeCount(); ++e) {
    const Index h = metric.surface.halfedge(e);
    const Index a = metric.surface.tail(h), b = metric.surface.head(h);
    result.edges_.push_back(
        {original(a), original(b), metric.weights[e] / 2, side(a) * side(b) < 0});
  }
  return result;
}

Result<MirrorSystem> MirrorSystem::make(Context& context, const MirrorLaplacian& laplacian,
                                        Parity parity, const std::vector<bool>& moves) {
  std::vector<Index> row(moves.size(), kNone), moving;
  for (std::size_t v = 0; v < moves.size(); ++v) {
    if (!moves[v]) continue;
    row[v] = static_cast<Index>(moving.size());
    moving.push_back(static_cast<Index>(v));
  }
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> diagonal(moving.size(), 0.0);
  std::vector<Pull> pulls;
  for (const MirrorLaplacian::Edge& e : laplacian.edges()) {
    // Energy weight / 2 (x_tail - sign x_head)^2.
    const double sign = parity == Parity::kOdd && e.crosses ? -1 : 1;
    const Index a = row[e.tail], b = row[e.head];
    if (e.tail == e.head) {
      if (sign < 0 && a != kNone) diagonal[a] += 4 * e.weight;
      continue;
    }
    if (a != kNone) diagonal[a] += e.weight;
    if (b != kNone) diagonal[b] += e.weight;
    if (a != kNone && b != kNone) {
      entries.emplace_back(std::max(a, b), std::min(a, b), -sign * e.weight);
    } else if (a != kNone) {
      pulls.push_back({a, e.head, sign * e.weight});
    } else if (b != kNone) {
      pulls.push_back({b, e.tail, sign * e.weight});
    }
  }
  const auto size = static_cast<Index>(moving.size());
  for (Index i = 0; i < size; ++i) entries.emplace_back(i, i, diagonal[i]);
  SparseMatrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, matrix));
  return MirrorSystem(std::move(moving), std::move(pulls), std::move(solver));
}

Result<std::vector<double>> MirrorSystem::solve(Context& context, std::vector<double> values,
                                                const std::vector<double>& source) const {
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(moving_.size()), 1);
  for (const Pull& pull : pulls_) b(pull.row, 0) += pull.weight * values[pull.held];
  if (!source.empty()) {
    for (std::size_t i = 0; i < moving_.size(); ++i) {
      b(static_cast<Eigen::Index>(i), 0) += source[moving_[i]];
    }
  }
  ASSIGN_OR_RETURN(const Eigen::MatrixXd x, solver_.solve(context, b));
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    values[moving_[i]] = x(static_cast<Eigen::Index>(i), 0);
  }
  return values;
}

}  // namespace moduli::spherical
