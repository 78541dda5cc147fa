#pragma once

#include "core/base/context.h"
#include "moduli/v1/catalog.pb.h"
#include "server/service/backend.h"

namespace moduli {

/// Shapes of a collection that are the same up to a distance. The request has passed its checks.
/// Fails as signaturesOf does. O(n^2) distances.
Result<v1::Duplicates> findDuplicates(Context& context, const Backend& backend,
                                      const v1::FindDuplicatesRequest& request);

}  // namespace moduli
