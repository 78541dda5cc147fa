#include "core/parameterize/flat_faces.h"

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "core/hyperbolic/straight_faces.h"
#include "core/intrinsic/overlay.h"
#include "core/parameterize/refine.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Where new vertices on a given edge lie, seen from its tail along the straight edge to its head.
class BentEdges {
 public:
  BentEdges(const Overlay& overlay, const DiscreteMetric& metric)
      : overlay_(overlay),
        triangulation_(metric.triangulation),
        charts_(chartsOfMetric(metric)),
        u_(metric.u) {}

  /// Per crossing of a given edge.
  std::vector<Complex> points(Index edge) const {
    const std::vector<Crossing>& crossings = overlay_.crossings(edge);
    std::vector<Complex> points;
    if (crossings.empty()) return points;
    // The edge's tail is at 0, opposite the first edge that is crossed.
    Index h = crossings.front().halfedge;
    Complex tail = charts_[Connectivity::previous(h)], head = tail + charts_[h], apex;
    for (std::size_t n = 0; n < crossings.size(); ++n) {
      points.push_back(pointOn(crossings[n], tail, head));
      h = triangulation_.twin(crossings[n].halfedge);
      const Complex turn = (tail - head) / charts_[h];
      apex = tail + turn / std::abs(turn) * charts_[Connectivity::next(h)];
      if (n + 1 == crossings.size()) break;
      // The next one starts where the last one did, or ends where it ended.
      (crossings[n + 1].halfedge == Connectivity::next(h) ? head : tail) = apex;
    }
    const Complex back = std::conj(apex) / std::abs(apex);
    for (Complex& point : points) point *= back;
    return points;
  }

 private:
  static FlatCharts chartsOfMetric(const DiscreteMetric& metric) {
    std::vector<double> lengths;
    for (const double x : metric.half_chords) {
      lengths.push_back(lengthOfHalfChord(Geometry::kEuclidean, x));
    }
    return chartsOfTriangles(lengths, metric.angles);
  }

  Complex pointOn(const Crossing& crossing, Complex tail, Complex head) const {
    const Index h = crossing.halfedge;
    const double at_head =
        crossing.weight_head * std::exp(u_[triangulation_.tail(h)] - u_[triangulation_.head(h)]);
    return tail + at_head / (crossing.weight_tail + at_head) * (head - tail);
  }

  const Overlay& overlay_;
  const IntrinsicTriangulation& triangulation_;
  FlatCharts charts_;
  const std::vector<double>& u_;
};

/// Given faces and their pieces in the plane, one given face at a time.
class Pieces {
 public:
  Pieces(const Connectivity& given, const FlatCharts& charts)
      : given_(given), charts_(charts), on_edge_(given.edgeCount()) {}

  bool isCut(Index edge) const { return !on_edge_[edge].empty(); }
  void add(Index edge, Complex point) { on_edge_[edge].push_back({next_vertex_++, point}); }

  /// Puts a given face and what its sides bear into the plane, corner 0 at 0.
  void enter(Index face) {
    face_ = face;
    corners_ = {0.0, charts_[3 * face], -charts_[3 * face + 2]};
    side_points_.clear();
    for (int c = 0; c < 3; ++c) {
      const Index h = 3 * face + c;
      const bool along = given_.sign(h) > 0;
      const Complex from = corners_[along ? c : (c + 1) % 3];
      const Complex way = along ? charts_[h] : -charts_[h];
      for (const NewVertex& vertex : on_edge_[given_.edge(h)]) {
        side_points_.push_back({vertex.number, from + vertex.point * (way / std::abs(way))});
      }
    }
  }

  double quality(Index a, Index b, Index c) const {
    return planeTriangleQuality(place(a), place(b), place(c));
  }

  /// Of a subdivision of the first faces, those of `surface`.
  Result<FlatFaces> collect(const Connectivity& surface, Subdivision subdivision) {
    const Index spare = given_.vertexCount() - surface.vertexCount();
    FlatCharts charts;
    Index folded = 0;
    for (std::size_t f = 0; f < subdivision.faces.size(); ++f) {
      Triangle& face = subdivision.faces[f];
      enter(subdivision.parent[f]);
      const std::array<Complex, 3> corner = {place(face[0]), place(face[1]), place(face[2])};
      if (!(planeTriangleQuality(corner[0], corner[1], corner[2]) > 0)) ++folded;
      for (int c = 0; c < 3; ++c) charts.push_back(corner[(c + 1) % 3] - corner[c]);
      for (Index& v : face) {
        if (v >= given_.vertexCount()) v -= spare;
      }
    }
    const auto vertices = surface.vertexCount() + static_cast<Index>(subdivision.vertices.size());
    ASSIGN_OR_RETURN(Connectivity refined, Connectivity::fromFaces(vertices, subdivision.faces));
    return FlatFaces{std::move(refined), std::move(charts), folded, std::move(subdivision)};
  }

 private:
  struct NewVertex {
    Index number = 0;
    Complex point;
  };

  Complex place(Index v) const {
    for (int c = 0; c < 3; ++c) {
      if (given_.tail(3 * face_ + c) == v) return corners_[c];
    }
    for (const NewVertex& vertex : side_points_) {
      if (vertex.number == v) return vertex.point;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

  const Connectivity& given_;
  const FlatCharts& charts_;
  std::vector<std::vector<NewVertex>> on_edge_;  ///< Per given edge, from its own tail.
  Index next_vertex_ = given_.vertexCount();
  Index face_ = 0;
  std::array<Complex, 3> corners_;
  std::vector<NewVertex> side_points_;
};

}  // namespace

FlatFaces flatFaces(const Connectivity& surface, const DiscreteMetric& metric) {
  const StraightFaces faces = straightFaces(metric);
  FlatFaces result{surface, chartsOfTriangles(faces.lengths, faces.angles)};
  result.charts.resize(surface.halfedgeCount());
  for (Index f = 0; f < surface.faceCount(); ++f) result.folded += faces.isFolded(f) ? 1 : 0;
  return result;
}

Result<FlatFaces> refineFlatFaces(Context& context, const Connectivity& surface,
                                  const DiscreteMetric& metric) {
  const Context::Stage stage(context, "refine");
  RETURN_IF_ERROR(checkCuttable(surface, "the flat metric"));
  const StraightFaces faces = straightFaces(metric);
  const FlatCharts charts = chartsOfTriangles(faces.lengths, faces.angles);
  ASSIGN_OR_RETURN(const Overlay overlay, Overlay::make(context, metric.triangulation));
  const BentEdges bent(overlay, metric);
  Pieces pieces(faces.surface, charts);
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

}  // namespace moduli
