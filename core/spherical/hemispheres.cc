#include "core/spherical/hemispheres.h"

#include <cmath>
#include <optional>
#include <string>

#include "core/spherical/landmark_alignment.h"
#include "core/spherical/sphere_locator.h"

namespace moduli {
namespace {

Result<SphereLocator> makeLocator(const Connectivity& surface, const Points3& points,
                                  const char* name) {
  auto locator = SphereLocator::make(surface, points);
  if (!locator.ok()) return locator.status().withContext(name);
  return locator;
}

Status checkSizes(const Hemisphere& hemisphere, const char* name) {
  const auto count = static_cast<std::size_t>(hemisphere.surface.vertexCount());
  if (hemisphere.points.size() == count && hemisphere.weights.size() == count &&
      hemisphere.field.size() == count) {
    return {};
  }
  return {Reason::kInvalidOption,
          std::string(name) + ": every vertex needs a point, a weight and a value"};
}

/// The rotation from the landmarks. mirrored: the second sphere's points; its faces' corners are
/// those of the surface as given.
Result<Eigen::Matrix3d> rotationByLandmarks(const Hemisphere& first, const Hemisphere& second,
                                            const Points3& mirrored,
                                            const HemisphereOptions& options) {
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < options.landmarks.size(); ++i) {
    const auto& [on_first, on_second] = options.landmarks[i];
    const std::string name = "landmark " + std::to_string(i);
    RETURN_IF_ERROR(checkSurfacePoint(first.surface, on_first, name));
    RETURN_IF_ERROR(checkSurfacePoint(second.surface, on_second, name));
    pairs.push_back({spherePoint(first.surface, first.points, on_first),
                     spherePoint(second.surface, mirrored, on_second)});
  }
  return bestRotation(pairs);
}

}  // namespace

MirroredSphere mirrorSphere(const Connectivity& surface, Points3 points) {
  std::vector<Triangle> faces;
  for (const auto& [a, b, c] : surface.faces()) faces.push_back({a, c, b});
  // The sides of (a, c, b) are those of (a, b, c) from the last to the first.
  const auto turned = [](Index h) { return h - h % 3 + 2 - h % 3; };
  std::vector<Index> twin(surface.halfedgeCount(), kNone);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.twin(h) != kNone) twin[turned(h)] = turned(surface.twin(h));
  }
  for (Eigen::Vector3d& p : points) p.x() = -p.x();
  // A gluing stays one when all faces are turned over.
  return {*Connectivity::fromGluing(surface.vertexCount(), std::move(faces), std::move(twin)),
          std::move(points)};
}

Result<HemisphereComparison> compareHemispheres(Context& context, const Hemisphere& first,
                                                const Hemisphere& second,
                                                const HemisphereOptions& options) {
  RETURN_IF_ERROR(checkSizes(first, "first hemisphere"));
  RETURN_IF_ERROR(checkSizes(second, "second hemisphere"));
  std::optional<MirroredSphere> mirrored;
  if (options.mirror) mirrored = mirrorSphere(second.surface, second.points);
  const Connectivity& surface = mirrored ? mirrored->surface : second.surface;
  const Points3& points = mirrored ? mirrored->points : second.points;
  ASSIGN_OR_RETURN(const SphereLocator at_first,
                   makeLocator(first.surface, first.points, "first hemisphere"));
  ASSIGN_OR_RETURN(const SphereLocator at_second,
                   makeLocator(surface, points, "second hemisphere"));
  const SphereField a{at_first, first.field}, b{at_second, second.field};

  HemisphereComparison result;
  if (options.landmarks.empty()) {
    ASSIGN_OR_RETURN(const FieldAlignment best,
                     alignFields(context, a, first.weights, b, options.search));
    result.rotation = best.rotation;
  } else {
    ASSIGN_OR_RETURN(result.rotation, rotationByLandmarks(first, second, points, options));
  }
  result.correlation_before = fieldCorrelation(a, first.weights, b, Eigen::Matrix3d::Identity());
  result.correlation_after = fieldCorrelation(a, first.weights, b, result.rotation);
  double sum = 0, total = 0;
  for (std::size_t v = 0; v < first.points.size(); ++v) {
    SurfacePoint place = at_second.locate(result.rotation * first.points[v]);
    result.carried.push_back(valueAt(surface, second.field, place));
    if (mirrored) std::swap(place.barycentric[1], place.barycentric[2]);
    result.places.push_back(place);
    sum += first.weights[v] * std::abs(first.field[v] - result.carried.back());
    total += first.weights[v];
  }
  result.mean_absolute_difference = sum / total;
  return result;
}

}  // namespace moduli
