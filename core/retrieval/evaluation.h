#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"

/// How well a distance finds shapes of the same label:
///
///   ASSIGN_OR_RETURN(const Evaluation evaluation, evaluateDistances(context, labels, distances));
///   evaluation.scores.mean_average_precision;
///
/// Every item with a label that others share queries all other items, itself excluded. An item is
/// relevant to a query of the same label. The label "" is none: such items are no queries and
/// relevant to nobody, but they are found. Items whose label nobody shares are no queries either.
namespace moduli {

/// Each within [0, 1], 1 for an answer with all relevant items first. r: the number of relevant
/// items. Source: Shilane, Min, Kazhdan, Funkhouser, The Princeton Shape Benchmark (2004).
struct RetrievalScores {
  double nearest_neighbour = 0;  ///< Whether the first item found is relevant.
  double first_tier = 0;         ///< Share of the relevant items among the first r found.
  double second_tier = 0;        ///< The same among the first 2 r.
  /// Mean over the relevant items of the precision at their rank, 0 for those not found.
  double mean_average_precision = 0;
  /// Discounted cumulative gain: a relevant item counts 1 at ranks 1 and 2 and 1 / log2(rank)
  /// further down; over what an answer with all relevant items first would have.
  double dcg = 0;
};

/// What one answer is worth.
struct QueryEvaluation {
  std::size_t query = 0;
  RetrievalScores scores;  ///< mean_average_precision: the average precision of this answer.
  /// At recall j / (n - 1), j = 0 .. n - 1: the best precision at that recall or a higher one; 0
  /// where the answer does not get there.
  std::vector<double> precision;
  std::string nearest;  ///< Label of the first item found; "" if it has none or nothing is found.
  /// Whether relevant and other items share the smallest distance, so that nearest_neighbour hangs
  /// on the order of the items. evaluateDistances alone can tell.
  bool tied = false;
};

struct ClassEvaluation {
  std::string label;
  std::size_t members = 0;
  RetrievalScores scores;  ///< Mean over its members as queries.
  /// How often which label came first, by label; "" where the first item found has none or nothing
  /// is found. A row of the confusion matrix; adds up to `members`.
  std::map<std::string, std::size_t> nearest;
};

struct Evaluation {
  RetrievalScores scores;         ///< Mean over all queries, each of the same weight.
  std::vector<double> precision;  ///< As QueryEvaluation::precision, mean over all queries.
  std::vector<ClassEvaluation> per_class;  ///< Classes of two or more members, by label.
  std::vector<QueryEvaluation> queries;    ///< By item, ascending.
  std::size_t tied = 0;                    ///< Queries with QueryEvaluation::tied.
};

struct EvaluationOptions {
  std::size_t recall_points = 11;  ///< n of QueryEvaluation::precision, 2 to 10001.
};

/// Judges answers one by one, for collections whose distances do not fit in memory. Immutable; safe
/// to use from several threads.
class RetrievalJudge {
 public:
  /// labels: per item. Fails with kInvalidOption (recall_points).
  static Result<RetrievalJudge> make(std::vector<std::string> labels,
                                     const EvaluationOptions& options = {});

  std::size_t itemCount() const { return labels_.size(); }
  /// Items with the label of `item`, itself excluded; 0 without a label.
  std::size_t relevantCount(std::size_t item) const;
  bool isQuery(std::size_t item) const { return relevantCount(item) > 0; }

  /// ranked: the items found, best first, each once, without the query; may be a part of all, and
  /// what is missing counts as never found. Fails with kInvalidOption (no query, no such item, an
  /// item twice, the query itself). O(ranked).
  Result<QueryEvaluation> judge(std::size_t query, std::span<const std::size_t> ranked) const;

  /// Means over these queries, each once, in any order; a query left out counts nowhere. O(n log
  /// n).
  Evaluation summarize(std::vector<QueryEvaluation> queries) const;

 private:
  RetrievalJudge(std::vector<std::string> labels, std::size_t recall_points);

  std::vector<std::string> labels_;
  std::map<std::string, std::size_t> members_;
  std::size_t recall_points_;
};

/// Judges every query of a matrix of distances.
/// distances: n x n, row after row, row q from query q; finite and >= 0, or infinite: not found. It
/// need not be symmetric; the diagonal is not looked at. Equal distances stand in the order of the
/// items: give them in an order that says nothing of their labels (names often do), and see `tied`.
/// Fails with kInvalidOption (sizes, a distance that is NaN or negative), kCancelled,
/// kDeadlineExceeded. O(n^2 log n), on all cores.
Result<Evaluation> evaluateDistances(Context& context, const std::vector<std::string>& labels,
                                     std::span<const double> distances,
                                     const EvaluationOptions& options = {});

}  // namespace moduli
