#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/signature/signature.h"
#include "server/store/candidate_shapes.h"
#include "server/store/catalog.h"
#include "server/store/index_keeper.h"

namespace moduli {

/// Behind which hit a page begins.
struct SearchPosition {
  double distance = 0;
  std::string name;
  std::size_t count = 0;  ///< Hits up to it, itself included: a hint of where it stands.
};

/// How far two shapes are in one part of their descriptor.
struct SearchPart {
  std::string_view name;
  double distance = 0;
};

/// What is being looked for, and where.
struct SearchQuery {
  std::string collection;
  Space space = Space::kShape;
  std::string type;           ///< Conformal type of the query, "SPHERE", "TORUS", ...
  std::vector<float> vector;  ///< The query's vector of that space.
  std::size_t k = 10;         ///< Hits of this page; at least 1.
  std::optional<SearchPosition> after = {};
  Filter filter;
  int descriptor_version = kDescriptorVersion;

  /// Makes signatures of stored bytes. A shape that fails is left out, with a warning in the log.
  CandidateShapes::Read read;
  /// The true distance of the query to a stored shape. Nothing where none is defined. Called from
  /// one thread.
  std::function<std::optional<double>(const Signature& shape)> distance;
  /// What to tell of the parts of that distance; empty: nothing.
  std::function<std::vector<SearchPart>(const Signature& shape)> explain = {};

  /// Where the vectors are a mere stand-in for the distance (conformal space), up to this many
  /// shapes are all compared, so that the answer is exact; of more, the nearest by vector, and all
  /// that are as near as the last of them.
  std::size_t exhaustive_limit = 20000;
};

struct SearchHit {
  std::string name, label;
  double distance = 0;
  std::int64_t id = 0;
  std::vector<SearchPart> parts = {};
};

struct SearchAnswer {
  std::vector<SearchHit> hits;        ///< Nearest first; equal distances by ascending name.
  bool exact = true;                  ///< These are the true k nearest.
  std::optional<double> recall = {};  ///< Of the approximate index that was asked, if any.
  bool more = false;                  ///< There are hits behind these.
};

/// Candidates from the index, then the filter, then the true distance. In an exact collection the
/// answer depends on what is stored alone, not on the order in which it came.
///
/// metric and shape space: the vector is the signature's block rounded to float32, so the two
/// distances differ by at most a bound known in advance; the candidates are widened until no other
/// shape can belong to the first k. Conformal space: only the query's type; spheres are all at
/// distance 0, so the first k names are the answer; for the others see exhaustive_limit. With a
/// filter, k hits are found if k exist, and the metric and the shape space are exact in any
/// collection. Fails with kCollectionNotFound, kInvalidOption, kCancelled, kDeadlineExceeded and
/// the catalogue's reasons. Cost: a search of the index, and one distance per candidate, usually
/// about k; of a later page, a search for as many more neighbours as there are hits before it.
Result<SearchAnswer> searchShapes(Context& context, const Catalog& catalog,
                                  const IndexKeeper& keeper, const SearchQuery& query);

/// searchShapes() of each query, much faster than one by one: the index answers many at once, and
/// every candidate is read once. The queries have collection, space, k, filter and `read` in common
/// (the first one's count), and begin with the first page. Reports progress. Fails as searchShapes.
Result<std::vector<SearchAnswer>> searchShapesMany(Context& context, const Catalog& catalog,
                                                   const IndexKeeper& keeper,
                                                   std::span<const SearchQuery> queries);

}  // namespace moduli
