#pragma once

#include "core/optimize/minimize.h"
#include "core/optimize/named_objectives.h"
#include "core/ricci/scheme.h"
#include "moduli/v1/optimize.pb.h"

/// Minimizations as messages of the public API and back. Pure; O(size of the value).
namespace moduli {

/// Of a checked request. What is unspecified has its default; inverses of Hessians are taken on
/// their pattern by the sparse factor.
MinimizeOptions fromProto(const v1::MinimizeOptions& options);

/// The test function of a checked request: with as many unknowns as its points have, unless it says
/// so itself.
ObjectiveOptions objectiveOptions(const v1::MinimizeRequest& request);

Scheme fromProto(v1::ParameterizationOptions::Scheme scheme);

v1::MinimizeOptions::Method toProto(MinimizeMethod method);

/// All but the point.
v1::Minimization toProto(const Minimum& minimum);

}  // namespace moduli
