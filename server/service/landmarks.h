#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/parameterize/register_sphere.h"
#include "moduli/v1/parameterization.pb.h"
#include "server/service/subject.h"

/// Landmarks of a checked request, moved from the inputs' vertices and faces to those of the
/// prepared surfaces.
namespace moduli {

/// Fails with kInvalidOption, by the landmark's name and in the numbers of the input, for a vertex
/// or a face that is not there (out of range, without faces, not in the component, dropped or split
/// by repair). O(V + F + landmarks).
Result<std::vector<SphereLandmark>> landmarksOnSurfaces(const v1::SphereRegistration& registration,
                                                        const Subject& subject,
                                                        const Subject& reference);

/// Fails likewise, and where two vertices in a row are not joined by an edge. O(V + degrees).
Result<std::vector<SphereCurve>> curvesOnSurfaces(const v1::SphereRegistration& registration,
                                                  const Subject& subject, const Subject& reference);

}  // namespace moduli
