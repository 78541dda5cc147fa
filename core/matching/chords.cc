#include "core/matching/chords.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

namespace moduli {
namespace {

/// The middles of a face's sides, kNone where a side is whole, and its corners.
struct CutFace {
  Triangle corners;
  std::array<Index, 3> middles;  ///< Of the sides from corner c to the next.
};

void addParts(const CutFace& face, std::vector<Triangle>& parts) {
  const auto& [corners, middles] = face;
  const auto cuts =
      std::count_if(middles.begin(), middles.end(), [](Index m) { return m != kNone; });
  if (cuts == 0) {
    parts.push_back(corners);
    return;
  }
  if (cuts == 3) {
    for (int c = 0; c < 3; ++c) {
      parts.push_back({corners[c], middles[c], middles[(c + 2) % 3]});
    }
    parts.push_back({middles[0], middles[1], middles[2]});
    return;
  }
  // From a cut side whose last one is whole: both other corners see its middle.
  int first = 0;
  while (middles[first] == kNone || middles[(first + 2) % 3] != kNone) ++first;
  const Index a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
  const Index middle = middles[first], next = middles[(first + 1) % 3];
  parts.push_back({a, middle, c});
  if (next == kNone) {
    parts.push_back({middle, b, c});
  } else {
    parts.push_back({middle, b, next});
    parts.push_back({middle, next, c});
  }
}

}  // namespace

SurfacePoint ChordFreeMesh::onSurface(const SurfacePoint& point) const {
  const Index face = source[point.face];
  SurfacePoint result{face, {0, 0, 0}};
  const auto add = [&](Index vertex, double weight) {
    for (int c = 0; c < 3; ++c) {
      if (surface_faces[face][c] == vertex) result.barycentric[c] += weight;
    }
  };
  const auto given = mesh.vertexCount() - static_cast<Index>(ends.size());
  for (int c = 0; c < 3; ++c) {
    const Index v = mesh.connectivity().face(point.face)[c];
    if (v < given) {
      add(v, point.barycentric[c]);
      continue;
    }
    for (const Index end : ends[v - given]) add(end, point.barycentric[c] / 2);
  }
  return result;
}

SurfacePoint ChordFreeMesh::fromSurface(const SurfacePoint& point) const {
  const auto given = mesh.vertexCount() - static_cast<Index>(ends.size());
  SurfacePoint best;
  double least = -2;
  for (Index f = first_part[point.face]; f < first_part[point.face + 1]; ++f) {
    // The part's corners in the weights of the face: the point's weights in the part solve them.
    Eigen::Matrix3d corners = Eigen::Matrix3d::Zero();
    for (int c = 0; c < 3; ++c) {
      const Index v = mesh.connectivity().face(f)[c];
      for (int k = 0; k < 3; ++k) {
        const Index corner = surface_faces[point.face][k];
        if (v < given) {
          corners(k, c) = v == corner ? 1 : 0;
        } else if (ends[v - given][0] == corner || ends[v - given][1] == corner) {
          corners(k, c) = 0.5;
        }
      }
    }
    const Eigen::Vector3d wanted(point.barycentric[0], point.barycentric[1], point.barycentric[2]);
    const Eigen::Vector3d weights = corners.inverse() * wanted;
    if (!(weights.minCoeff() > least)) continue;
    least = weights.minCoeff();
    const Eigen::Vector3d inside = weights.cwiseMax(0.0) / weights.cwiseMax(0.0).sum();
    best = {f, {inside[0], inside[1], inside[2]}};
  }
  return best;
}

Result<ChordFreeMesh> splitChords(const TriangleMesh& surface) {
  const Connectivity& given = surface.connectivity();
  std::vector<Index> middle(given.edgeCount(), kNone);
  std::vector<std::array<Index, 2>> ends;
  TriangleSoup soup{surface.positions(), {}};
  for (Index e = 0; e < given.edgeCount(); ++e) {
    const Index h = given.halfedge(e), a = given.tail(h), b = given.head(h);
    if (given.isBoundaryEdge(e) || !given.isBoundaryVertex(a) || !given.isBoundaryVertex(b))
      continue;
    middle[e] = static_cast<Index>(soup.vertices.size());
    ends.push_back({a, b});
    soup.vertices.push_back((surface.positions()[a] + surface.positions()[b]) / 2);
  }
  std::vector<Index> source, first_part;
  for (Index f = 0; f < given.faceCount(); ++f) {
    first_part.push_back(static_cast<Index>(soup.faces.size()));
    CutFace face{given.face(f), {}};
    for (int c = 0; c < 3; ++c) face.middles[c] = middle[given.edge(3 * f + c)];
    addParts(face, soup.faces);
    source.resize(soup.faces.size(), f);
  }
  first_part.push_back(static_cast<Index>(soup.faces.size()));
  ASSIGN_OR_RETURN(TriangleMesh mesh, TriangleMesh::fromSoup(std::move(soup)));
  return ChordFreeMesh{std::move(mesh), std::move(source), given.faces(), std::move(ends),
                       std::move(first_part)};
}

}  // namespace moduli
