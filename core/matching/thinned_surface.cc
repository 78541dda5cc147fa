#include "core/matching/thinned_surface.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/matching/map_report.h"
#include "core/matching/nearest_in_triangle.h"
#include "core/matching/thinning.h"
#include "core/mesh/triangle_geometry.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// Relative area of new faces, as triangleShape has it; 0.43 is that of an equilateral one. Maps of
/// thinner ones are easily stuck; more than this leaves many vertices that cannot go.
constexpr double kThinnest = 0.1;

/// The mesh that is left of a closed one.
Result<TriangleMesh> meshOf(const RingMesh& rings, const std::vector<Index>& vertices,
                            const std::vector<Vector3d>& positions) {
  std::vector<Index> number(positions.size(), kNone);
  TriangleSoup soup;
  for (const Index v : vertices) {
    number[v] = static_cast<Index>(soup.vertices.size());
    soup.vertices.push_back(positions[v]);
  }
  for (const Index v : vertices) {
    const std::vector<Index>& ring = rings.ring(v);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      if (v < a && v < b) soup.faces.push_back({number[v], number[a], number[b]});
    }
  }
  return TriangleMesh::fromSoup(std::move(soup));
}

/// Looks for nearest points of a surface near one of its vertices.
class SpaceFinder {
 public:
  explicit SpaceFinder(const TriangleMesh& mesh)
      : surface_(mesh.connectivity()), positions_(mesh.positions()) {}

  SurfacePoint find(const Vector3d& place, Index from) const {
    const Index vertex = descend(place, from);
    SurfacePoint nearest;
    double best = std::numeric_limits<double>::infinity();
    around(vertex, [&](Index h) {
      const auto& [i, j, k] = surface_.face(h / 3);
      const auto weights = nearestInTriangle(place, positions_[i], positions_[j], positions_[k]);
      const SurfacePoint point = {h / 3, weights};
      const double distance = (spacePoint(surface_, positions_, point) - place).squaredNorm();
      if (!(distance < best)) return;
      best = distance;
      nearest = point;
    });
    return nearest;
  }

 private:
  Index descend(const Vector3d& place, Index from) const {
    double best = (positions_[from] - place).squaredNorm();
    for (Index at = from;; from = at) {
      around(from, [&](Index h) {
        const Index other = surface_.head(h);
        const double distance = (positions_[other] - place).squaredNorm();
        if (!(distance < best)) return;
        best = distance;
        at = other;
      });
      if (at == from) return at;
    }
  }

  /// Calls visit for all halfedges from a vertex.
  template <typename Visit>
  void around(Index v, const Visit& visit) const {
    const Index first = surface_.outgoing(v);
    Index h = first;
    do {
      visit(h);
      h = surface_.rotate(h);
    } while (h != kNone && h != first);
  }

  const Connectivity& surface_;
  const std::vector<Vector3d>& positions_;
};

}  // namespace

Result<ThinnedSurface> thinSurface(Context& context, const TriangleMesh& mesh, Index wanted) {
  ASSIGN_OR_RETURN(RingMesh rings, RingMesh::make(mesh.connectivity()));
  const std::vector<char> all(mesh.positions().size(), 1);
  const FaceRule well_shaped = [&](Index a, Index b, Index c) {
    const auto& p = mesh.positions();
    return triangleShape(p[a], p[b], p[c]).relative_area >= kThinnest;
  };
  RETURN_IF_ERROR(thinEvenly(context, rings, mesh.positions(), all, well_shaped, wanted));
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (rings.isPresent(v)) vertices.push_back(v);
  }
  ASSIGN_OR_RETURN(TriangleMesh thinned, meshOf(rings, vertices, mesh.positions()));
  return ThinnedSurface{std::move(rings), std::move(thinned), std::move(vertices)};
}

std::vector<double> gathered(const TriangleMesh& whole, const ThinnedSurface& thinned,
                             std::vector<double> values) {
  const auto& positions = whole.positions();
  std::vector<double> shares;
  for (const RingMesh::Collapse& collapse : thinned.rings.collapses()) {
    const Index v = collapse.removed;
    const std::vector<Index>& ring = thinned.rings.ring(v);
    shares.clear();
    double sum = 0;
    for (const Index w : ring) {
      const double length = (positions[w] - positions[v]).norm();
      shares.push_back(1 / std::max(length, std::numeric_limits<double>::min()));
      sum += shares.back();
    }
    for (std::size_t i = 0; i < ring.size(); ++i) values[ring[i]] += values[v] * shares[i] / sum;
    values[v] = 0;
  }
  std::vector<double> result;
  result.reserve(thinned.vertices.size());
  for (const Index v : thinned.vertices) result.push_back(values[v]);
  return result;
}

std::vector<SurfacePoint> onWhole(const TriangleMesh& whole, const ThinnedSurface& thinned,
                                  const std::vector<SurfacePoint>& points) {
  const SpaceFinder finder(whole);
  std::vector<SurfacePoint> found;
  found.reserve(points.size());
  for (const SurfacePoint& point : points) {
    const Connectivity& surface = thinned.mesh.connectivity();
    const auto heaviest = std::max_element(point.barycentric.begin(), point.barycentric.end()) -
                          point.barycentric.begin();
    const Vector3d place = spacePoint(surface, thinned.mesh.positions(), point);
    found.push_back(finder.find(place, thinned.vertices[surface.face(point.face)[heaviest]]));
  }
  return found;
}

}  // namespace moduli
