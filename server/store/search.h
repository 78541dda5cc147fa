#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "server/store/catalog.h"
#include "server/store/index_keeper.h"

namespace moduli {

/// What is being looked for, and where.
struct SearchQuery {
  std::string collection;
  Space space = Space::kShape;
  std::string type;           ///< Conformal type of the query, "SPHERE", "TORUS", ...
  std::vector<float> vector;  ///< The query's vector of that space.
  std::size_t k = 10;         ///< At least 1.
  Filter filter;
  int descriptor_version = kDescriptorVersion;

  /// The true distance of the query to a stored shape (with its signature's bytes): parse and call
  /// signatureDistance. Nothing where none is defined. An error skips the shape, with a warning in
  /// the log, but kCancelled and kDeadlineExceeded end the search. Called from one thread.
  std::function<Result<std::optional<double>>(const ShapeRecord& shape)> distance;

  /// Where the vectors are a mere stand-in for the distance (conformal space), up to this many
  /// shapes are all compared, so that the answer is exact; of more, the nearest by vector.
  std::size_t exhaustive_limit = 20000;
};

struct SearchHit {
  std::string name, label;
  double distance = 0;
  std::int64_t id = 0;
};

struct SearchAnswer {
  std::vector<SearchHit> hits;  ///< Nearest first; equal distances by ascending name.
  bool exact = true;            ///< These are the true k nearest.
};

/// Candidates from the index, then the filter, then the true distance.
///
/// metric and shape space: the vector is the signature's block rounded to float32, so the two
/// distances differ by at most a bound known in advance; the candidates are widened until no other
/// shape can belong to the first k. Conformal space: only the query's type; spheres are all at
/// distance 0, so the first k names are the answer; for the others see exhaustive_limit. With a
/// filter, k hits are found if k exist. Fails with kCollectionNotFound, kInvalidOption, kCancelled,
/// kDeadlineExceeded and the catalogue's reasons. Cost: a search of the index, and one distance per
/// candidate, usually about k.
Result<SearchAnswer> searchShapes(Context& context, const Catalog& catalog,
                                  const IndexKeeper& keeper, const SearchQuery& query);

}  // namespace moduli
