#include "server/service/ingest_item.h"

#include <optional>
#include <utility>

#include "core/base/digest.h"
#include "core/base/text.h"
#include "server/rpc/convert.h"
#include "server/rpc/grpc_status.h"
#include "server/service/request.h"
#include "server/service/signing.h"
#include "server/service/stored_shape.h"

namespace moduli {
namespace {

using Header = v1::IngestShapesRequest::Header;
using Item = v1::IngestShapesRequest::Item;
using Outcome = v1::IngestShapesResponse;

// Longer words would fill the outcomes of a long stream for nothing.
constexpr std::size_t kMessageLimit = 2000;

Outcome makeOutcome(const Item& item, const IngestPlan& plan, Outcome::Outcome what) {
  Outcome outcome;
  outcome.set_index(item.index());
  outcome.set_name(shapeName(plan.collection, item.shape_id()));
  outcome.set_outcome(what);
  return outcome;
}

Outcome skipped(const Item& item, const IngestPlan& plan, const std::string& message) {
  Outcome outcome = makeOutcome(item, plan, Outcome::SKIPPED);
  outcome.set_reason(std::string(reasonName(Reason::kShapeExists)));
  outcome.set_message(message);
  return outcome;
}

Outcome sameSkipped(const Item& item, const IngestPlan& plan) {
  return skipped(item, plan, "the same file is stored under this name already");
}

Outcome otherSkipped(const Item& item, const IngestPlan& plan) {
  return skipped(item, plan, "another file is stored under this name and was kept");
}

Status shapeExists(const Item& item) {
  return {Reason::kShapeExists, "another file is stored under the name " + item.shape_id(),
          "choose another name, or --on-exists skip or replace"};
}

/// What the store has under a name, and what follows for a file.
struct Existing {
  std::optional<ShapeRecord> record;

  bool same(std::string_view digest) const { return record && record->digest == digest; }
  bool current() const { return record && record->descriptor_version == kDescriptorVersion; }
};

Result<Existing> lookUp(const Catalog& catalog, const IngestPlan& plan, const Item& item) {
  Result<ShapeRecord> record =
      catalog.getShape(plan.collection, item.shape_id(), ShapeView::kSummary);
  if (record.ok()) return Existing{*std::move(record)};
  if (record.status().reason() == Reason::kShapeNotFound) return Existing{};
  return record.status();
}

/// The outcome that is clear before any computing; nothing if the mesh has to be signed.
std::optional<Outcome> settled(const Existing& existing, const IngestPlan& plan, const Item& item,
                               std::string_view digest) {
  if (!existing.record) return {};
  if (existing.same(digest)) {
    if (existing.current()) return sameSkipped(item, plan);
    return {};  // Signed by another version: to be signed anew.
  }
  switch (plan.on_exists) {
    case OnExists::kSkip:
      return otherSkipped(item, plan);
    case OnExists::kError:
      return failedItem(item, plan, shapeExists(item));
    case OnExists::kReplace:
      break;
  }
  return {};
}

/// Keeps the file in the mesh store while its row is written.
Result<MeshPin> keepMesh(const Backend& backend, const Item& item, const std::string& digest,
                         const std::string& bytes) {
  MeshStore& meshes = backend.store->meshes();
  if (!item.source().has_inline_()) {
    Result<MeshPin> pin = meshes.pin(digest);
    if (pin.ok()) return pin;
  }
  return meshes.put(bytes);
}

Outcome outcomeOf(const PutResult& put, const IngestPlan& plan, const Item& item,
                  std::string_view digest) {
  switch (put.outcome) {
    case PutOutcome::kAdded:
      return makeOutcome(item, plan, Outcome::ADDED);
    case PutOutcome::kReplaced:
      return makeOutcome(item, plan, Outcome::REPLACED);
    case PutOutcome::kSkipped:
      break;
  }
  return put.existing_digest == digest ? sameSkipped(item, plan) : otherSkipped(item, plan);
}

Result<ShapeRecord> signRecord(Context& context, const Backend& backend, const IngestPlan& plan,
                               const Item& item, const MeshFile& file) {
  ASSIGN_OR_RETURN(Signature signature, signMesh(context, backend, file, plan.prepare, {}));
  ShapeRecord record;
  record.collection = plan.collection;
  record.name = item.shape_id();
  record.label = item.label();
  record.tags.insert(item.tags().begin(), item.tags().end());
  record.format =
      file.format ? *file.format : detectFormat(file.bytes, file.name).value_or(MeshFormat::kObj);
  record.file_name = item.source().file_name();
  record.mesh_bytes = static_cast<std::int64_t>(file.bytes.size());
  fillRecord({std::move(signature), plan.prepare}, record);
  return record;
}

Result<Outcome> ingest(Context& context, const Backend& backend, const IngestPlan& plan,
                       const Item& item) {
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, item.source()));
  const std::string digest = sha256Hex(file.bytes);
  ASSIGN_OR_RETURN(const Existing existing, lookUp(*catalog, plan, item));
  if (std::optional<Outcome> outcome = settled(existing, plan, item, digest)) return *outcome;

