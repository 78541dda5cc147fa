#pragma once

#include <vector>

#include "client/cli/map_drawing.h"

/// What a map does to each face, for pictures.
namespace moduli::cli {

struct FaceMeasures {
  /// Quasi-conformal K: the ratio of the singular values of the linear map from the face to its
  /// image, at least 1 whichever way it is turned; on the sphere, of the triangle of chords; in the
  /// Poincaré disk, where the face has been moved to the middle of it.
  std::vector<double> dilatation;
  /// log(length of the image / length on the surface): half of that of the areas. In the Poincaré
  /// disk lengths are those of its metric, taken there.
  std::vector<double> log_scale;
  std::vector<double> area;  ///< On the surface.
};

/// Per face of the drawing; NaN where it is not mapped or has no area on one side. drawing: with
/// its surface. O(F).
FaceMeasures measureFaces(const MapDrawing& drawing, bool in_hyperbolic_disk);

/// The least value that is not exceeded on `share` of the area. Values that are not finite count
/// for nothing; 0 where there are no others. O(F log F).
double areaQuantile(const std::vector<double>& values, const std::vector<double>& areas,
                    double share);

/// The mean by area, of what is finite; 0 where nothing is.
double areaMean(const std::vector<double>& values, const std::vector<double>& areas);

}  // namespace moduli::cli
