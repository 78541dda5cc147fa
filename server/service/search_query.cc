#include "server/service/search_query.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "core/signature/conformal_vector.h"
#include "core/signature/descriptor.h"
#include "core/signature/distance.h"
#include "server/rpc/convert.h"
#include "server/service/request.h"
#include "server/service/signing.h"
#include "server/service/stored_shape.h"
#include "server/store/search_page.h"

namespace moduli {
namespace {

Result<Signature> querySignature(Context& context, const Backend& backend, const Catalog& catalog,
                                 const v1::SearchShapesRequest& request, Space space) {
  if (request.has_signature()) return fromProto(request.signature());
  if (request.has_shape()) return storedSignature(catalog, request.shape());
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, request.source()));
  SignatureOptions options;
  options.space = space;
  return signMesh(context, backend, file, fromProto(request.prepare()), options);
}

const std::vector<float>& vectorOf(const SearchVectors& vectors, Space space) {
  switch (space) {
    case Space::kConformal:
      return vectors.conformal;
    case Space::kMetric:
      return vectors.metric;
    case Space::kShape:
      break;
  }
  return vectors.shape;
}

// Numbers that a vector of a sound signature has.
std::size_t lengthOf(const Signature& signature, Space space) {
  if (space == Space::kMetric) return kMetricLength;
  if (space == Space::kShape) return kShapeLength;
  return conformalVectorLength(signature.conformal->type);
}

Status comparable(const Signature& signature, Space space) {
  if (signature.descriptor_version != kDescriptorVersion) {
    return {Reason::kIncomparableSignatures,
            "the query is of descriptor version " + std::to_string(signature.descriptor_version) +
                ", the store of version " + std::to_string(kDescriptorVersion),
            "sign the surface anew; the server does so with its stored shapes by itself"};
  }
  const bool typed = space != Space::kConformal || signature.conformal;
  const std::vector<float>& vector = vectorOf(signature.vectors, space);
  if (vector.empty() || !typed) {
    return {Reason::kIncomparableSignatures, "the query has no numbers of the asked space",
            "search in another space (--space)"};
  }
  if (const std::size_t length = lengthOf(signature, space); vector.size() != length) {
    return {Reason::kIncomparableSignatures,
            "the query has " + std::to_string(vector.size()) + " numbers of the asked space, not " +
                std::to_string(length),
            "give a signature as ComputeSignature returns it"};
  }
  return {};
}

// Without the large parts that no distance looks at: they would fill the memory of a batch.
Result<Signature> readForComparing(const ShapeRecord& record) {
  ASSIGN_OR_RETURN(StoredSignature stored, readStored(record));
  Signature& signature = stored.signature;
  signature.metric.reset();
  signature.shape.reset();
  signature.timing.clear();
  signature.certificate.warnings.clear();
  if (signature.conformal) signature.conformal->generators = {};
  return std::move(signature);
}

// The same bytes for the same request; pages may differ in their size.
std::string tokenRequest(const v1::SearchShapesRequest& request) {
  v1::SearchShapesRequest same = request;
  same.clear_page_size();
  same.clear_page_token();
  std::string text;
  {
    google::protobuf::io::StringOutputStream stream(&text);
    google::protobuf::io::CodedOutputStream out(&stream);
    out.SetSerializationDeterministic(true);
    same.SerializeToCodedStream(&out);
  }
  return text;
}

std::string tokenState(const CollectionRecord& collection, const SearchQuery& query) {
  std::string text = std::to_string(collection.id) + "/" +
                     std::to_string(query.descriptor_version) + "/" + query.type + "/";
  text.append(reinterpret_cast<const char*>(query.vector.data()),
              query.vector.size() * sizeof(float));
  return text;
}

Refusal checkQuery(const v1::SearchShapesRequest& request) {
  switch (request.query_case()) {
    case v1::SearchShapesRequest::kSource:
      return checkSource(request.source(), "source");
    case v1::SearchShapesRequest::kShape:
      return checkShapeName(request.shape(), "shape");
    case v1::SearchShapesRequest::kSignature:
      return {fromProto(request.signature()).status(), "signature"};
    case v1::SearchShapesRequest::QUERY_NOT_SET:
      break;
  }
  return {{Reason::kInvalidRequest, "nothing to search for is given",
           "set one of source, shape and signature"},
          "query"};
}

}  // namespace

