#pragma once

#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/matching/match_surfaces.h"
#include "core/parameterize/register_sphere.h"
#include "moduli/v1/matching.pb.h"
#include "moduli/v1/parameterization.pb.h"
#include "server/service/subject.h"

/// Landmarks of a checked request, moved from the inputs' vertices and faces to those of the
/// prepared surfaces.
namespace moduli {

/// The two surfaces of landmarks, and what messages call the second one.
struct LandmarkSurfaces {
  const Subject& first;
  const Subject& second;
  std::string second_name;  ///< "the reference".
};

/// Fails with kInvalidOption, by the landmark's name and in the numbers of the input, for a vertex
/// or a face that is not there (out of range, without faces, not in the component, dropped or split
/// by repair). O(V + F + landmarks).
Result<std::vector<SphereLandmark>> landmarksOnSurfaces(
    const google::protobuf::RepeatedPtrField<v1::LandmarkPair>& pairs,
    const LandmarkSurfaces& surfaces);

/// Fails likewise, and where two vertices in a row are not joined by an edge. O(V + degrees).
Result<std::vector<SphereCurve>> curvesOnSurfaces(
    const google::protobuf::RepeatedPtrField<v1::LandmarkCurve>& curves,
    const LandmarkSurfaces& surfaces);

/// Landmarks and points of curves together, pairs of vertices once. Fails as the two above and
/// resampleCurve do.
Result<std::vector<MatchLandmark>> matchLandmarks(
    const google::protobuf::RepeatedPtrField<v1::LandmarkPair>& pairs,
    const google::protobuf::RepeatedPtrField<v1::LandmarkCurve>& curves, const Subject& a,
    const Subject& b);

}  // namespace moduli