  ASSIGN_OR_RETURN(ShapeRecord record, signRecord(context, backend, plan, item, file));
  record.digest = digest;
  ASSIGN_OR_RETURN(const MeshPin pin, keepMesh(backend, item, digest, file.bytes));
  RETURN_IF_ERROR(context.check());  // The last moment at which nothing has been stored.
  std::optional<std::int64_t> outdated;
  if (existing.same(digest)) outdated = existing.record->id;
  ASSIGN_OR_RETURN(const PutResult put, catalog->putShape(record, plan.on_exists, outdated));
  RETURN_IF_ERROR(backend.indexes->refresh());
  return outcomeOf(put, plan, item, digest);
}

}  // namespace

Refusal checkHeader(const v1::IngestShapesRequest& message) {
  if (!message.has_header()) {
    return {{Reason::kInvalidRequest, "the first message is not the header",
             "send the header before the items"},
            "header"};
  }
  const Header& header = message.header();
  if (!v1::IngestShapesRequest::OnExists_IsValid(header.on_exists())) {
    return {
        {Reason::kInvalidOption, "on_exists has an unknown value", "give SKIP, REPLACE or ERROR"},
        "header.on_exists"};
  }
  return firstOf(checkCollectionName(header.parent(), "header.parent"),
                 checkPrepare(header.prepare(), "header.prepare"));
}

Refusal checkItem(const v1::IngestShapesRequest& message) {
  if (!message.has_item()) {
    return {{Reason::kInvalidRequest, "a message after the header is not an item",
             "send one header and then items"},
            "item"};
  }
  const Item& item = message.item();
  if (Status status = validateShapeName(item.shape_id()); !status.ok()) {
    return {std::move(status), "item.shape_id"};
  }
  if (!item.probe_digest().empty()) return checkDigest(item.probe_digest(), "item.probe_digest");
  return checkSource(item.source(), "item.source");
}

Result<IngestPlan> openIngest(const Backend& backend, const Header& header) {
  IngestPlan plan;
  ASSIGN_OR_RETURN(plan.collection, parseCollectionName(header.parent()));
  plan.prepare = fromProto(header.prepare());
  if (header.on_exists() == v1::IngestShapesRequest::REPLACE) plan.on_exists = OnExists::kReplace;
  if (header.on_exists() == v1::IngestShapesRequest::ERROR) plan.on_exists = OnExists::kError;
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  Status status = catalog->getCollection(plan.collection).status();
  if (status.reason() == Reason::kCollectionNotFound && header.create_collection()) {
    status = catalog->createCollection(plan.collection, "").status();
    // Another stream was quicker.
    if (status.reason() == Reason::kCollectionExists) status = Status();
  }
  RETURN_IF_ERROR(status);
  return plan;
}

Outcome failedItem(const Item& item, const IngestPlan& plan, const Status& status) {
  Outcome outcome = makeOutcome(item, plan, Outcome::FAILED);
  outcome.set_reason(std::string(reasonName(status.reason())));
  outcome.set_message(printable(status.message(), kMessageLimit));
  outcome.set_hint(printable(status.hint(), kMessageLimit));
  return outcome;
}

Outcome probeItem(const Backend& backend, const IngestPlan& plan, const Item& item) {
  const Result<Outcome> outcome = guarded([&]() -> Result<Outcome> {
    ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
    ASSIGN_OR_RETURN(const Existing existing, lookUp(*catalog, plan, item));
    return settled(existing, plan, item, item.probe_digest())
        .value_or(makeOutcome(item, plan, Outcome::MISSING));
  });
  return outcome.ok() ? *outcome : failedItem(item, plan, outcome.status());
}

Outcome ingestItem(Context& context, const Backend& backend, const IngestPlan& plan,
                   const Item& item) {
  const Result<Outcome> outcome =
      guarded([&]() -> Result<Outcome> { return ingest(context, backend, plan, item); });
  return outcome.ok() ? *outcome : failedItem(item, plan, outcome.status());
}

}  // namespace moduli
