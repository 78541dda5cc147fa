#include "core/parameterize/disk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/intrinsic/mollify.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/ideal_certificate.h"
#include "core/parameterize/ideal_disk_map.h"
#include "core/spherical/disk_map.h"

namespace moduli {
namespace {

const char* const kMap = "the map to the disk";
/// Of a Möbius map typed with some digits.
constexpr double kKeepsDisk = 1e-9;

/// The map that comes last, as one of the disk onto itself.
DiskImage lastMap(const DiskOptions& options) {
  return [mobius = options.mobius](const std::complex<double>& w, bool on_circle) {
    if (!mobius) return w;
    const std::complex<double> image = (*mobius)(w);
    return on_circle ? image / std::abs(image) : image;
  };
}

Result<Parameterization> wrapped(const Result<DiskMap>& map, const DiskOptions& options,
                                 const Connectivity& surface, const std::vector<double>& lengths) {
  RETURN_IF_ERROR(map.status());
  Parameterization result;
  result.method = options.method;
  const DiskImage last = lastMap(options);
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    result.points.push_back(last(map->points[v], surface.isBoundaryVertex(v)));
  }
  MapQuality& quality = result.certificate.quality;
  quality = measurePlaneMap(surface, lengths, result.points);
  if (quality.flipped_faces > 0) {
    return foldedMap(kMap, quality.flipped_faces, surface.faceCount(),
                     "--method robust cuts the faces that must fold");
  }
  result.certificate.boundary_deviation = map->boundary_deviation;
  if (!options.mobius) result.certificate.centering_residual = map->centering_residual;
  result.corner = vertexCorners(surface);
  return result;
}

}  // namespace

Result<Parameterization> parameterizeDisk(Context& context, const Connectivity& surface,
                                          const std::vector<double>& lengths,
                                          const std::vector<Eigen::Vector3d>& positions,
                                          const DiskOptions& options) {
  RETURN_IF_ERROR(checkGenusZero(surface, kMap, 1, 1));
  if (options.mobius && !options.mobius->keepsDisk(kKeepsDisk)) {
    return Status{
        Reason::kInvalidOption, "the Möbius map does not keep the unit disk",
        "d must be the conjugate of a, c that of b, and |a| > |b|, up to a common factor"};
  }
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  Result<Parameterization> result = [&]() -> Result<Parameterization> {
    switch (options.method) {
      case MapMethod::kLinear:
        return wrapped(mapToDiskLinear(context, surface, mollified.lengths), options, surface,
                       mollified.lengths);
      case MapMethod::kHeatFlow:
        return wrapped(mapToDiskDoubleCover(context, surface, mollified.lengths, positions),
                       options, surface, mollified.lengths);
      case MapMethod::kAuto:
      case MapMethod::kRobust:
        break;
    }
    const auto domain = [&](const IdealDisk&) -> Result<DiskImage> { return lastMap(options); };
    Result<Parameterization> robust =
        mapThroughIdealDisk(context, surface, mollified.lengths, positions,
                            {kMap, options.initial_delaunay, options.refine, domain});
    if (options.method == MapMethod::kRobust ||
        robust.status().reason() != Reason::kNoConvergence) {
      return robust;
    }
    // Clusters of needles; harmonic maps have no trouble with them.
    DiskOptions linear = options;
    linear.method = MapMethod::kLinear;
    Result<Parameterization> other = wrapped(mapToDiskLinear(context, surface, mollified.lengths),
                                             linear, surface, mollified.lengths);
    return other.status().reason() == Reason::kFoldedMap ? robust : other;
  }();
  RETURN_IF_ERROR(result.status());
  result->certificate.mollification = mollified.relative_shift;
  if (options.mobius) result->certificate.centering_residual.reset();
  return result;
}

}  // namespace moduli
