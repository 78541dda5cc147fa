#pragma once

#include <complex>
#include <vector>

#include "client/cli/map_drawing.h"
#include "client/cpp/parameterized_mesh.h"
#include "core/hyperbolic/su11.h"
#include "core/picture/render.h"
#include "core/picture/shapes.h"

/// The picture of a hyperbolic surface in the Poincaré disk.
namespace moduli::cli {

/// The image of the surface, its copies around it, and the closed geodesics.
///
/// The two cuts that belong together, and the copies beyond them, have one hue, on the surface too:
/// there the cut is one line. A copy farther out has the hue of the neighbour of the image that it
/// lies behind, lighter and darker in turn. Copies are drawn as far as they can be seen.
class DiskTiling {
 public:
  /// drawing: of `map`, which is hyperbolic and has its arrays.
  DiskTiling(const MapDrawing& drawing, const ParameterizedMesh& map);

  /// The whole disk. edges: those of the faces of the image, too.
  std::vector<Shape> shapes(int width, int height, bool edges) const;

  /// Pixels per unit of length of the disk's coordinates.
  static double scale(int width, int height);

  /// Cuts and geodesics on the surface in space. pixel: as in MapPanels::scene.
  std::vector<LineSet> surfaceLines(double pixel) const;

  int geodesicCount() const { return static_cast<int>(geodesics_.size()); }

 private:
  using Complex = std::complex<double>;

  /// A side of the image: between two of its points, the image on the left.
  struct Side {
    int from = 0, to = 0;
    int neighbour = -1;  ///< Beyond it, an index of neighbours_; -1 on the boundary.
    int edge = -1;       ///< Of the drawing.
  };
  struct Tile {
    Su11 place;
    int first = -1;  ///< Of neighbours_: the one behind which it lies.
    int depth = 0;
  };
  struct Geodesic {
    std::vector<Segment> in_space;
    std::vector<std::array<Complex, 2>> in_disk;
  };

  void findSides();
  void matchSides();
  void findTiles();
  void takeGeodesics(const ParameterizedMesh& map);
  Complex point(int i) const { return {drawing_.points[i][0], drawing_.points[i][1]}; }

  const MapDrawing& drawing_;
  std::vector<Su11> neighbours_, generators_;
  std::vector<std::vector<Side>> loops_;  ///< Around the image.
  std::vector<Tile> tiles_;               ///< The image itself first.
  std::vector<Geodesic> geodesics_;
};

}  // namespace moduli::cli
