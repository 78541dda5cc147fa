#pragma once

#include "core/base/context.h"
#include "moduli/v1/catalog.pb.h"
#include "server/service/backend.h"

namespace moduli {

/// How well a space finds the labels of a collection. The request has passed its checks. Fails as
/// signaturesOf does, and with kInvalidOption where no label is shared. O(n^2) distances.
Result<v1::Evaluation> evaluateCollection(Context& context, const Backend& backend,
                                          const v1::EvaluateCollectionRequest& request);

}  // namespace moduli
