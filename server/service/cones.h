#pragma once

#include <google/protobuf/repeated_field.h>

#include <vector>

#include "core/mesh/input_corners.h"
#include "core/parameterize/flat.h"
#include "moduli/v1/parameterization.pb.h"

namespace moduli {

using ConeMessages = google::protobuf::RepeatedPtrField<v1::Cone>;

/// Moves cones of a request from the input's vertices to those of a prepared surface, and judges
/// all about them that speaks of single vertices, so that messages name the input's.
///
/// Fails with kInvalidOption for a vertex that is not there (out of range, without faces, not in
/// the component, dropped or split by repair) or has two cones, and for a curvature of 2 pi or more
/// inside the surface, of pi or more on its boundary. O(V + cones).
Result<std::vector<Cone>> conesOnSurface(const ConeMessages& cones, const Connectivity& surface,
                                         const VertexPlaces& places);

/// The rule that a request asks for; unspecified: straight where a cone is on the boundary, free
/// elsewhere. Fails with kInvalidOption for cones on a free boundary. O(cones).
Result<BoundaryRule> boundaryRule(v1::ParameterizationOptions::Boundary wanted,
                                  const ConeMessages& messages, const std::vector<Cone>& cones,
                                  const Connectivity& surface);

}  // namespace moduli
