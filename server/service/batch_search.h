#pragma once

#include <vector>

#include "core/base/context.h"
#include "moduli/v1/catalog.pb.h"
#include "server/service/backend.h"
#include "server/service/call.h"

namespace moduli {

/// What is wrong with a request that shows without a look into the store.
Refusal checkBatchSearch(const v1::BatchSearchShapesRequest& request);

/// The results of the queries of a checked request, in their order. A query whose shape is not
/// there, is damaged or has nothing to compare fails alone. Fails as searchShapesMany.
Result<std::vector<v1::QueryResult>> batchSearch(Context& context, const Backend& backend,
                                                 const v1::BatchSearchShapesRequest& request);

}  // namespace moduli
