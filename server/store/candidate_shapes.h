#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/signature/signature.h"
#include "server/store/catalog.h"

namespace moduli {

/// A stored shape as a search compares it.
struct CandidateShape {
  std::int64_t id = 0;
  std::string name, label;
  /// Why `signature` is none; it has been logged.
  Status status;
  Signature signature;
};

/// Reads stored shapes with their signatures, and remembers some of them, so that many queries read
/// each shape once. What is remembered stays as it was read. Not thread-safe.
class CandidateShapes {
 public:
  /// Parses the signature of a record; what a distance does not look at may be left out of it.
  /// Pure, and called from several threads at once. kCancelled and kDeadlineExceeded end the
  /// search.
  using Read = std::function<Result<Signature>(const ShapeRecord&)>;
  using Shapes = std::vector<std::shared_ptr<const CandidateShape>>;

  /// remember: how many shapes at most.
  CandidateShapes(const Catalog& catalog, Read read, std::size_t remember)
      : catalog_(catalog), read_(std::move(read)), remember_(remember) {}

  /// Those of the shapes that are there, in no particular order. Fails with kCancelled,
  /// kDeadlineExceeded and the catalogue's reasons.
  Result<Shapes> get(Context& context, std::span<const std::int64_t> ids);

 private:
  void keep(const std::shared_ptr<const CandidateShape>& shape);
  Status readInto(Context& context, std::span<const std::int64_t> ids, Shapes& shapes);

  const Catalog& catalog_;
  const Read read_;
  const std::size_t remember_;
  std::unordered_map<std::int64_t, std::shared_ptr<const CandidateShape>> known_;
};

}  // namespace moduli
