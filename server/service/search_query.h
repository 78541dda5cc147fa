#pragma once

#include <string>

#include "core/base/context.h"
#include "core/signature/signature.h"
#include "moduli/v1/catalog.pb.h"
#include "server/service/backend.h"
#include "server/service/call.h"
#include "server/store/search.h"

/// From requests to searches of the store, and back.
namespace moduli {

/// What is wrong with a request that shows without a look into the store.
Refusal checkSearch(const v1::SearchShapesRequest& request);

/// Signs the query if it is a mesh, then searches for one page. The request has passed checkSearch.
/// Fails with kIncomparableSignatures where the query has no vector of the space or is of another
/// descriptor version, with kInvalidPageToken for a token of a query or collection that is another
/// one by now, and as signing and searchShapes do.
Result<v1::SearchShapesResponse> search(Context& context, const Backend& backend,
                                        const v1::SearchShapesRequest& request);

/// Looks for the shapes nearest to a signature; what is left to set is collection, k and filter.
/// With `explain` hits tell of their parts (not in conformal space, which has none). Fails with
/// kIncomparableSignatures.
Result<SearchQuery> makeQuery(Signature signature, Space space, bool explain);

/// The signature of a stored shape, by its checked resource name. Fails with kCollectionNotFound,
/// kShapeNotFound, kStoreCorrupt.
Result<Signature> storedSignature(const Catalog& catalog, const std::string& name);

/// The filter's text is sound.
Refusal checkFilter(const std::string& filter);

/// A count of hits is 0, which means the usual, or from 1 to `most`.
Refusal checkHits(int k, int most);

/// Fills a SearchResult or a QueryResult.
template <typename Message>
void fillHits(const SearchAnswer& answer, Message& message) {
  message.set_exact(answer.exact);
  if (answer.recall) message.set_recall(*answer.recall);
  for (const SearchHit& hit : answer.hits) {
    v1::SearchHit& one = *message.add_hits();
    one.set_name(hit.name);
    one.set_label(hit.label);
    one.set_distance(hit.distance);
    for (const SearchPart& part : hit.parts) {
      v1::PartDistance& part_message = *one.add_parts();
      part_message.set_name(std::string(part.name));
      part_message.set_distance(part.distance);
    }
  }
}

}  // namespace moduli
