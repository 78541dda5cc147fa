#include "core/parameterize/straighten.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/intrinsic/overlay.h"

namespace moduli {
namespace {

Complex onAxis(double length) {
  return std::tanh(length / 2);
}

/// As planeTriangleQuality, of the geodesic triangle: seen from its first corner.
double diskTriangleQuality(Complex a, Complex b, Complex c) {
  const Su11 back = inverse(translationTo(a));
  const Complex p = imageOf(back, b), q = imageOf(back, c);
  const double longest = std::max({std::norm(p), std::norm(q), std::norm(q - p)});
  return longest > 0 ? std::imag(std::conj(p) * q) / longest : 0;
}

/// Where new vertices on a given edge lie, in the frame of the straight edge between its ends.
class BentEdges {
 public:
  BentEdges(const Overlay& overlay, const DiscreteMetric& metric)
      : overlay_(overlay),
        triangles_{metric.triangulation.connectivity(), {}, metric.angles},
        u_(metric.u) {
    for (const double x : metric.half_chords) {
      triangles_.lengths.push_back(lengthOfHalfChord(Geometry::kHyperbolic, x));
    }
  }

  /// Per crossing of a given edge.
  std::vector<Complex> points(Index edge) const {
    const std::vector<Crossing>& crossings = overlay_.crossings(edge);
    std::vector<Complex> points;
    if (crossings.empty()) return points;
    // From the coordinates of the face that the edge is in to those of its first one.
    Su11 frame;
    const Complex tail = opposite(crossings.front().halfedge);
    for (const Crossing& crossing : crossings) {
      const Index h = crossing.halfedge;
      points.push_back(imageOf(frame * cornerFrame(triangles_, h), onAxis(wayAlong(crossing))));
      frame = renormalized(frame * across(h));
    }
    const Complex head =
        imageOf(frame, opposite(triangles_.surface.twin(crossings.back().halfedge)));
    const Su11 back = inverse(edgeFrame(tail, head));
    for (Complex& point : points) point = imageOf(back, point);
    return points;
  }

 private:
  /// The corner of its face that faces a halfedge.
  Complex opposite(Index h) const {
    return imageOf(cornerFrame(triangles_, Connectivity::previous(h)), 0.0);
  }

  Su11 across(Index h) const {
    return cornerFrame(triangles_, h) * edgeHalfTurn(triangles_.lengths[h]) *
           inverse(cornerFrame(triangles_, triangles_.surface.twin(h)));
  }

  /// Where the weighted sum of an edge's ends lies on it.
  double wayAlong(const Crossing& crossing) const {
    const Index h = crossing.halfedge;
    const double tail = crossing.weight_tail, length = triangles_.lengths[h];
    const double head = crossing.weight_head *
                        std::exp(u_[triangles_.surface.tail(h)] - u_[triangles_.surface.head(h)]);
    return std::atanh(head * std::sinh(length) / (tail + head * std::cosh(length)));
  }

  const Overlay& overlay_;
  HyperbolicTriangles triangles_;
  const std::vector<double>& u_;
};

/// Of the faces of a double the first copy; of another surface all.
HyperbolicTriangles firstCopy(const Connectivity& surface, const std::vector<double>& lengths,
                              const std::vector<double>& angles) {
  const auto count = static_cast<std::ptrdiff_t>(surface.halfedgeCount());
  return {surface,
          {lengths.begin(), lengths.begin() + count},
          {angles.begin(), angles.begin() + count}};
}

/// Given faces and their pieces in the disk, one given face at a time.
class Pieces {
 public:
  /// lengths, angles: per halfedge of `given`, as StraightFaces.
  Pieces(const Connectivity& given, const std::vector<double>& lengths,
         const std::vector<double>& angles)
      : given_(given), lengths_(lengths), angles_(angles), on_edge_(given.edgeCount()) {}

  /// The next new vertex: on an edge, in the frame of the straight edge between its ends.
  void add(Index edge, Complex point) { on_edge_[edge].push_back({next_vertex_++, point}); }
  bool isCut(Index edge) const { return !on_edge_[edge].empty(); }

  /// Puts a given face and what its sides bear into the disk, corner 0 at 0.
  void enter(Index face) {
    const Index h = 3 * face;
    face_ = face;
    corners_ = {0.0, onAxis(lengths_[h]), std::polar(std::tanh(lengths_[h + 2] / 2), angles_[h])};
    side_points_.clear();
    for (int c = 0; c < 3; ++c) {
      const Complex p = corners_[c], q = corners_[(c + 1) % 3];
      const Su11 frame = given_.sign(h + c) > 0 ? edgeFrame(p, q) : edgeFrame(q, p);
      for (const NewVertex& vertex : on_edge_[given_.edge(h + c)]) {
        side_points_.push_back({vertex.number, imageOf(frame, vertex.point)});
      }
    }
  }

