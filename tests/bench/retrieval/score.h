#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/retrieval/evaluation.h"
#include "tests/bench/retrieval/descriptors.h"
#include "tests/bench/retrieval/variants.h"

/// What descriptors are worth on the variants of a benchmark.
namespace moduli {

/// For the variants of one kind as queries.
struct KindScores {
  std::size_t queries = 0;
  /// Share of them that are nearer to their own original than to any other; 0 for the kind
  /// "original".
  double nearest_original = 0;
  RetrievalScores scores;  ///< Among all variants of all shapes.
};

struct DescriptorScores {
  std::string name;
  Evaluation evaluation;
  std::map<std::string, KindScores> by_kind;
  std::size_t missing = 0;            ///< Variants without a vector.
  std::vector<std::string> failures;  ///< "NAME: REASON: message" of variants that failed.
  double seconds = 0;                 ///< Mean per variant, of the whole computation.
};

/// Scores from a matrix of distances, row after row, infinite where undefined; labels are the base
/// shapes'. The order of variants breaks ties, so it must say nothing of their labels. Fails as
/// evaluateDistances.
Result<DescriptorScores> scoreDistances(Context& context, const std::string& name,
                                        const std::vector<Variant>& variants,
                                        const std::vector<double>& distances);

/// Computes a descriptor's vectors for all variants on all cores and scores each.
Result<std::vector<DescriptorScores>> scoreDescriptor(Context& context,
                                                      const Descriptor& descriptor,
                                                      const std::vector<Variant>& variants);

/// Tables for people: overall, and by kind of variant.
std::string scoreTable(const std::vector<DescriptorScores>& scores);

/// The same as one JSON object.
std::string scoreJson(const std::vector<DescriptorScores>& scores);

}  // namespace moduli
