#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/cpp/parameterized_mesh.h"
#include "core/picture/render.h"

/// The arrays of a parameterization in the form that pictures need.
namespace moduli::cli {

/// An edge of the surface and its image, each seen from one of its faces where they differ.
struct MapEdge {
  enum class Kind : std::uint8_t {
    kInner,     ///< The images of its faces are neighbours.
    kBoundary,  ///< It has one face that is mapped.
    kSeam,      ///< The image is cut open here.
  };
  std::array<int, 2> vertices;
  std::array<int, 2> points;  ///< In the direction of the face.
  Kind kind = Kind::kInner;
};

struct MapDrawing {
  bool on_sphere = false;
  std::vector<Vec3> surface;           ///< Per vertex; empty where it has no place in space.
  std::vector<CornerIndices> faces;    ///< Into `surface`, in range.
  std::vector<Vec3> points;            ///< The image: (u, v, 0), or of length 1.
  std::vector<CornerIndices> corners;  ///< Of each face into `points`; -1 where it is not mapped.
  std::vector<bool> folded;            ///< Per face: turned over or without area.
  std::vector<int> mapped;             ///< Faces with an image, folded ones first.
  std::vector<MapEdge> edges;          ///< Of mapped faces.
  double image_area = 0;               ///< Sum of the faces' areas, each positive.

  bool isMapped(int face) const { return corners[face][0] >= 0; }
};

/// space: x y z of the surface's vertices, the first of them at least: vertices that are not there
/// (they lie in faces that were cut) go to the mean of their neighbours. Empty: the positions of
/// the map, where it goes to the plane; to the sphere, no place in space. Faces with indices out of
/// range are left out, those with points that are not finite are not mapped. O(F log F).
MapDrawing makeDrawing(const ParameterizedMesh& map, std::span<const double> space);

/// Puts numbers at vertices that have none. rows: `columns` numbers of each of the first vertices.
/// Others get the mean of their neighbours, smoothed; NaN where nothing is near. O(sweeps F).
std::vector<double> extendToVertices(std::span<const double> rows, std::size_t columns,
                                     std::size_t vertices, const std::vector<CornerIndices>& faces);

}  // namespace moduli::cli
