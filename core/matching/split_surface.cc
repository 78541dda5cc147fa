#include "core/matching/split_surface.h"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

namespace moduli {
namespace {

using Weights = std::array<double, 3>;

/// Weights below are none: the point is on an edge or a vertex.
constexpr double kNothing = 1e-12;

Weights between(const Weights& a, const Weights& b, double t) {
  Weights result{};
  for (int c = 0; c < 3; ++c) result[c] = (1 - t) * a[c] + t * b[c];
  return result;
}

Weights combined(const std::array<Weights, 3>& corners, const Weights& weights) {
  Weights result{};
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 3; ++k) result[k] += weights[c] * corners[c][k];
  }
  return result;
}

}  // namespace

Result<SplitSurface> SplitSurface::make(const TriangleMesh& mesh,
                                        const std::vector<SurfacePoint>& points) {
  SplitSurface result;
  result.positions_ = mesh.positions();
  result.splitChords(mesh);
  for (const SurfacePoint& point : points) result.vertices_.push_back(result.insert(point));
  result.collectParts();
  std::vector<Triangle> faces;
  for (const Part& part : result.parts_) faces.push_back(part.face);
  ASSIGN_OR_RETURN(TriangleMesh split, TriangleMesh::fromSoup({result.positions_, faces}));
  result.mesh_.emplace(std::move(split));
  return result;
}

/// Edges inside between vertices of the boundary at their middles; a lone triangle at its centre.
void SplitSurface::splitChords(const TriangleMesh& mesh) {
  const Connectivity& surface = mesh.connectivity();
  std::vector<Index> middle(surface.edgeCount(), kNone);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e), v = surface.tail(h), w = surface.head(h);
    if (surface.isBoundaryEdge(e) || !surface.isBoundaryVertex(v) || !surface.isBoundaryVertex(w)) {
      continue;
    }
    middle[e] = static_cast<Index>(positions_.size());
    positions_.emplace_back((mesh.positions()[v] + mesh.positions()[w]) / 2);
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    std::array<Index, 3> middles{};
    for (int c = 0; c < 3; ++c) middles[c] = middle[surface.edge(3 * f + c)];
    addPart({surface.face(f), f}, middles);
  }
  collectParts();
  if (surface.faceCount() == 1) insert({0, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
}

/// middles: of the edges from each corner to the next; kNone where they stay whole.
void SplitSurface::addPart(const Part& part, std::array<Index, 3> middles) {
  const auto first =
      std::find_if(middles.begin(), middles.end(), [](Index v) { return v != kNone; });
  if (first == middles.end()) {
    parts_.push_back(part);
    return;
  }
  const auto c = static_cast<std::size_t>(first - middles.begin()), n = (c + 1) % 3,
             p = (c + 2) % 3;
  const Index v = *first;
  const Weights at = between(part.corners[c], part.corners[n], 0.5);
  addPart({{part.face[c], v, part.face[p]}, part.whole, {part.corners[c], at, part.corners[p]}},
          {kNone, kNone, middles[p]});
  addPart({{v, part.face[n], part.face[p]}, part.whole, {at, part.corners[n], part.corners[p]}},
          {kNone, middles[n], kNone});
}

void SplitSurface::collectParts() {
  Index count = 0;
  for (const Part& part : parts_) count = std::max(count, part.whole + 1);
  parts_of_.assign(count, {});
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    parts_of_[parts_[i].whole].push_back(static_cast<Index>(i));
  }
}

std::array<double, 3> SplitSurface::weightsIn(const Part& part, const Weights& point) const {
  Eigen::Matrix3d corners;
  for (int c = 0; c < 3; ++c) corners.col(c) = Eigen::Vector3d(part.corners[c].data());
  const Eigen::Vector3d weights = corners.inverse() * Eigen::Vector3d(point.data());
  return {weights[0], weights[1], weights[2]};
}

SurfacePoint SplitSurface::before(const SurfacePoint& point) const {
  const Part& part = parts_[point.face];
  return {part.whole, combined(part.corners, point.barycentric)};
}

SurfacePoint SplitSurface::after(const SurfacePoint& point) const {
  const std::vector<Index>& parts = parts_of_[point.face];
  if (parts.size() == 1) return {parts.front(), point.barycentric};
  SurfacePoint best{parts.front(), {1, 0, 0}};
  double clearest = -1e300;
  for (const Index i : parts) {
    const Weights weights = weightsIn(parts_[i], point.barycentric);
    const double least = *std::min_element(weights.begin(), weights.end());
    if (!(least > clearest)) continue;
    clearest = least;
    best = {i, weights};
  }
  double sum = 0;
  for (double& weight : best.barycentric) {
    weight = weight < kNothing ? 0 : weight;
    sum += weight;
  }
  for (double& weight : best.barycentric) weight /= sum;
  return best;
}

Index SplitSurface::insert(const SurfacePoint& point) {
  const SurfacePoint at = after(point);
  const Part part = parts_[at.face];
  std::vector<std::size_t> heavy;
  for (std::size_t c = 0; c < 3; ++c) {
    if (at.barycentric[c] > kNothing) heavy.push_back(c);
  }
  if (heavy.size() == 1) return part.face[heavy.front()];
  const auto v = static_cast<Index>(positions_.size());
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (std::size_t c = 0; c < 3; ++c) place += at.barycentric[c] * positions_[part.face[c]];
  positions_.push_back(place);
  if (heavy.size() == 2) {
    splitEdge(part.face[heavy[0]], part.face[heavy[1]], at.barycentric[heavy[1]], v);
  } else {
    const Weights inside = combined(part.corners, at.barycentric);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t n = (c + 1) % 3;
      const Part piece{
          {part.face[c], part.face[n], v}, part.whole, {part.corners[c], part.corners[n], inside}};
      if (c == 0) {
        parts_[at.face] = piece;
      } else {
        parts_.push_back(piece);
      }
    }
  }
  collectParts();
  return v;
}

/// On both of its sides. t: from tail to head.
void SplitSurface::splitEdge(Index tail, Index head, double t, Index vertex) {
  const std::size_t count = parts_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Part part = parts_[i];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t n = (c + 1) % 3, p = (c + 2) % 3;
      const bool along = part.face[c] == tail && part.face[n] == head;
      const bool back = part.face[c] == head && part.face[n] == tail;
      if (!along && !back) continue;
      const Weights at = between(part.corners[c], part.corners[n], along ? t : 1 - t);
      parts_[i] = {
          {part.face[c], vertex, part.face[p]}, part.whole, {part.corners[c], at, part.corners[p]}};
      parts_.push_back({{vertex, part.face[n], part.face[p]},
                        part.whole,
                        {at, part.corners[n], part.corners[p]}});
      break;
    }
  }
}

}  // namespace moduli
