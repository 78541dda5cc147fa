#pragma once

#include <complex>
#include <vector>

#include "core/base/context.h"
#include "core/spherical/disk_map.h"

/// What all maps to the disk demand and end with. Internal to this room.
namespace moduli::spherical {

/// Fails with kUnsupportedTopology unless the surface is connected, of genus 0 and with one
/// boundary loop.
Status checkDisk(const Connectivity& surface);

/// Centres a map to the disk, puts its boundary on the circle and measures it. lengths: per edge.
/// areas: per vertex. Fails as centerDisk does.
Result<DiskMap> centeredDiskMap(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths,
                                const std::vector<double>& areas,
                                const std::vector<std::complex<double>>& points);

/// Puts the tips of folded or collapsed faces with two boundary edges on the arc between their
/// neighbours, in the proportion of the two edges, counts them, and centres and measures again.
/// Fails likewise.
Result<DiskMap> withTipsReset(Context& context, const Connectivity& surface,
                              const std::vector<double>& lengths, const std::vector<double>& areas,
                              DiskMap map);

/// Fails with kFoldedMap where faces are flipped or the boundary does not run once around.
Status checkUnfolded(const Connectivity& surface, const DiskMap& map);

}  // namespace moduli::spherical