  double quality(Index a, Index b, Index c) const {
    return diskTriangleQuality(place(a), place(b), place(c));
  }

  /// Of a subdivision of the first `surface` faces.
  Result<StraightSurface> collect(const Connectivity& surface, Subdivision subdivision) {
    const Index spare = given_.vertexCount() - surface.vertexCount();
    Index folded = 0;
    std::vector<double> lengths, angles;
    for (std::size_t f = 0; f < subdivision.faces.size(); ++f) {
      enter(subdivision.parent[f]);
      folded += appendTriangle(subdivision.faces[f], lengths, angles);
      for (Index& v : subdivision.faces[f]) {
        if (v >= given_.vertexCount()) v -= spare;
      }
    }
    const auto vertices = surface.vertexCount() + static_cast<Index>(subdivision.vertices.size());
    ASSIGN_OR_RETURN(Connectivity refined, Connectivity::fromFaces(vertices, subdivision.faces));
    // What both faces make of an edge differs by rounding.
    for (Index e = 0; e < refined.edgeCount(); ++e) {
      const Index h = refined.halfedge(e), twin = refined.twin(h);
      if (twin != kNone) lengths[twin] = lengths[h];
    }
    return StraightSurface{{std::move(refined), std::move(lengths), std::move(angles)},
                           std::move(subdivision),
                           folded,
                           WholeFaces{firstCopy(surface, lengths_, angles_), places()}};
  }

 private:
  struct NewVertex {
    Index number = 0;
    Complex point;
  };

  /// Of all new vertices, by their numbers.
  std::vector<Complex> places() const {
    std::vector<Complex> result(next_vertex_ - given_.vertexCount());
    for (const std::vector<NewVertex>& vertices : on_edge_) {
      for (const NewVertex& vertex : vertices) {
        result[vertex.number - given_.vertexCount()] = vertex.point;
      }
    }
    return result;
  }

