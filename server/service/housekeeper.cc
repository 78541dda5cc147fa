#include "server/service/housekeeper.h"

#include <algorithm>

#include "core/base/log.h"
#include "server/service/call.h"
#include "server/service/signing.h"
#include "server/service/stored_shape.h"

namespace moduli {
namespace {

constexpr std::size_t kBatch = 16;

}  // namespace

Status signAnew(Context& context, const Backend& backend, const ShapeName& name) {
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(Catalog* const catalog, backend.catalog());
  ASSIGN_OR_RETURN(ShapeRecord record,
                   catalog->getShape(name.collection, name.name, ShapeView::kFull));
  ASSIGN_OR_RETURN(const PrepareOptions prepare, readPrepare(record));
  MeshStore& meshes = backend.store->meshes();
  ASSIGN_OR_RETURN(const MeshPin pin, meshes.pin(record.digest));
  MeshFile file{.bytes = {}, .format = record.format, .name = record.file_name};
  ASSIGN_OR_RETURN(file.bytes, meshes.read(record.digest));
  ASSIGN_OR_RETURN(Signature signature, signMesh(context, backend, file, prepare, {}));
  fillRecord({std::move(signature), prepare}, record);
  RETURN_IF_ERROR(context.check());
  RETURN_IF_ERROR(catalog->putShape(record, OnExists::kReplace, record.id).status());
  return backend.indexes->refresh();
}

Housekeeper::Housekeeper(Backend& backend, std::chrono::seconds garbage_period)
    : backend_(backend), garbage_period_(garbage_period), thread_([this] { run(); }) {}

Housekeeper::~Housekeeper() {
  token_.cancel();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Housekeeper::run() {
  if (backend_.store->catalog() != nullptr) signOutdated();
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, garbage_period_, [this] { return stopping_; })) {
    lock.unlock();
    const Status status = backend_.store->collectGarbage();
    if (!status.ok()) log(LogLevel::kWarning, "collecting garbage: " + status.toString());
    lock.lock();
  }
}

void Housekeeper::signOutdated() {
  while (!token_.cancelled()) {
    const std::vector<ShapeName> batch = nextBatch(*backend_.store->catalog());
    if (batch.empty()) return;
    signBatch(batch);
  }
}

std::vector<ShapeName> Housekeeper::nextBatch(const Catalog& catalog) const {
  // Those that failed stay in the store's list: look past them.
  Result<std::vector<ShapeName>> outdated =
      catalog.outdatedShapes(kDescriptorVersion, kBatch + failed_.size());
  if (!outdated.ok()) {
    log(LogLevel::kWarning, "looking for outdated signatures: " + outdated.status().toString());
    return {};
  }
  std::erase_if(*outdated, [this](const ShapeName& shape) {
    return failed_.contains({shape.collection, shape.name});
  });
  return *std::move(outdated);
}

void Housekeeper::signBatch(const std::vector<ShapeName>& batch) {
  {
    const std::lock_guard lock(mutex_);
    in_flight_ = batch.size();
  }
  for (const ShapeName& shape : batch) {
    backend_.compute.submitWhenRoom([this, shape] {
      Context context;
      context.setCancelToken(token_);
      const Status status = guarded([&] { return signAnew(context, backend_, shape); });
      if (!status.ok() && !token_.cancelled()) {
        log(LogLevel::kWarning,
            "signing " + shape.collection + "/" + shape.name + " anew: " + status.toString());
      }
      const std::lock_guard lock(mutex_);
      if (!status.ok()) failed_.insert({shape.collection, shape.name});
      --in_flight_;
      wake_.notify_all();
    });
  }
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return in_flight_ == 0; });
}

}  // namespace moduli
