#include "client/cli/search_batch.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/ingest_files.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/output.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/report.h"

namespace moduli::cli {
namespace {

using Query = v1::BatchSearchShapesRequest::Query;

/// One of many shapes to look for: its name for people, and either a query or why there is none.
struct BatchItem {
  std::string name;
  Status status;
  Query query;
};

BatchItem storedItem(const std::string& collection, const std::string& id) {
  BatchItem item{id, {}, {}};
  item.query.set_shape(shapeName(collection, id));
  return item;
}

Result<Query> signedQuery(Client& client, const MeshArgument& mesh, const Arguments& arguments) {
  v1::ComputeSignatureRequest request;
  ASSIGN_OR_RETURN(*request.mutable_source(), mesh.source(client));
  *request.mutable_prepare() = prepareOf(arguments);
  const v1::Signature::Space space = spaceOf(arguments);
  request.set_space(space == v1::Signature::SPACE_UNSPECIFIED ? v1::Signature::SHAPE : space);
  Query query;
  ASSIGN_OR_RETURN(*query.mutable_signature(), client.computeSignature(request));
  return query;
}

Result<Query> meshQuery(Session& session, Client& client, const std::string& word,
                        const Arguments& arguments) {
  ASSIGN_OR_RETURN(const MeshArgument mesh,
                   MeshArgument::open(session, word, arguments.text("format")));
  if (!mesh.stored()) return signedQuery(client, mesh, arguments);
  Query query;
  query.set_shape(mesh.resource());
  return query;
}

/// Failures that would be those of every other query, too.
bool endsRun(const Status& status) {
  switch (status.reason()) {
    case Reason::kCancelled:
    case Reason::kDeadlineExceeded:
    case Reason::kServerUnreachable:
    case Reason::kServerTooOld:
    case Reason::kServerDraining:
    case Reason::kUnauthenticated:
    case Reason::kPermissionDenied:
      return true;
    default:
      return false;
  }
}

Result<std::vector<BatchItem>> itemsOf(Session& session, Client& client,
                                       const Arguments& arguments) {
  const std::string collection = arguments.text("collection");
  std::vector<BatchItem> items;
  if (arguments.has("all")) {
    Pager<v1::Shape> shapes = client.listShapes(collectionName(collection), "");
    while (true) {
      ASSIGN_OR_RETURN(const std::optional<v1::Shape> shape, shapes.next());
      if (!shape) return items;
      items.push_back(storedItem(collection, idOf(shape->name())));
    }
  }
  for (const std::string& id : arguments.all("id")) items.push_back(storedItem(collection, id));
  std::vector<std::string> words = arguments.all("MESH");
  if (arguments.has("from-file")) {
    ASSIGN_OR_RETURN(const std::vector<std::string> more,
                     readPathList(arguments.text("from-file")));
    words.insert(words.end(), more.begin(), more.end());
  }
  for (const std::string& word : words) {
    Result<Query> query = meshQuery(session, client, word, arguments);
    if (!query.ok() && endsRun(query.status())) return session.explain(word, query.status());
    items.push_back({word, query.status(), query.ok() ? *std::move(query) : Query()});
  }
  return items;
}

Result<std::vector<v1::QueryResult>> ask(Client& client, const std::vector<BatchItem>& items,
                                         const Arguments& arguments) {
  v1::BatchSearchShapesRequest request;
  request.set_parent(collectionName(arguments.text("collection")));
  request.set_k(arguments.integer("k", 0));
  request.set_space(spaceOf(arguments));
  request.set_filter(arguments.text("filter"));
  request.set_explain(arguments.has("explain"));
  for (const BatchItem& item : items) {
    if (item.status.ok()) *request.add_queries() = item.query;
  }
  ASSIGN_OR_RETURN(std::vector<v1::QueryResult> answers, client.searchMany(request));
  std::vector<v1::QueryResult> results(items.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].status.ok()) {
      results[i] = std::move(answers[next++]);
    } else {
      v1::QueryFailure& failure = *results[i].mutable_failure();
      failure.set_reason(std::string(reasonName(items[i].status.reason())));
      failure.set_message(items[i].status.message());
      failure.set_hint(items[i].status.hint());
    }
    results[i].set_query(items[i].name);
  }
  return results;
}

Result<std::string> jsonOf(const std::vector<v1::QueryResult>& results) {
  JsonWriter json;
  json.open("{").key("results").open("[");
  for (const v1::QueryResult& result : results) {
    ASSIGN_OR_RETURN(const std::string text, toJson(result));
    json.document(text);
  }
  json.close("]").close("}");
  return json.finish();
}

Status statusOf(const v1::QueryFailure& failure) {
  return {reasonFromName(failure.reason()), failure.message(), failure.hint()};
}

/// The failure that stands for all of them; OK if no query failed.
Status failureOf(const std::vector<v1::QueryResult>& results) {
  int failures = 0;
  const v1::QueryResult* first = nullptr;
  for (const v1::QueryResult& result : results) {
    if (!result.has_failure()) continue;
    ++failures;
    if (first == nullptr) first = &result;
  }
  if (first == nullptr) return {};
  const Status status = about(first->query(), statusOf(first->failure()));
  return status.withContext(std::to_string(failures) + " of " +
                            counted(static_cast<long long>(results.size()), "query", "queries") +
                            " failed");
}

}  // namespace

bool isBatch(const Arguments& arguments) {
  return arguments.has("all") || arguments.has("from-file") ||
         arguments.all("MESH").size() + arguments.all("id").size() > 1;
}

Status runSearchBatch(Session& session, const Arguments& arguments) {
  const std::string collection = arguments.text("collection");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const Result<std::vector<BatchItem>> items = itemsOf(session, *client, arguments);
  if (!items.ok()) return session.explain(collection, items.status());
  const Result<std::vector<v1::QueryResult>> results = ask(*client, *items, arguments);
  if (!results.ok()) return session.explain(collection, results.status());
  if (session.json()) {
    ASSIGN_OR_RETURN(const std::string text, jsonOf(*results));
    RETURN_IF_ERROR(session.print(text));
  } else if (session.talks()) {
    RETURN_IF_ERROR(session.print(batchReport(*results)));
  }
  return failureOf(*results);
}

}  // namespace moduli::cli
