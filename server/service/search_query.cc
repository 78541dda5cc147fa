#include "server/service/search_query.h"

#include <memory>
#include <string>
#include <utility>

#include "core/signature/descriptor.h"
#include "core/signature/distance.h"
#include "server/rpc/convert.h"
#include "server/service/request.h"
#include "server/service/signing.h"
#include "server/service/stored_shape.h"
#include "server/store/search.h"

namespace moduli {
namespace {

Result<Signature> querySignature(Context& context, const Backend& backend, const Catalog& catalog,
                                 const v1::SearchShapesRequest& request, Space space) {
  if (request.has_signature()) return fromProto(request.signature());
  if (request.has_shape()) {
    ASSIGN_OR_RETURN(const ShapePath path, parseShapeName(request.shape()));
    ASSIGN_OR_RETURN(const ShapeRecord record,
                     catalog.getShape(path.collection, path.shape, ShapeView::kFull));
    ASSIGN_OR_RETURN(StoredSignature stored, readStored(record));
    return std::move(stored.signature);
  }
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

Status comparable(const Signature& signature, Space space) {
  if (signature.descriptor_version != kDescriptorVersion) {
    return {Reason::kIncomparableSignatures,
            "the query is of descriptor version " + std::to_string(signature.descriptor_version) +
                ", the store of version " + std::to_string(kDescriptorVersion),
            "sign the surface anew; the server does so with its stored shapes by itself"};
  }
  const bool typed = space != Space::kConformal || signature.conformal;
  if (vectorOf(signature.vectors, space).empty() || !typed) {
    return {Reason::kIncomparableSignatures, "the query has no numbers of the asked space",
            "search in another space (--space)"};
  }
  return {};
}

/// Tells which parts of the query's vector the hits agree with.
Status explain(const Catalog& catalog, const SearchQuery& query, const SearchAnswer& answer,
               v1::SearchResult& result) {
  for (std::size_t i = 0; i < answer.hits.size(); ++i) {
    const std::int64_t id = answer.hits[i].id;
    ASSIGN_OR_RETURN(const std::vector<ShapeRecord> records,
                     catalog.getShapesById({&id, 1}, ShapeView::kFull));
    if (records.empty()) continue;  // Removed meanwhile.
    ASSIGN_OR_RETURN(const StoredSignature stored, readStored(records.front()));
    const std::vector<float>& own = vectorOf(stored.signature.vectors, query.space);
    for (const FamilyDistance& part : familyDistances(query.vector, own)) {
      v1::PartDistance& message = *result.mutable_hits(static_cast<int>(i))->add_parts();
      message.set_name(std::string(part.name));
      message.set_distance(part.distance);
    }
  }
  return {};
}

}  // namespace

Result<v1::SearchResult> search(Context& context, const Backend& backend,
                                const v1::SearchShapesRequest& request) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  SearchQuery query;
  ASSIGN_OR_RETURN(query.collection, parseCollectionName(request.parent()));
  RETURN_IF_ERROR(catalog->getCollection(query.collection).status());
  ASSIGN_OR_RETURN(query.filter, Filter::parse(request.filter()));
  query.space = fromProto(request.space()).value_or(Space::kShape);
  query.k = static_cast<std::size_t>(request.k() == 0 ? kDefaultHits : request.k());

  ASSIGN_OR_RETURN(const Signature signature,
                   querySignature(context, backend, *catalog, request, query.space));
  RETURN_IF_ERROR(comparable(signature, query.space));
  if (signature.conformal) query.type = conformalTypeName(signature.conformal->type);
  query.vector = vectorOf(signature.vectors, query.space);
  query.distance = [&signature, space = query.space](
                       const ShapeRecord& record) -> Result<std::optional<double>> {
    ASSIGN_OR_RETURN(const StoredSignature stored, readStored(record));
    return signatureDistance(signature, stored.signature, space);
  };

  Context::Stage stage(context, "search");
  ASSIGN_OR_RETURN(const SearchAnswer answer,
                   searchShapes(context, *catalog, *backend.indexes, query));
  v1::SearchResult result;
  result.set_exact(answer.exact);
  for (const SearchHit& hit : answer.hits) {
    v1::SearchHit& one = *result.add_hits();
    one.set_name(hit.name);
    one.set_label(hit.label);
    one.set_distance(hit.distance);
  }
  if (request.explain() && query.space != Space::kConformal) {
    RETURN_IF_ERROR(explain(*catalog, query, answer, result));
  }
  return result;
}

}  // namespace moduli
