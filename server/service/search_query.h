#pragma once

#include "core/base/context.h"
#include "moduli/v1/catalog.pb.h"
#include "server/service/backend.h"

namespace moduli {

/// Signs the query if it is a mesh, then searches. The request has passed its checks. Fails with
/// kIncomparableSignatures where the query has no vector of the space or is of another descriptor
/// version, and as signing and searchShapes do.
Result<v1::SearchResult> search(Context& context, const Backend& backend,
                                const v1::SearchShapesRequest& request);

}  // namespace moduli
