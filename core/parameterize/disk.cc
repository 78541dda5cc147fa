#include "core/parameterize/disk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/intrinsic/mollify.h"
#include "core/parameterize/genus_zero.h"
#include "core/parameterize/ideal_disk_map.h"
#include "core/spherical/disk_map.h"

namespace moduli {
namespace {

const char* const kMap = "the map to the disk";
/// Of a Möbius map typed with some digits.
constexpr double kKeepsDisk = 1e-9;

Result<Parameterization> wrapped(Result<DiskMap> map, MapMethod method,
                                 const Connectivity& surface) {
  RETURN_IF_ERROR(map.status());
  Parameterization result;
  result.method = method;
  result.points = std::move(map->points);
  result.certificate.quality = std::move(map->quality);
  result.certificate.boundary_deviation = map->boundary_deviation;
  result.certificate.centering_residual = map->centering_residual;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) result.corner.push_back(surface.tail(h));
  return result;
}

/// Boundary points stay on the circle.
void apply(const MobiusMap& map, std::vector<std::complex<double>>& points) {
  for (std::complex<double>& w : points) {
    const bool on_circle = std::abs(std::abs(w) - 1) < 1e-12;
    w = map(w);
    if (on_circle) w /= std::abs(w);
  }
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
        return wrapped(mapToDiskLinear(context, surface, mollified.lengths), options.method,
                       surface);
      case MapMethod::kHeatFlow:
        return wrapped(mapToDiskDoubleCover(context, surface, mollified.lengths, positions),
                       options.method, surface);
      case MapMethod::kAuto:
      case MapMethod::kRobust:
        break;
    }
    const auto same = [](const IdealDisk&) -> Result<DiskImage> {
      return DiskImage([](const std::complex<double>& w, bool) { return w; });
    };
    return mapThroughIdealDisk(context, surface, mollified.lengths, positions,
                               {kMap, options.initial_delaunay, options.refine, same});
  }();
  RETURN_IF_ERROR(result.status());
  result->certificate.mollification = mollified.relative_shift;
  if (options.mobius) apply(*options.mobius, result->points);
  return result;
}

}  // namespace moduli
