#pragma once

#include <optional>

#include "core/base/context.h"
#include "core/mesh/prepare.h"
#include "core/signature/signature.h"

namespace moduli {

struct SignatureOptions {
  std::optional<Space> space;  ///< Only this space and the work that it needs; empty: all three.
};

/// Signature of a connected oriented manifold surface. Type SPHERE for closed genus 0, TORUS for
/// closed genus 1. The metric is the polyhedral one, mollified where faces have no area; it is
/// compared with the canonical one, unit sphere or flat torus, both scaled to area 4 pi.
///
/// Orientation counts: turned inside out, a surface keeps its conformal factor and the power of its
/// mean curvature, the cross spectrum changes sign, and tau becomes -conj(tau). The same holds for
/// a mirror image with the normals kept outwards, but for the cross spectrum, which then stays.
///
/// Fails with kUnsupportedTopology for other topologies (the message states genus and boundary
/// loops), kFoldedMap where the linear sphere map folds, kResidualTooLarge (a sphere map that is
/// not centred to 1e-9, a holomorphic form that does not close to 1e-8 of a mean edge or whose area
/// check fails by more than one half), and as the solvers do. Same input, same bytes; one space has
/// the same bytes alone as among all three. About 4 F, and some 50 ms whatever the size. Source:
/// MATH 3, 8.2 to 8.4.
Result<Signature> computeSignature(Context& context, const PreparedMesh& prepared,
                                   const SignatureOptions& options = {});

}  // namespace moduli
