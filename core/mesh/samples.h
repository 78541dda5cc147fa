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

/// An analytic surface, triangulated:
///
///   makeSample("torus", {{"R", 2}, {"r", 1}, {"resolution", 32}, {"seed", 7}})
///
/// Every kind takes `resolution`; every kind but diplotorus takes `seed`, which, when not 0, moves
/// vertices within the surface and flips diagonals for an irregular triangulation of the same
/// surface, the same for the same seed on every machine. Closed surfaces are oriented outwards.
/// parameters: by name; missing ones take their default. Fails with kInvalidOption (unknown kind or
/// parameter, value out of range, more than 5e7 faces; the hint lists what there is). resolution r
/// gives: sphere, ellipsoid, spheroid 20 r^2 faces (an icosahedron's edges cut in r); torus a 2r x
/// r grid; annulus r rows of nearly square cells; disk 6 r^2 faces; plate 4 r^2 a cell;
/// capped-cylinder r rows a cap; diplotorus and genus r parts of each edge of the polyhedron they
/// start from (genus: rounded up to a power of two; its vertices lie on one smooth surface). O(F).
Result<TriangleSoup> makeSample(const std::string& kind,
                                const std::map<std::string, double>& parameters);

}  // namespace moduli
