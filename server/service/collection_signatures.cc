#include "server/service/collection_signatures.h"

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

#include "server/service/stored_shape.h"

namespace moduli {
namespace {

constexpr std::size_t kAtOnce = 256;

}  // namespace

Result<std::vector<SignedShape>> signaturesOf(Context& context, const Catalog& catalog,
                                              const std::string& collection, const Filter& filter) {
  const Context::Stage stage(context, "load");
  std::vector<std::int64_t> ids;
  RETURN_IF_ERROR(catalog.scanShapes(context, collection, filter, [&](const ShapeRecord& shape) {
    if (shape.descriptor_version == kDescriptorVersion) ids.push_back(shape.id);
    return ids.size() <= kMostCompared;
  }));
  if (ids.size() > kMostCompared) {
    return Status(Reason::kInvalidOption,
                  "more than " + std::to_string(kMostCompared) + " shapes are to be compared",
                  "name fewer with a filter");
  }
  std::vector<SignedShape> shapes;
  for (std::size_t first = 0; first < ids.size(); first += kAtOnce) {
    RETURN_IF_ERROR(context.check());
    const std::span<const std::int64_t> some(ids.data() + first,
                                             std::min(kAtOnce, ids.size() - first));
    ASSIGN_OR_RETURN(std::vector<ShapeRecord> records,
                     catalog.getShapesById(some, ShapeView::kFull));
    for (ShapeRecord& record : records) {
      Result<StoredSignature> stored = readStored(record);
      if (!stored.ok()) continue;
      shapes.push_back({std::move(record.name), std::move(record.label), std::move(record.digest),
                        std::move(stored->signature)});
    }
  }
  std::sort(shapes.begin(), shapes.end(), [](const SignedShape& a, const SignedShape& b) {
    return std::tie(a.digest, a.name) < std::tie(b.digest, b.name);
  });
  return shapes;
}

}  // namespace moduli
