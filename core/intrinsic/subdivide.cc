#include "core/intrinsic/subdivide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace moduli {
namespace {

/// A point of a face's boundary: its number, and the sides of the face that it is on.
struct Point {
  Index vertex = 0;
  int sides = 0;  ///< Bit c: on side c.
};
using Polygon = std::vector<Point>;

/// Cuts a convex polygon along chords that do not cross. Pairs of places in `polygon`.
void cut(const Polygon& polygon, const std::vector<Overlay::Chord>& chords,
         std::vector<Polygon>& cells) {
  if (chords.empty()) {
    cells.push_back(polygon);
    return;
  }
  const Index a = std::min(chords.back().from, chords.back().to);
  const Index b = std::max(chords.back().from, chords.back().to);
  const Index size = static_cast<Index>(polygon.size());
  Polygon inner(polygon.begin() + a, polygon.begin() + b + 1), outer;
  std::vector<Overlay::Chord> inner_chords, outer_chords;
  std::vector<Index> place(size, kNone);
  for (Index n = b;; n = (n + 1) % size) {
    place[n] = static_cast<Index>(outer.size());
    outer.push_back(polygon[n]);
    if (n == a) break;
  }
  for (std::size_t n = 0; n + 1 < chords.size(); ++n) {
    const Overlay::Chord& chord = chords[n];
    const auto within = [&](Index p) { return a <= p && p <= b; };
    if (within(chord.from) && within(chord.to)) {
      inner_chords.push_back({chord.from - a, chord.to - a});
    } else {
      outer_chords.push_back({place[chord.from], place[chord.to]});
    }
  }
  cut(inner, inner_chords, cells);
  cut(outer, outer_chords, cells);
}

/// Faces with new vertices on their sides.
class FaceCutter {
 public:
  FaceCutter(const Connectivity& given, const SubdivisionImage& image)
      : given_(given),
        image_(image),
        new_vertices_(given.edgeCount()),
        pieces_(given.faceCount()) {}

  bool isCut(Index e) const { return !new_vertices_[e].empty(); }

  /// Puts vertices on an edge, in the order from the tail of its halfedge.
  void insert(Index e, const std::vector<Subdivision::Vertex>& vertices) {
    for (const Subdivision::Vertex& vertex : vertices) {
      new_vertices_[e].push_back(given_.vertexCount() +
                                 static_cast<Index>(result_.vertices.size()));
      result_.vertices.push_back(vertex);
      if (image_.locate) image_.locate(vertex);
    }
  }

  /// The corners of a face and the new vertices on its sides.
  Polygon boundaryOf(Index f) const {
    Polygon polygon;
    for (int c = 0; c < 3; ++c) {
      const Index h = 3 * f + c;
      polygon.push_back({given_.tail(h), (1 << c) | (1 << ((c + 2) % 3))});
      std::vector<Index> vertices = new_vertices_[given_.edge(h)];
      if (given_.sign(h) < 0) std::reverse(vertices.begin(), vertices.end());
      for (const Index v : vertices) polygon.push_back({v, 1 << c});
    }
    return polygon;
  }

  /// Makes these polygons the pieces of a face; false where `strict` and the orientation of some
  /// piece cannot be kept.
  bool cutInto(Index f, const std::vector<Polygon>& cells, bool strict) {
    std::vector<Triangle> pieces;
    if (image_.enter) image_.enter(f);
    for (const Polygon& cell : cells) {
      std::optional<std::vector<Triangle>> triangles = triangulate(cell, true);
      if (!triangles && strict) return false;
      if (!triangles) triangles = triangulate(cell, false);
      pieces.insert(pieces.end(), triangles->begin(), triangles->end());
    }
    pieces_[f] = std::move(pieces);
    return true;
  }

  Subdivision collect(Index limit) {
    for (Index f = 0; f < limit; ++f) {
      if (pieces_[f].empty()) pieces_[f].push_back(given_.face(f));
      for (const Triangle& piece : pieces_[f]) {
        result_.faces.push_back(piece);
        result_.parent.push_back(f);
      }
    }
    return std::move(result_);
  }

