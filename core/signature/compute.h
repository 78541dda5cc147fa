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
/// closed genus 1. Fails with kUnsupportedTopology for other topologies (the message states genus
/// and boundary loops), kFoldedMap where the linear sphere map folds, and as the solvers do.
/// Same input, same bytes. About 4 F. Source: MATH 3, 8.2 to 8.5.
Result<Signature> computeSignature(Context& context, const PreparedMesh& prepared,
                                   const SignatureOptions& options = {});

}  // namespace moduli
