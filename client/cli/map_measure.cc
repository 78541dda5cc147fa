#include "client/cli/map_measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli::cli {
namespace {

using namespace vec3;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// First fundamental form of a triangle in the coordinates of its two sides at one corner.
struct Form {
  double e = 0, f = 0, g = 0;
  double determinant = 0;  ///< Squared and doubled area, from the cross product.
};

Form formOf(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = b - a, q = c - a, n = cross(p, q);
  return {dot(p, p), dot(p, q), dot(q, q), dot(n, n)};
}

// Eigenvalues of image against source are K d and d / K, with d^2 the ratio of the determinants.
double dilatationOf(const Form& source, const Form& image) {
  const double trace =
      (image.e * source.g - 2 * image.f * source.f + image.g * source.e) / source.determinant;
  const double half = trace / (2 * std::sqrt(image.determinant / source.determinant));
  return half <= 1 ? 1 : half + std::sqrt((half - 1) * (half + 1));
}

}  // namespace

FaceMeasures measureFaces(const MapDrawing& drawing, bool in_hyperbolic_disk) {
  const std::size_t count = drawing.faces.size();
  FaceMeasures measures{std::vector<double>(count, kNan), std::vector<double>(count, kNan),
                        std::vector<double>(count, 0.0)};
  for (std::size_t f = 0; f < count; ++f) {
    const CornerIndices& v = drawing.faces[f];
    const Form source = formOf(drawing.surface[v[0]], drawing.surface[v[1]], drawing.surface[v[2]]);
    const double area = std::sqrt(source.determinant) / 2;
    measures.area[f] = std::isfinite(area) ? area : 0;
    if (!drawing.isMapped(static_cast<int>(f))) continue;
    const CornerIndices& c = drawing.corners[f];
    const Vec3 &a = drawing.points[c[0]], &b = drawing.points[c[1]], &d = drawing.points[c[2]];
    const Form image = formOf(a, b, d);
    if (!(source.determinant > 0) || !(image.determinant > 0)) continue;
    measures.dilatation[f] = dilatationOf(source, image);
    measures.log_scale[f] = std::log(image.determinant / source.determinant) / 4;
    if (!in_hyperbolic_disk) continue;
    const Vec3 middle = (1.0 / 3) * (a + b + d);
    measures.log_scale[f] += std::log(2 / (1 - dot(middle, middle)));
  }
  return measures;
}

double areaQuantile(const std::vector<double>& values, const std::vector<double>& areas,
                    double share) {
  std::vector<std::pair<double, double>> sorted;
  double total = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    sorted.emplace_back(values[i], areas[i]);
    total += areas[i];
  }
  if (sorted.empty()) return 0;
  std::sort(sorted.begin(), sorted.end());
  double below = 0;
  for (const auto& [value, area] : sorted) {
    below += area;
    if (below >= share * total) return value;
  }
  return sorted.back().first;
}

double areaMean(const std::vector<double>& values, const std::vector<double>& areas) {
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    sum += areas[i] * values[i];
    total += areas[i];
  }
  return total > 0 ? sum / total : 0;
}

}  // namespace moduli::cli