  Complex place(Index v) const {
    for (int c = 0; c < 3; ++c) {
      if (given_.tail(3 * face_ + c) == v) return corners_[c];
    }
    for (const NewVertex& vertex : side_points_) {
      if (vertex.number == v) return vertex.point;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

  /// Whether it is folded.
  bool appendTriangle(const Triangle& face, std::vector<double>& lengths,
                      std::vector<double>& angles) const {
    const std::array<Complex, 3> corner = {place(face[0]), place(face[1]), place(face[2])};
    const bool folded = !(quality(face[0], face[1], face[2]) > 0);
    for (int c = 0; c < 3; ++c) {
      const Su11 back = inverse(translationTo(corner[c]));
      const Complex p = imageOf(back, corner[(c + 1) % 3]);
      const Complex q = imageOf(back, corner[(c + 2) % 3]);
      const double angle = std::abs(std::arg(q * std::conj(p)));
      lengths.push_back(hyperbolicDistance(corner[c], corner[(c + 1) % 3]));
      angles.push_back(folded ? -angle : angle);
    }
    return folded;
  }

  const Connectivity& given_;
  const std::vector<double>&lengths_, &angles_;
  std::vector<std::vector<NewVertex>> on_edge_;  ///< From the edge's own tail.
  Index next_vertex_ = given_.vertexCount();
  Index face_ = 0;
  std::array<Complex, 3> corners_;
  std::vector<NewVertex> side_points_;
};

/// The edges of a given surface with the new vertices that cut them, in their order.
class CutEdges {
 public:
  explicit CutEdges(const StraightSurface& surface)
      : triangles_(surface.whole ? surface.whole->triangles : surface.triangles),
        vertices_(triangles_.surface.edgeCount()) {
    for (Index e = 0; e < triangles_.surface.edgeCount(); ++e) {
      vertices_[e].push_back({{triangles_.surface.halfedge(e), 0, {}}, 0.0});
    }
    if (surface.subdivision) {
      for (std::size_t n = 0; n < surface.subdivision->vertices.size(); ++n) {
        const Subdivision::Vertex& vertex = surface.subdivision->vertices[n];
        vertices_[triangles_.surface.edge(vertex.halfedge)].push_back(
            {vertex, surface.whole->places[n]});
      }
    }
    for (Index e = 0; e < triangles_.surface.edgeCount(); ++e) {
      const Index h = triangles_.surface.halfedge(e);
      vertices_[e].push_back({{h, 1, {}}, onAxis(triangles_.lengths[h])});
    }
  }

  struct Point {
    Subdivision::Vertex vertex;
    Complex place;
  };

  const HyperbolicTriangles& triangles() const { return triangles_; }

  double longestPart(Index e) const {
    double longest = 0;
    for (std::size_t n = 1; n < vertices_[e].size(); ++n) {
      longest =
          std::max(longest, hyperbolicDistance(vertices_[e][n - 1].place, vertices_[e][n].place));
    }
    return longest;
  }

  /// With `count` more on each part of an edge; without its ends.
  std::vector<Point> inside(Index e, int count) const {
    std::vector<Point> points;
    for (std::size_t n = 1; n < vertices_[e].size(); ++n) {
      const Point &from = vertices_[e][n - 1], &to = vertices_[e][n];
      const Su11 frame = edgeFrame(from.place, to.place);
      const double length = hyperbolicDistance(from.place, to.place);
      if (n > 1) points.push_back(from);
      for (int k = 1; k <= count; ++k) {
        const double way = k / (count + 1.0);
        const double fraction =
            from.vertex.fraction + way * (to.vertex.fraction - from.vertex.fraction);
        points.push_back(
            {{from.vertex.halfedge, fraction, {}}, imageOf(frame, onAxis(way * length))});
      }
    }
    return points;
  }

 private:
  const HyperbolicTriangles& triangles_;
  std::vector<std::vector<Point>> vertices_;  ///< With the ends.
};

}  // namespace

StraightSurface straighten(const Connectivity& surface, const Uniformization& uniformization) {
  const StraightFaces faces = straightFaces(uniformization.metric);
  StraightSurface result{firstCopy(surface, faces.lengths, faces.angles)};
  for (Index f = 0; f < surface.faceCount(); ++f) result.folded += faces.isFolded(f);
  return result;
}

Result<StraightSurface> straightenRefined(Context& context, const Connectivity& surface,
                                          const Uniformization& uniformization) {
  const Context::Stage stage(context, "refine");
  RETURN_IF_ERROR(checkCuttable(surface, "the hyperbolic metric"));
  const DiscreteMetric& metric = uniformization.metric;
  const StraightFaces faces = straightFaces(metric);
  ASSIGN_OR_RETURN(const Overlay overlay, Overlay::make(context, metric.triangulation));
  const BentEdges bent(overlay, metric);
  Pieces pieces(faces.surface, faces.lengths, faces.angles);
  SubdivisionImage image;
  image.locate = [&](const Subdivision::Vertex& vertex) {
    // All vertices of an edge come in a row.
    const Index edge = faces.surface.edge(vertex.halfedge);
    if (pieces.isCut(edge)) return;
    for (const Complex& point : bent.points(edge)) pieces.add(edge, point);
  };
  image.enter = [&](Index face) { pieces.enter(face); };
  image.quality = [&](Index a, Index b, Index c) { return pieces.quality(a, b, c); };
  std::vector<bool> folded(faces.surface.faceCount(), false);
  for (Index f = 0; f < surface.faceCount(); ++f) folded[f] = faces.isFolded(f);
  ASSIGN_OR_RETURN(Subdivision subdivision,
                   subdivide(context, overlay, folded, surface.faceCount(), image));
  return pieces.collect(surface, std::move(subdivision));
}

Result<StraightSurface> splitStraight(const StraightSurface& surface,
                                      const std::vector<int>& counts) {
  const CutEdges edges(surface);
  const HyperbolicTriangles& triangles = edges.triangles();
  const Connectivity& given = triangles.surface;
  RETURN_IF_ERROR(checkCuttable(given, "the hyperbolic metric"));
  std::vector<Subdivision::Vertex> vertices;
  Pieces pieces(given, triangles.lengths, triangles.angles);
  for (Index e = 0; e < given.edgeCount(); ++e) {
    for (const CutEdges::Point& point : edges.inside(e, counts[e])) {
      vertices.push_back(point.vertex);
      pieces.add(e, point.place);
    }
  }
  SubdivisionImage image;
  image.enter = [&](Index face) { pieces.enter(face); };
  image.quality = [&](Index a, Index b, Index c) { return pieces.quality(a, b, c); };
  std::optional<Subdivision> subdivision = splitEdges(given, vertices, image);
  if (!subdivision) {
    return Status(Reason::kFoldedMap, "faces without area cannot be cut", "give a finer mesh");
  }
  return pieces.collect(given, *std::move(subdivision));
}

std::vector<double> longestParts(const StraightSurface& surface) {
  const CutEdges edges(surface);
  std::vector<double> longest;
  for (Index e = 0; e < edges.triangles().surface.edgeCount(); ++e) {
    longest.push_back(edges.longestPart(e));
  }
  return longest;
}

}  // namespace moduli
