#pragma once

#include <string>
#include <vector>

#include "client/cli/map_drawing.h"
#include "core/picture/legend.h"

/// Numbers of a map as colours.
namespace moduli::cli {

inline constexpr Color kFoldedInHeat = {0, 104, 214};  ///< No colour of the bar is near it.

class MapHeat {
 public:
  /// The dilatation K of faces, one colour each, from 1 up to a round number that is exceeded on 2
  /// % of the area at most.
  static MapHeat ofDilatation(const MapDrawing& drawing, bool in_hyperbolic_disk);

  /// How much longer lengths are in the image than on the surface, against the mean of their
  /// logarithms: red where the map makes things large. Faces give it to their vertices. The
  /// logarithm of the ends of the bar is a round number that is exceeded on 2 % of the area at
  /// most.
  static MapHeat ofScale(const MapDrawing& drawing, bool in_hyperbolic_disk);

  /// The colour of a point of a mapped face.
  Color at(int face, const Vec3& weights) const;

  const Legend& legend() const { return legend_; }
  /// In words, for people.
  const std::string& summary() const { return summary_; }

 private:
  explicit MapHeat(const MapDrawing& drawing) : drawing_(&drawing) {}
  void addFolds();

  const MapDrawing* drawing_;   ///< Of whom this is; has to stay.
  std::vector<double> values_;  ///< Per face, or per vertex of the surface.
  bool of_vertices_ = false;
  double low_ = 0, high_ = 1;
  Legend legend_;
  std::string summary_;
};

}  // namespace moduli::cli
