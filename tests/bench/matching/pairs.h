#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/triangle_mesh.h"
#include "core/mesh/triangle_soup.h"

/// Pairs of surfaces of which it is known where each point of one is on the other.
namespace moduli {

/// A connected surface.
struct MatchBase {
  std::string name;
  TriangleSoup soup;
};

/// A surface and another one made of it.
struct KnownPair {
  std::string name;  ///< The base's.
  std::string kind;
  TriangleMesh a, b;
  /// Per vertex of a its place on b, or right beside it where b has other vertices.
  std::vector<Eigen::Vector3d> truth;
};

/// Names of all kinds of pairs, in the order of makePairs: what b is.
///
/// articulated: limbs turned by 25 to 40 degrees, simplified to 70 % of the faces; remeshed:
/// simplified to half; inverted: by a Möbius map of space, renumbered; copy: turned, scaled, moved
/// and renumbered.
const std::vector<std::string>& matchKinds();

struct PairOptions {
  std::size_t seed = 1;
  /// Deviation of Gaussian errors of b's vertices, a share of the root of b's area.
  double noise = 0;
};

/// The connected meshes among all of $MODULI_SHARED/meshes but those in bad/
/// (tests/core/testing.h), in the order of their paths. max_faces: larger ones are simplified to
/// this.
std::vector<MatchBase> sharedBases(Context& context, std::size_t max_faces);

/// One mesh file. Fails as the readers and prepareMesh do.
Result<MatchBase> readBase(Context& context, const std::string& path, std::size_t max_faces);

/// The pair of one kind; the same on every machine with the same arithmetic. Fails with
/// kInvalidOption (no such kind), and with the reason for which a variant is no manifold.
Result<KnownPair> makePair(const MatchBase& base, const std::string& kind,
                           const PairOptions& options = {});

}  // namespace moduli
