#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <set>
#include <vector>

#include "client/cli/map_drawing.h"
#include "core/picture/image.h"

/// What a map's pictures are painted with.
namespace moduli::cli {

inline constexpr Color kFoldedColor = {200, 36, 44};
inline constexpr Color kPatternLight = {236, 238, 241};
inline constexpr Color kUnmappedColor = {205, 214, 224};

/// A checkerboard on the image of a map whose cells are squares, or squares by a conformal map: in
/// the plane, between circles around 0 (log-polar), or between parallels of the sphere (in
/// Mercator's map; round caps at the poles). Pulled back by a conformal map its cells keep their
/// right angles. Where much of the surface is in one cell, it is cut in 3 x 3 and so on, so that
/// parts that the map makes small have a pattern too. The dark cells have tints by their place, so
/// that they can be found again.
class Pattern {
 public:
  enum class Kind : std::uint8_t { kSquares, kRings, kParallels };

  /// Squares on rectangles and the plane (QUADS: the unit squares, or whole blocks of them, none of
  /// them cut), rings on disks and circle domains, parallels on spheres.
  Pattern(const MapDrawing& drawing, v1::ParameterizationOptions::Target target);

  /// The colour at a point of the image; on the sphere, of any length but 0.
  Color at(const Vec3& point) const;

  /// A dark cell, its outline counter-clockwise (on the sphere seen from outside), curved sides cut
  /// in short ones.
  struct Cell {
    std::vector<Vec3> outline;
    Color color;
  };
  /// The dark cells on the image's bounding box, disk or sphere. At most some 45000.
  std::vector<Cell> darkCells() const;

 private:
  /// Column, row and how often it was cut: columns and rows are counted in cells of that size.
  struct Index {
    long long i = 0, j = 0;
    int level = 0;
    auto operator<=>(const Index&) const = default;
  };
  /// A piece of the surface: where its image is, and its area.
  struct Piece {
    std::array<double, 2> place;
    double area = 0;
  };

  /// A point in coordinates whose uncut cells are unit squares.
  std::array<double, 2> cellCoordinates(const Vec3& point) const;
  Vec3 pointAt(double x, double y) const;
  Index indexAt(const std::array<double, 2>& place, int level) const;
  bool isCell(const Index& index) const;
  Color colorOf(const Index& index) const;
  void addDarkCells(const Index& index, std::vector<Cell>& cells) const;
  void fitSquares(const MapDrawing& drawing, bool height_is_whole);
  void unitSquares(const MapDrawing& drawing);
  std::vector<Piece> piecesOf(const MapDrawing& drawing) const;
  void addRows(const std::vector<Piece>& pieces, double largest);
  void cut(std::vector<Piece> pieces, double largest);

  Kind kind_;
  std::array<double, 2> origin_ = {0, 0};  ///< Of squares.
  double side_ = 1;                   ///< Of squares; of the others in log r or Mercator's map.
  long long columns_ = 1, rows_ = 1;  ///< Cells; of parallels, on each side of the equator.
  std::set<Index> cut_;               ///< Cells that are cut.
};

/// One number per vertex as colours: from low to high, or to both sides of 0 where it has both
/// signs. The range leaves 2 % of the vertices out on each end.
class FieldColors {
 public:
  /// values: per vertex; those that are not finite are shown plain.
  explicit FieldColors(std::vector<double> values);

  Color at(const CornerIndices& face, const Vec3& weights) const;
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  std::vector<double> values_;
  double low_ = 0, high_ = 0;
};

}  // namespace moduli::cli
