#pragma once

#include <string>

#include "core/base/context.h"
#include "core/mesh/prepare.h"
#include "moduli/v1/catalog.pb.h"
#include "server/service/backend.h"
#include "server/service/call.h"
#include "server/store/catalog.h"

/// One item of IngestShapes, without the stream around it.
namespace moduli {

/// What holds for all items of a stream.
struct IngestPlan {
  std::string collection;
  OnExists on_exists = OnExists::kSkip;
  PrepareOptions prepare;
};

Refusal checkHeader(const v1::IngestShapesRequest& message);
Refusal checkItem(const v1::IngestShapesRequest& message);

/// Finds or makes the collection. Fails with kCollectionNotFound, kStoreFailure.
Result<IngestPlan> openIngest(const Backend& backend,
                              const v1::IngestShapesRequest::Header& header);

/// Answers a probe: SKIPPED, MISSING, or FAILED.
v1::IngestShapesResponse probeItem(const Backend& backend, const IngestPlan& plan,
                                   const v1::IngestShapesRequest::Item& item);

/// Signs and stores an item. ADDED and REPLACED are said after the shape is on disk; a context that
/// says stop leaves nothing behind.
v1::IngestShapesResponse ingestItem(Context& context, const Backend& backend,
                                    const IngestPlan& plan,
                                    const v1::IngestShapesRequest::Item& item);

/// The outcome of an item that failed.
v1::IngestShapesResponse failedItem(const v1::IngestShapesRequest::Item& item,
                                    const IngestPlan& plan, const Status& status);

}  // namespace moduli
