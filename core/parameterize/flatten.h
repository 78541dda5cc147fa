#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/parameterize/flat.h"
#include "core/parameterize/flat_faces.h"

namespace moduli {

/// A flat layout with the faces that it is of. Internal to this room.
struct FlatMap {
  Parameterization map;
  /// Charts to the scale of the map: to the last digits of every face, where points that lie far
  /// out have lost those of tiny ones.
  FlatFaces faces;
};

/// parameterizeFlat, keeping the charts of the faces.
Result<FlatMap> flatten(Context& context, const Connectivity& surface,
                        const std::vector<double>& lengths, const FlatOptions& options);

}  // namespace moduli
