#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"

/// Hard cases for the Ricci solver, made of sound surfaces by what is legal and unkind.
namespace moduli::stress {

/// A closed surface as the solver takes it.
struct Surface {
  std::string name;
  Connectivity connectivity;
  std::vector<double> lengths;  ///< Per edge; triangles may be broken where flips are Ptolemy's.
};

/// What is done to it; each by its own draw from the seed.
struct Case {
  Surface surface;
  std::vector<double> target;  ///< Per vertex, admissible.
  bool hyperbolic = false;
  bool punctured = false;         ///< A sphere without cones: through infinity.
  bool initial_delaunay = false;  ///< Only where triangles are sound.
  std::string description;        ///< To repeat it by hand.
};

/// Reads the closed connected surface of a mesh file. Fails where it is none.
Result<Surface> readSurface(Context& context, const std::string& path);

/// Vertices put next to corners and edges (needles down to 1e-6), random Ptolemy flips, vertex
/// scaling by up to e^{+-3}, and up to 5 cones: some of them, by the seed.
Case makeCase(const Surface& surface, std::uint64_t seed);

/// What the solver did.
struct Outcome {
  Status status;
  double residual = 0;
  int iterations = 0;
  int flips = 0;
};

Outcome solve(Context& context, const Case& problem);

}  // namespace moduli::stress
