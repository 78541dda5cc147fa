#pragma once

#include <array>
#include <vector>

#include "client/cli/map_drawing.h"
#include "core/picture/render.h"

namespace moduli::cli {

/// A torus in the plane with parts of the copies around it: what shows that they fit.
class TorusTiling {
 public:
  /// drawing: of a map to a fundamental domain; has to stay. None where the lattice is none, or
  /// where too many copies would be seen.
  TorusTiling(const MapDrawing& drawing, const v1::TorusDomain& torus);

  bool empty() const { return shifts_.empty(); }
  /// By which the copies are moved that are seen in the window, the image itself left out.
  const std::vector<Vec3>& shifts() const { return shifts_; }
  /// What is seen: its lower left and its upper right corner.
  const std::array<Vec3, 2>& window() const { return window_; }

  /// A piece of a copy's face within the window.
  struct Piece {
    CornerIndices corners;  ///< Into points().
    int shift = 0;          ///< Into shifts().
  };
  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<Piece>& pieces() const { return pieces_; }

  /// Edges of the copies' boundaries within the window.
  std::vector<Segment> outlines() const;
  /// 0, a, a + b and b, closed.
  const std::vector<Vec3>& parallelogram() const { return parallelogram_; }

 private:
  void findShifts(const Vec3& a, const Vec3& b);
  void addPieces();

  const MapDrawing* drawing_;
  std::array<Vec3, 2> window_{}, box_{};
  std::vector<Vec3> shifts_, points_, parallelogram_;
  std::vector<Piece> pieces_;
};

/// A colour of the image as its copies show it: nearer to white.
Color paleColor(const Color& color);

}  // namespace moduli::cli
