#include "server/service/batch_search.h"

#include <string>
#include <utility>

#include "server/rpc/convert.h"
#include "server/service/request.h"
#include "server/service/search_query.h"
#include "server/store/search.h"

namespace moduli {
namespace {

using Query = v1::BatchSearchShapesRequest::Query;

int hitsOf(const v1::BatchSearchShapesRequest& request) {
  return request.k() == 0 ? kDefaultHits : request.k();
}

Refusal checkCount(const v1::BatchSearchShapesRequest& request) {
  const int count = request.queries_size();
  if (count == 0) {
    return {{Reason::kInvalidRequest, "nothing to search for is given", "set queries"}, "queries"};
  }
  if (count <= kMaxQueries && std::int64_t{count} * hitsOf(request) <= kMaxHits) return {};
  return {{Reason::kInvalidOption,
           std::to_string(count) + " queries of " + std::to_string(hitsOf(request)) +
               " hits are more than " + std::to_string(kMaxQueries) + ", or than " +
               std::to_string(kMaxHits) + " hits in all",
           "split them over several requests"},
          "queries"};
}

Refusal checkQuery(const Query& query, const std::string& field) {
  switch (query.query_case()) {
    case Query::kShape:
      return checkShapeName(query.shape(), field + ".shape");
    case Query::kSignature:
      return {fromProto(query.signature()).status(), field + ".signature"};
    case Query::QUERY_NOT_SET:
      break;
  }
  return {{Reason::kInvalidRequest, "a query is empty", "set one of shape and signature"}, field};
}

Refusal checkQueries(const v1::BatchSearchShapesRequest& request) {
  for (int i = 0; i < request.queries_size(); ++i) {
    Refusal refusal = checkQuery(request.queries(i), "queries[" + std::to_string(i) + "]");
    if (!refusal.ok()) return refusal;
  }
  return {};
}

// Failures that are not the query's own.
bool endsBatch(const Status& status) {
  return status.reason() == Reason::kCancelled || status.reason() == Reason::kDeadlineExceeded ||
         status.reason() == Reason::kStoreFailure;
}

Result<SearchQuery> queryOf(const Catalog& catalog, const Query& message, Space space,
                            bool explain) {
  if (message.has_signature()) {
    ASSIGN_OR_RETURN(Signature signature, fromProto(message.signature()));
    return makeQuery(std::move(signature), space, explain);
  }
  ASSIGN_OR_RETURN(Signature signature, storedSignature(catalog, message.shape()));
  return makeQuery(std::move(signature), space, explain);
}

void fillFailure(const Status& status, v1::QueryResult& result) {
  v1::QueryFailure& failure = *result.mutable_failure();
  failure.set_reason(std::string(reasonName(status.reason())));
  failure.set_message(status.message());
  failure.set_hint(status.hint());
}

}  // namespace

Refusal checkBatchSearch(const v1::BatchSearchShapesRequest& request) {
  return firstOf(checkCollectionName(request.parent(), "parent"),
                 checkHits(request.k(), kMaxHitsAtOnce), checkCount(request),
                 checkSpace(request.space(), "space"), checkFilter(request.filter()),
                 checkQueries(request));
}

Result<std::vector<v1::QueryResult>> batchSearch(Context& context, const Backend& backend,
                                                 const v1::BatchSearchShapesRequest& request) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(request.parent()));
  RETURN_IF_ERROR(catalog->getCollection(collection).status());
  ASSIGN_OR_RETURN(const Filter filter, Filter::parse(request.filter()));
  const Space space = fromProto(request.space()).value_or(Space::kShape);

  std::vector<v1::QueryResult> results(static_cast<std::size_t>(request.queries_size()));
  std::vector<SearchQuery> queries;
  std::vector<std::size_t> places;  // Of the queries among the results.
  for (std::size_t i = 0; i < results.size(); ++i) {
    RETURN_IF_ERROR(context.check());
    const Query& message = request.queries(static_cast<int>(i));
    results[i].set_query(message.shape());
    Result<SearchQuery> query = queryOf(*catalog, message, space, request.explain());
    if (!query.ok()) {
      if (endsBatch(query.status())) return query.status();
      fillFailure(query.status(), results[i]);
      continue;
    }
    query->collection = collection;
    query->filter = filter;
    query->k = static_cast<std::size_t>(hitsOf(request));
    queries.push_back(*std::move(query));
    places.push_back(i);
  }
  const Context::Stage stage(context, "search");
  ASSIGN_OR_RETURN(const std::vector<SearchAnswer> answers,
                   searchShapesMany(context, *catalog, *backend.indexes, queries));
  for (std::size_t i = 0; i < answers.size(); ++i) fillHits(answers[i], results[places[i]]);
  return results;
}

}  // namespace moduli
