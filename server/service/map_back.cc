#include "server/service/map_back.h"

#include <array>
#include <utility>

namespace moduli {
namespace {

/// Puts together what the input's faces have become.
class InputFaces {
 public:
  InputFaces(TriangleSoup soup, const PreparedMesh& prepared,
             const std::vector<Index>& input_corners, const Parameterization& map)
      : soup_(std::move(soup)),
        surface_(prepared.mesh.connectivity()),
        positions_(prepared.mesh.positions()),
        input_corners_(input_corners),
        map_(map),
        number_(map.points.size(), kNone),
        pieces_(soup_.faces.size()) {}

  MappedFaces run() {
    result_.positions =
        onSphere() ? std::vector<Eigen::Vector3d>(soup_.vertices.size(), Eigen::Vector3d::Zero())
                   : soup_.vertices;
    if (onSphere()) placeOnSphere();
    addVertices();
    const Index faces = map_.subdivision ? static_cast<Index>(map_.subdivision->faces.size())
                                         : surface_.faceCount();
    for (Index f = 0; f < faces; ++f) sortIn(f);
    for (std::size_t f = 0; f < pieces_.size(); ++f) {
      if (pieces_[f].empty()) add({soup_.faces[f], {kNone, kNone, kNone}});
      for (const Piece& piece : pieces_[f]) add(piece);
      if (map_.subdivision) result_.parents.resize(result_.faces.size(), static_cast<Index>(f));
    }
    return std::move(result_);
  }

 private:
  struct Piece {
    Triangle vertices, points;
  };

  bool onSphere() const { return !map_.sphere.empty(); }

  void add(const Piece& piece) {
    result_.faces.push_back(piece.vertices);
    result_.corners.push_back(piece.points);
  }

  /// Every corner of a mapped face moves its vertex; a vertex that repair has split gets another
  /// number for each further image.
  void placeOnSphere() {
    std::vector<Index> image(soup_.vertices.size(), kNone);
    split_.assign(input_corners_.size(), kNone);
    std::vector<Index> extra(surface_.vertexCount(), kNone);
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      const Index corner = input_corners_[h];
      if (corner == kNone) continue;
      const Index input = soup_.faces[corner / 3][corner % 3], v = surface_.tail(h);
      if (image[input] == kNone) image[input] = v;
      if (image[input] == v) {
        result_.positions[input] = map_.sphere[v];
        continue;
      }
      if (extra[v] == kNone) {
        extra[v] = static_cast<Index>(result_.positions.size());
        result_.positions.push_back(map_.sphere[v]);
      }
      split_[h] = extra[v];
    }
  }

  void addVertices() {
    first_new_ = static_cast<Index>(result_.positions.size());
    if (!map_.subdivision) return;
    Index v = surface_.vertexCount();
    for (const Subdivision::Vertex& vertex : map_.subdivision->vertices) {
      if (onSphere()) {
        result_.positions.push_back(map_.sphere[v++]);
        continue;
      }
      const Eigen::Vector3d& tail = positions_[surface_.tail(vertex.halfedge)];
      const Eigen::Vector3d& head = positions_[surface_.head(vertex.halfedge)];
      result_.positions.push_back(tail + vertex.fraction * (head - tail));
    }
  }

  /// The point's number in the result; points that only faces in filled holes have get none.
  Index pointNumber(Index point) {
    if (number_[point] == kNone) {
      number_[point] = static_cast<Index>(result_.points.size());
      result_.points.push_back(map_.points[point]);
    }
    return number_[point];
  }

  /// Gives a face of the map to the face of the input that it is (part of).
  void sortIn(Index f) {
    const Index parent = map_.subdivision ? map_.subdivision->parent[f] : f;
    const Triangle& face = map_.subdivision ? map_.subdivision->faces[f] : surface_.face(f);
    const Triangle& whole = surface_.face(parent);
    if (input_corners_[3 * parent] == kNone) return;
    const Index input_face = input_corners_[3 * parent] / 3;
    std::array<Index, 3> place;  // Of the parent's corners among those of the input's face.
    for (int c = 0; c < 3; ++c) place[c] = input_corners_[3 * parent + c] % 3;
    const bool turned = (place[1] - place[0] + 3) % 3 != 1;
    const bool is_whole = face == whole;
    Piece piece;
    for (int c = 0; c < 3; ++c) {
      int own = 0;
      while (own < 3 && whole[own] != face[c]) ++own;
      const Index vertex =
          own < 3 ? cornerVertex(3 * parent + own) : first_new_ + face[c] - surface_.vertexCount();
      const int target = is_whole ? place[c] : turned ? 2 - c : c;
      piece.vertices[target] = vertex;
      piece.points[target] = onSphere() ? kNone : map_.corner[3 * f + c];
    }
    if (!onSphere()) {
      for (Index& point : piece.points) point = pointNumber(point);
    }
    pieces_[input_face].push_back(piece);
  }

  Index cornerVertex(Index h) const {
    if (!split_.empty() && split_[h] != kNone) return split_[h];
    return soup_.faces[input_corners_[h] / 3][input_corners_[h] % 3];
  }

  TriangleSoup soup_;
  const Connectivity& surface_;
  const std::vector<Eigen::Vector3d>& positions_;
  const std::vector<Index>& input_corners_;
  const Parameterization& map_;
  std::vector<Index> number_;
  std::vector<std::vector<Piece>> pieces_;
  std::vector<Index> split_;  ///< Sphere: per halfedge the further image of its input vertex.
  Index first_new_ = 0;
  MappedFaces result_;
};

}  // namespace

MappedFaces mapInputFaces(TriangleSoup soup, const PreparedMesh& prepared,
                          const std::vector<Index>& input_corners, const Parameterization& map) {
  return InputFaces(std::move(soup), prepared, input_corners, map).run();
}

MappedFaces imageAlone(const Connectivity& surface, const Parameterization& map) {
  MappedFaces result;
  if (map.subdivision) result.parents = map.subdivision->parent;
  const std::vector<Triangle>& faces = map.subdivision ? map.subdivision->faces : surface.faces();
  if (!map.sphere.empty()) {
    result.positions = map.sphere;
    result.faces = faces;
    result.corners.assign(faces.size(), {kNone, kNone, kNone});
    return result;
  }
  result.points = map.points;
  for (const std::complex<double>& z : map.points) {
    result.positions.emplace_back(z.real(), z.imag(), 0);
  }
  for (std::size_t h = 0; h < map.corner.size(); h += 3) {
    result.corners.push_back({map.corner[h], map.corner[h + 1], map.corner[h + 2]});
  }
  result.faces = result.corners;
  return result;
}

}  // namespace moduli
