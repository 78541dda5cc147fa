#include "client/cli/map_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
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

// By the isometry that takes the mean of the points to 0, where the metric is twice the plane's.
void moveToCentre(std::array<Vec3, 3>& points) {
  using Complex = std::complex<double>;
  const Vec3 mean = (1.0 / 3) * (points[0] + points[1] + points[2]);
  const Complex middle(mean[0], mean[1]);
  for (Vec3& p : points) {
    const Complex z(p[0], p[1]);
    const Complex moved = (z - middle) / (1.0 - std::conj(middle) * z);
    p = {moved.real(), moved.imag(), 0};
  }
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
    std::array<Vec3, 3> image_points = {drawing.points[c[0]], drawing.points[c[1]],
                                        drawing.points[c[2]]};
    if (in_hyperbolic_disk) moveToCentre(image_points);
    const Form image = formOf(image_points[0], image_points[1], image_points[2]);
    if (!(source.determinant > 0) || !(image.determinant > 0)) continue;
    measures.dilatation[f] = dilatationOf(source, image);
    measures.log_scale[f] = std::log(image.determinant / source.determinant) / 4;
    if (in_hyperbolic_disk) measures.log_scale[f] += std::numbers::ln2;
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
