#include "core/intrinsic/subdivide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
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

class Cutter {
 public:
  Cutter(Context& context, const Overlay& overlay, std::vector<bool> faces, Index limit,
         const SubdivisionImage& image)
      : context_(context),
        overlay_(overlay),
        given_(overlay.given()),
        whole_(std::move(faces)),
        limit_(limit),
        image_(image),
        first_(given_.edgeCount(), kNone),
        pieces_(given_.faceCount()) {}

  Result<Subdivision> run() {
    std::vector<Index> work;
    for (Index f = 0; f < limit_; ++f) {
      if (whole_[f]) work.push_back(f);
    }
    while (!work.empty()) {
      RETURN_IF_ERROR(context_.check());
      for (const Index f : work) cutWhole(f);
      work = fitNeighbours(std::move(work));
    }
    collect();
    return std::move(result_);
  }

 private:
  /// Makes the crossings of a face's sides new vertices, and cuts it along its chords.
  void cutWhole(Index f) {
    whole_[f] = true;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) insertOn(given_.edge(h));
    std::vector<Polygon> cells;
    cut(boundaryOf(f), overlay_.chords(f), cells);
    pieces_[f].clear();
    for (const Polygon& cell : cells) {
      std::optional<std::vector<Triangle>> triangles = triangulate(cell, true);
      if (!triangles) triangles = triangulate(cell, false);
      pieces_[f].insert(pieces_[f].end(), triangles->begin(), triangles->end());
    }
  }

  void insertOn(Index e) {
    if (first_[e] != kNone) return;
    first_[e] = static_cast<Index>(result_.vertices.size());
    for (const Crossing& crossing : overlay_.crossings(e)) {
      result_.vertices.push_back({given_.halfedge(e), crossing.fraction, crossing});
      image_.locate(result_.vertices.back());
    }
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
        const auto triangles = triangulate(boundaryOf(beside), true);
        if (triangles) {
          pieces_[beside] = *triangles;
        } else {
          whole_[beside] = true;
          next.push_back(beside);
        }
      }
    }
    return next;
  }

  /// The corners of a face and the new vertices on its sides.
  Polygon boundaryOf(Index f) const {
    Polygon polygon;
    for (int c = 0; c < 3; ++c) {
      const Index h = 3 * f + c;
      polygon.push_back({given_.tail(h), (1 << c) | (1 << ((c + 2) % 3))});
      const Index e = given_.edge(h);
      if (first_[e] == kNone) continue;
      const auto count = static_cast<Index>(overlay_.crossings(e).size());
      for (Index n = 0; n < count; ++n) {
        const Index along = given_.sign(h) > 0 ? n : count - 1 - n;
        polygon.push_back({given_.vertexCount() + first_[e] + along, 1 << c});
      }
    }
    return polygon;
  }

  /// Cuts ears off, the best one first. Three points on one side make no triangle. Nothing where
  /// `strict` and an orientation is wrong.
  std::optional<std::vector<Triangle>> triangulate(Polygon polygon, bool strict) const {
    std::vector<Triangle> triangles;
    while (polygon.size() >= 3) {
      const std::size_t size = polygon.size();
      std::size_t best = size;
      double best_quality = strict ? 0 : -std::numeric_limits<double>::infinity();
      for (std::size_t n = 0; n < size; ++n) {
        const Point &a = polygon[(n + size - 1) % size], &b = polygon[n],
                    &c = polygon[(n + 1) % size];
        if ((a.sides & b.sides & c.sides) != 0) continue;
        const double quality = image_.quality(a.vertex, b.vertex, c.vertex);
        if (quality > best_quality) {
          best_quality = quality;
          best = n;
        }
      }
      if (best == size) return std::nullopt;
      triangles.push_back({polygon[(best + size - 1) % size].vertex, polygon[best].vertex,
                           polygon[(best + 1) % size].vertex});
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(best));
    }
    return triangles;
  }

  void collect() {
    for (Index f = 0; f < limit_; ++f) {
      if (pieces_[f].empty()) {
        result_.faces.push_back(given_.face(f));
        result_.parent.push_back(f);
        continue;
      }
      for (const Triangle& piece : pieces_[f]) {
        result_.faces.push_back(piece);
        result_.parent.push_back(f);
      }
    }
  }

  Context& context_;
  const Overlay& overlay_;
  const Connectivity& given_;
  std::vector<bool> whole_;
  Index limit_;
  const SubdivisionImage& image_;
  std::vector<Index>
      first_;  ///< Per given edge the first of its new vertices, kNone if it is whole.
  std::vector<std::vector<Triangle>> pieces_;  ///< Per given face; none if it is whole.
  Subdivision result_;
};

}  // namespace

Result<Subdivision> subdivide(Context& context, const Overlay& overlay,
                              const std::vector<bool>& faces, Index limit,
                              const SubdivisionImage& image) {
  return Cutter(context, overlay, faces, limit, image).run();
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

}  // namespace moduli
