#include "server/store/candidate_shapes.h"

#include <algorithm>
#include <utility>

#include "core/base/log.h"
#include "core/base/parallel.h"

namespace moduli {
namespace {

constexpr std::size_t kAtOnce = 256;  // Records with all their bytes in memory.
constexpr std::size_t kGrain = 16;

bool endsSearch(const Status& status) {
  return status.reason() == Reason::kCancelled || status.reason() == Reason::kDeadlineExceeded;
}

}  // namespace

Result<CandidateShapes::Shapes> CandidateShapes::get(Context& context,
                                                     std::span<const std::int64_t> ids) {
  Shapes shapes;
  std::vector<std::int64_t> unknown;
  for (const std::int64_t id : ids) {
    if (const auto found = known_.find(id); found != known_.end()) {
      shapes.push_back(found->second);
    } else {
      unknown.push_back(id);
    }
  }
  if (known_.size() + unknown.size() > remember_) {
    known_.clear();
    for (const auto& shape : shapes) keep(shape);
  }
  for (std::size_t i = 0; i < unknown.size(); i += kAtOnce) {
    RETURN_IF_ERROR(readInto(
        context, std::span(unknown).subspan(i, std::min(kAtOnce, unknown.size() - i)), shapes));
  }
  return shapes;
}

Status CandidateShapes::readInto(Context& context, std::span<const std::int64_t> ids,
                                 Shapes& shapes) {
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(std::vector<ShapeRecord> records, catalog_.getShapesById(ids, ShapeView::kFull));
  std::vector<std::shared_ptr<CandidateShape>> fresh(records.size());
  parallelBlocks(records.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ShapeRecord& record = records[i];
      fresh[i] = std::make_shared<CandidateShape>();
      Result<Signature> signature = read_(record);
      fresh[i]->status = signature.status();
      if (signature.ok()) fresh[i]->signature = *std::move(signature);
      fresh[i]->id = record.id;
      fresh[i]->name = std::move(record.name);
      fresh[i]->label = std::move(record.label);
    }
  });
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    const Status& status = fresh[i]->status;
    if (endsSearch(status)) return status;
    if (!status.ok()) {
      log(LogLevel::kWarning, "shape \"" + fresh[i]->name + "\" of collection \"" +
                                  records[i].collection +
                                  "\" cannot be compared: " + status.toString());
    }
    shapes.push_back(fresh[i]);
    keep(fresh[i]);
  }
  return {};
}

void CandidateShapes::keep(const std::shared_ptr<const CandidateShape>& shape) {
  if (known_.size() < remember_) known_.emplace(shape->id, shape);
}

}  // namespace moduli
