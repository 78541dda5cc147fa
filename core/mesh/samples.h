#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/mesh/triangle_soup.h"

namespace moduli {

/// One parameter of a sample surface, for help texts.
struct SampleParameter {
  std::string name;
  double default_value = 0;
  std::string meaning;
};

struct SampleKind {
  std::string name;
  std::string meaning;
  std::vector<SampleParameter> parameters;
};

/// The kinds that makeSample knows: sphere, ellipsoid, spheroid, capped-cylinder, torus,
/// diplotorus (flat polyhedral torus), genus, annulus, disk, plate.
const std::vector<SampleKind>& sampleKinds();

/// An analytic surface, triangulated. Every kind takes `resolution`; every kind but diplotorus
/// takes `seed`, which, when not 0, moves vertices within the surface and flips diagonals for an
/// irregular triangulation of the same surface, the same for the same seed on every machine. Closed
/// surfaces are oriented outwards. parameters: by name; missing ones take their default. Fails with
/// kInvalidOption (unknown kind or parameter, value out of range; the hint lists what there is).
/// O(F).
Result<TriangleSoup> makeSample(const std::string& kind,
                                const std::map<std::string, double>& parameters);

}  // namespace moduli