 private:
  /// Of all triangulations the one whose worst triangle is best; three points on one side make no
  /// triangle. Nothing where `strict` and every one has a triangle of the wrong orientation.
  /// O(n^3).
  std::optional<std::vector<Triangle>> triangulate(const Polygon& polygon, bool strict) const {
    constexpr double kNever = -std::numeric_limits<double>::infinity();
    const std::size_t size = polygon.size();
    // Of the part between two points, and where the triangle on the line between them has its apex.
    std::vector<double> best(size * size, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> apex(size * size, size);
    for (std::size_t width = 2; width < size; ++width) {
      for (std::size_t i = 0; i + width < size; ++i) {
        const std::size_t j = i + width;
        double found = kNever;
        for (std::size_t k = i + 1; k < j; ++k) {
          const double parts = std::min(best[i * size + k], best[k * size + j]);
          if (!(parts > found)) continue;
          const double worst = std::min(parts, quality(polygon[i], polygon[k], polygon[j]));
          if (!(worst > found)) continue;
          found = worst;
          apex[i * size + j] = k;
        }
        best[i * size + j] = found;
      }
    }
    const double whole = best[size - 1];
    if (whole == kNever || (strict && !(whole > 0))) return std::nullopt;
    std::vector<Triangle> triangles;
    std::vector<std::pair<std::size_t, std::size_t>> parts = {{0, size - 1}};
    while (!parts.empty()) {
      const auto [i, j] = parts.back();
      parts.pop_back();
      if (j - i < 2) continue;
      const std::size_t k = apex[i * size + j];
      triangles.push_back({polygon[i].vertex, polygon[k].vertex, polygon[j].vertex});
      parts.push_back({i, k});
      parts.push_back({k, j});
    }
    return triangles;
  }

  double quality(const Point& a, const Point& b, const Point& c) const {
    if ((a.sides & b.sides & c.sides) != 0) return -std::numeric_limits<double>::infinity();
    return image_.quality(a.vertex, b.vertex, c.vertex);
  }

  const Connectivity& given_;
  const SubdivisionImage& image_;
  std::vector<std::vector<Index>> new_vertices_;  ///< Per given edge, from its own tail.
  std::vector<std::vector<Triangle>> pieces_;     ///< Per given face; none if it is whole.
  Subdivision result_;
};

/// Cuts faces along the final edges of an overlay.
class OverlayCutter {
 public:
  OverlayCutter(const Overlay& overlay, std::vector<bool> faces, Index limit,
                const SubdivisionImage& image)
      : overlay_(overlay),
        given_(overlay.given()),
        whole_(std::move(faces)),
        limit_(limit),
        cutter_(given_, image) {}

  Result<Subdivision> run(Context& context) {
    std::vector<Index> work;
    for (Index f = 0; f < limit_; ++f) {
      if (whole_[f]) work.push_back(f);
    }
    while (!work.empty()) {
      RETURN_IF_ERROR(context.check());
      for (const Index f : work) cutWhole(f);
      work = fitNeighbours(work);
    }
    return cutter_.collect(limit_);
  }

 private:
  /// Makes the crossings of a face's sides new vertices, and cuts it along its chords.
  void cutWhole(Index f) {
    whole_[f] = true;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index e = given_.edge(h);
      if (cutter_.isCut(e)) continue;
      std::vector<Subdivision::Vertex> vertices;
      for (const Crossing& crossing : overlay_.crossings(e)) {
        vertices.push_back({given_.halfedge(e), crossing.fraction, crossing});
      }
      cutter_.insert(e, vertices);
    }
    std::vector<Polygon> cells;
    cut(cutter_.boundaryOf(f), overlay_.chords(f), cells);
    cutter_.cutInto(f, cells, false);
  }

  /// The faces beside those just cut that have to be cut, too.
  std::vector<Index> fitNeighbours(const std::vector<Index>& cut_faces) {
    std::vector<Index> next;
    for (const Index f : cut_faces) {
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        const Index twin = given_.twin(h);
        if (twin == kNone || overlay_.crossings(given_.edge(h)).empty()) continue;
        const Index beside = Connectivity::faceOf(twin);
        if (beside >= limit_ || whole_[beside]) continue;
        if (cutter_.cutInto(beside, {cutter_.boundaryOf(beside)}, true)) continue;
        whole_[beside] = true;
        next.push_back(beside);
      }
    }
    return next;
  }

  const Overlay& overlay_;
  const Connectivity& given_;
  std::vector<bool> whole_;
  Index limit_;
  FaceCutter cutter_;
};

}  // namespace

Status checkCuttable(const Connectivity& surface, const std::string& what) {
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto& [a, b, c] = surface.face(f);
    if (a != b && b != c && c != a) continue;
    return {Reason::kFoldedMap,
            what + " turns faces over, and face " + std::to_string(f) +
                " has a vertex twice, so that faces cannot be cut",
            "give a finer triangulation"};
  }
  return {};
}

