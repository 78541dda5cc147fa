#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"
#include "core/spherical/robust_disk.h"

namespace moduli {

/// A conformal map of the unit disk to another domain, given once the disk is known: the image of a
/// point, and of one that lies on the circle.
using DiskImage = std::function<std::complex<double>(const std::complex<double>&, bool on_circle)>;

struct IdealDiskMapOptions {
  std::string map;  ///< For messages: "the map to the disk".
  bool initial_delaunay = true;
  bool refine = true;
  /// From the disk to the domain. Orientation is judged there.
  std::function<Result<DiskImage>(const IdealDisk&)> domain;
};

/// Maps a surface by its ideal disk and a conformal map of that: from the given starting
/// triangulation; from the other one where faces fold; then with finer faces. surface: of genus 0
/// with one boundary loop; lengths: proper triangles. Fails with kFoldedMap, and as mapToIdealDisk
/// and `domain` do.
Result<Parameterization> mapThroughIdealDisk(Context& context, const Connectivity& surface,
                                             const std::vector<double>& lengths,
                                             const std::vector<Eigen::Vector3d>& positions,
                                             const IdealDiskMapOptions& options);

}  // namespace moduli