Refusal checkFilter(const std::string& filter) {
  return {Filter::parse(filter).status(), "filter"};
}

Refusal checkHits(int k, int most) {
  if (k >= 0 && k <= most) return {};
  return {{Reason::kInvalidOption,
           "k is " + std::to_string(k) + ", not in 1 to " + std::to_string(most),
           k < 0 ? "give 0 for the usual number of hits" : "ask for fewer hits"},
          "k"};
}

Refusal checkSearch(const v1::SearchShapesRequest& request) {
  Refusal token;
  if (!request.page_token().empty()) {
    token = {checkSearchToken(tokenRequest(request), request.page_token()), "page_token"};
  }
  return firstOf(checkCollectionName(request.parent(), "parent"), checkQuery(request),
                 checkHits(request.k(), kMaxHits), checkSpace(request.space(), "space"),
                 checkPrepare(request.prepare(), "prepare"), checkFilter(request.filter()),
                 checkPageSize(request.page_size()), token);
}

Result<Signature> storedSignature(const Catalog& catalog, const std::string& name) {
  ASSIGN_OR_RETURN(const ShapePath path, parseShapeName(name));
  ASSIGN_OR_RETURN(const ShapeRecord record,
                   catalog.getShape(path.collection, path.shape, ShapeView::kFull));
  ASSIGN_OR_RETURN(StoredSignature stored, readStored(record));
  return std::move(stored.signature);
}

Result<SearchQuery> makeQuery(Signature signature, Space space, bool explain) {
  RETURN_IF_ERROR(comparable(signature, space));
  const auto own = std::make_shared<const Signature>(std::move(signature));
  SearchQuery query;
  query.space = space;
  if (own->conformal) query.type = conformalTypeName(own->conformal->type);
  query.vector = vectorOf(own->vectors, space);
  query.read = readForComparing;
  query.distance = [own, space](const Signature& shape) {
    return signatureDistance(*own, shape, space);
  };
  if (explain && space != Space::kConformal) {
    query.explain = [own, space](const Signature& shape) {
      std::vector<SearchPart> parts;
      for (const FamilyDistance& part :
           familyDistances(vectorOf(own->vectors, space), vectorOf(shape.vectors, space))) {
        parts.push_back({part.name, part.distance});
      }
      return parts;
    };
  }
  return query;
}

Result<v1::SearchShapesResponse> search(Context& context, const Backend& backend,
                                        const v1::SearchShapesRequest& request) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string name, parseCollectionName(request.parent()));
  ASSIGN_OR_RETURN(const CollectionRecord collection, catalog->getCollection(name));
  const Space space = fromProto(request.space()).value_or(Space::kShape);
  ASSIGN_OR_RETURN(Signature signature, querySignature(context, backend, *catalog, request, space));
  ASSIGN_OR_RETURN(SearchQuery query, makeQuery(std::move(signature), space, request.explain()));
  query.collection = name;
  ASSIGN_OR_RETURN(query.filter, Filter::parse(request.filter()));

  std::size_t left = static_cast<std::size_t>(request.k() == 0 ? kDefaultHits : request.k());
  const std::string same_request = tokenRequest(request);
  const std::string state = tokenState(collection, query);
  if (!request.page_token().empty()) {
    ASSIGN_OR_RETURN(query.after, readSearchToken(same_request, state, request.page_token()));
    left -= std::min(left, query.after->count);
    if (left == 0) return Status(Reason::kInvalidPageToken, "no page follows the last one");
  }
  const int size = request.page_size() == 0 ? kMaxHitsAtOnce : request.page_size();
  query.k =
      std::min({left, static_cast<std::size_t>(size), static_cast<std::size_t>(kMaxHitsAtOnce)});

  Context::Stage stage(context, "search");
  ASSIGN_OR_RETURN(const SearchAnswer answer,
                   searchShapes(context, *catalog, *backend.indexes, query));
  v1::SearchShapesResponse response;
  fillHits(answer, *response.mutable_result());
  if (answer.more && answer.hits.size() < left) {
    const std::size_t before = query.after ? query.after->count : 0;
    const SearchHit& last = answer.hits.back();
    response.set_next_page_token(makeSearchToken(
        same_request, state, {last.distance, last.name, before + answer.hits.size()}));
  }
  return response;
}

}  // namespace moduli