Result<Subdivision> subdivide(Context& context, const Overlay& overlay,
                              const std::vector<bool>& faces, Index limit,
                              const SubdivisionImage& image) {
  return OverlayCutter(overlay, faces, limit, image).run(context);
}

std::vector<Subdivision::Vertex> evenVertices(const Connectivity& given,
                                              const std::vector<Index>& edges, int count) {
  std::vector<Subdivision::Vertex> vertices;
  for (const Index e : edges) {
    for (int n = 1; n <= count; ++n) {
      vertices.push_back({given.halfedge(e), static_cast<double>(n) / (count + 1), Crossing()});
    }
  }
  return vertices;
}

std::optional<Subdivision> splitEdges(const Connectivity& given,
                                      const std::vector<Subdivision::Vertex>& vertices,
                                      const SubdivisionImage& image) {
  FaceCutter cutter(given, image);
  std::vector<bool> touched(given.faceCount(), false);
  for (std::size_t n = 0; n < vertices.size();) {
    const Index h = vertices[n].halfedge;
    std::vector<Subdivision::Vertex> on_edge;
    for (; n < vertices.size() && vertices[n].halfedge == h; ++n) on_edge.push_back(vertices[n]);
    cutter.insert(given.edge(h), on_edge);
    touched[Connectivity::faceOf(h)] = true;
    if (given.twin(h) != kNone) touched[Connectivity::faceOf(given.twin(h))] = true;
  }
  for (Index f = 0; f < given.faceCount(); ++f) {
    if (touched[f] && !cutter.cutInto(f, {cutter.boundaryOf(f)}, true)) return std::nullopt;
  }
  return cutter.collect(given.faceCount());
}

std::vector<double> subdividedLengths(const Connectivity& given, const std::vector<double>& lengths,
                                      const Subdivision& subdivision, const Connectivity& surface) {
  using Complex = std::complex<double>;
  // A given face in the plane: corner 0 at 0, corner 1 on the real axis.
  const auto corners = [&](Index f) {
    const double a = lengths[given.edge(3 * f)], b = lengths[given.edge(3 * f + 1)],
                 c = lengths[given.edge(3 * f + 2)];
    const double x = ((c - b) * (c + b) / a + a) / 2;
    const double y = 2 * triangleArea(Geometry::kEuclidean, {a, b, c}) / a;
    return std::array<Complex, 3>{Complex(0), Complex(a), Complex(x, y)};
  };
  std::vector<double> result(surface.edgeCount());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Index parent = subdivision.parent[f];
    const std::array<Complex, 3> corner = corners(parent);
    const auto place = [&](Index v) {
      if (v < given.vertexCount()) {
        const Triangle& face = given.face(parent);
        return corner[face[0] == v ? 0 : face[1] == v ? 1 : 2];
      }
      const Subdivision::Vertex& vertex = subdivision.vertices[v - given.vertexCount()];
      int side = 0;
      while (given.edge(3 * parent + side) != given.edge(vertex.halfedge)) ++side;
      const double t = given.sign(3 * parent + side) > 0 ? vertex.fraction : 1 - vertex.fraction;
      return corner[side] + t * (corner[(side + 1) % 3] - corner[side]);
    };
    for (int c = 0; c < 3; ++c) {
      const Index h = 3 * f + c;
      const Index e = surface.edge(h);
      if (surface.face(f) == given.face(parent)) {
        result[e] = lengths[given.edge(3 * parent + c)];
      } else {
        result[e] = std::abs(place(surface.tail(h)) - place(surface.head(h)));
      }
    }
  }
  return result;
}

std::vector<bool> edgesAlong(const Connectivity& given, const std::vector<bool>& chosen,
                             const Subdivision& subdivision, const Connectivity& surface) {
  const auto lies = [&](Index v, Index side) {
    if (v < given.vertexCount()) return v == given.tail(side) || v == given.head(side);
    return given.edge(subdivision.vertices[v - given.vertexCount()].halfedge) == given.edge(side);
  };
  std::vector<bool> along(surface.edgeCount(), false);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const Index parent = subdivision.parent[Connectivity::faceOf(h)];
    for (Index side = 3 * parent; side < 3 * parent + 3; ++side) {
      if (!chosen[given.edge(side)]) continue;
      if (lies(surface.tail(h), side) && lies(surface.head(h), side)) along[surface.edge(h)] = true;
    }
  }
  return along;
}

}  // namespace moduli
