#include "core/parameterize/ideal_disk_map.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/parameterize/genus_zero.h"
#include "core/parameterize/ideal_certificate.h"
#include "core/parameterize/refine.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Of new vertices on boundary edges, from the equator of the double.
constexpr double kOnEquator = 1e-9;

class IdealDiskMapping {
 public:
  IdealDiskMapping(Context& context, const Connectivity& surface,
                   const std::vector<double>& lengths,
                   const std::vector<Eigen::Vector3d>& positions,
                   const IdealDiskMapOptions& options)
      : context_(context),
        surface_(surface),
        lengths_(lengths),
        positions_(positions),
        options_(options) {}

  Result<Parameterization> run() {
    for (const bool initial_delaunay : {options_.initial_delaunay, !options_.initial_delaunay}) {
      Result<IdealDisk> disk =
          mapToIdealDisk(context_, surface_, lengths_, positions_, initial_delaunay, start_);
      if (disk.status().reason() == Reason::kNoConvergence) {
        if (!folding_) failure_ = disk.status();
        continue;
      }
      RETURN_IF_ERROR(disk.status());
      ASSIGN_OR_RETURN(const DiskImage image, options_.domain(*disk));
      const std::vector<Complex> points = imagesOf(*disk, image);
      const std::vector<bool> folded = folds(points);
      const auto count = static_cast<Index>(std::count(folded.begin(), folded.end(), true));
      if (count == 0) return keep(*disk, points);
      failure_ = foldedMap(options_.map, count, surface_.faceCount(),
                           "--refine auto cuts these faces; finer or less obtuse ones avoid it");
      start_ = startOf(disk->polyhedron.metric);
      if (!folding_ || count < least_folds_) {
        least_folds_ = count;
        folding_.emplace(*std::move(disk));
      }
    }
    if (!folding_ || !options_.refine) return failure_;
    ASSIGN_OR_RETURN(const DiskImage image, options_.domain(*folding_));
    return refine(*folding_, image, folds(imagesOf(*folding_, image)));
  }

 private:
  std::vector<Complex> imagesOf(const IdealDisk& disk, const DiskImage& image) const {
    std::vector<Complex> points(disk.points.size());
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      points[v] = image(disk.points[v], surface_.isBoundaryVertex(v));
    }
    return points;
  }

  std::vector<bool> folds(const std::vector<Complex>& points) const {
    return foldedFaces(surface_, points, [](const auto& a, const auto& b, const auto& c) {
      return spherical::orientationSign(a, b, c);
    });
  }

  Result<Parameterization> keep(const IdealDisk& disk, const std::vector<Complex>& points) {
    Parameterization result = certified(disk);
    result.certificate.quality = measurePlaneMap(surface_, lengths_, points);
    result.points = points;
    result.corner = vertexCorners(surface_);
    return result;
  }

  Result<Parameterization> refine(const IdealDisk& disk, const DiskImage& image,
                                  const std::vector<bool>& folded) {
    Parameterization result = certified(disk);
    const auto place = [&](const Eigen::Vector3d& point) {
      const bool on_circle = std::abs(point.z()) < kOnEquator;
      Complex w = sphereToDisk(point);
      if (on_circle) w /= std::abs(w);
      return image(w, on_circle);
    };
    ASSIGN_OR_RETURN(RefinedSurface refined,
                     refineFolds(context_, surface_, lengths_, disk.polyhedron, folded, place));
    for (const Eigen::Vector3d& point : refined.points) result.points.push_back(place(point));
    MapQuality& quality = result.certificate.quality;
    quality = measurePlaneMap(refined.surface, refined.lengths, result.points);
    if (quality.flipped_faces > 0) {
      return foldedMap(options_.map, quality.flipped_faces, refined.surface.faceCount(),
                       "its limbs are thinner than doubles tell apart");
    }
    result.corner = vertexCorners(refined.surface);
    result.subdivision = std::move(refined.subdivision);
    return result;
  }

  Parameterization certified(const IdealDisk& disk) const {
    Parameterization result;
    result.method = MapMethod::kRobust;
    certifyIdeal(disk.polyhedron, result.certificate);
    result.certificate.boundary_deviation = disk.boundary_deviation;
    return result;
  }

  Context& context_;
  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const std::vector<Eigen::Vector3d>& positions_;
  const IdealDiskMapOptions& options_;
  Status failure_;
  IdealStart start_;
  std::optional<IdealDisk> folding_;  ///< The one with the fewest folds.
  Index least_folds_ = 0;
};

}  // namespace

Result<Parameterization> mapThroughIdealDisk(Context& context, const Connectivity& surface,
                                             const std::vector<double>& lengths,
                                             const std::vector<Eigen::Vector3d>& positions,
                                             const IdealDiskMapOptions& options) {
  return IdealDiskMapping(context, surface, lengths, positions, options).run();
}

}  // namespace moduli
