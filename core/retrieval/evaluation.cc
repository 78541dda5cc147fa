#include "core/retrieval/evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

constexpr std::size_t kMostRecallPoints = 10001;

Status invalid(std::string message) {
  return {Reason::kInvalidOption, std::move(message)};
}

double gain(std::size_t rank) {
  return rank <= 2 ? 1 : 1 / std::log2(static_cast<double>(rank));
}

void add(const RetrievalScores& scores, RetrievalScores& sum) {
  sum.nearest_neighbour += scores.nearest_neighbour;
  sum.first_tier += scores.first_tier;
  sum.second_tier += scores.second_tier;
  sum.mean_average_precision += scores.mean_average_precision;
  sum.dcg += scores.dcg;
}

void divide(double count, RetrievalScores& sum) {
  sum.nearest_neighbour /= count;
  sum.first_tier /= count;
  sum.second_tier /= count;
  sum.mean_average_precision /= count;
  sum.dcg /= count;
}

// ranks: of the relevant items that were found, from 1, ascending. relevant: how many there are.
RetrievalScores scoresOf(const std::vector<std::size_t>& ranks, std::size_t relevant) {
  RetrievalScores scores;
  double ideal = 0;
  for (std::size_t i = 1; i <= relevant; ++i) ideal += gain(i);
  for (std::size_t k = 0; k < ranks.size(); ++k) {
    const std::size_t rank = ranks[k];
    if (rank == 1) scores.nearest_neighbour = 1;
    if (rank <= relevant) scores.first_tier += 1;
    if (rank <= 2 * relevant) scores.second_tier += 1;
    scores.mean_average_precision += static_cast<double>(k + 1) / static_cast<double>(rank);
    scores.dcg += gain(rank);
  }
  const auto all = static_cast<double>(relevant);
  scores.first_tier /= all;
  scores.second_tier /= all;
  scores.mean_average_precision /= all;
  scores.dcg /= ideal;
  return scores;
}

std::vector<double> precisionAt(const std::vector<std::size_t>& ranks, std::size_t relevant,
                                std::size_t points) {
  // The best precision with k + 1 relevant items found, or more.
  std::vector<double> best(ranks.size());
  double so_far = 0;
  for (std::size_t k = ranks.size(); k-- > 0;) {
    so_far = std::max(so_far, static_cast<double>(k + 1) / static_cast<double>(ranks[k]));
    best[k] = so_far;
  }
  std::vector<double> precision(points, 0);
  for (std::size_t j = 0; j < points; ++j) {
    const std::size_t needed = std::max<std::size_t>(1, (j * relevant + points - 2) / (points - 1));
    if (needed <= best.size()) precision[j] = best[needed - 1];
  }
  return precision;
}

// The items at a finite distance, nearest first, equal distances by item.
std::vector<std::size_t> ranking(std::size_t query, std::span<const double> row) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i != query && std::isfinite(row[i])) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return row[a] != row[b] ? row[a] < row[b] : a < b;
  });
  return order;
}

bool nearestIsTied(const std::vector<std::string>& labels, std::size_t query,
                   std::span<const double> row, const std::vector<std::size_t>& order) {
  bool relevant = false, other = false;
  for (const std::size_t i : order) {
    if (row[i] != row[order.front()]) break;
    (labels[i] == labels[query] ? relevant : other) = true;
  }
  return relevant && other;
}

Status checkDistances(std::size_t items, std::span<const double> distances) {
  if (distances.size() != items * items) {
    return invalid(std::to_string(distances.size()) + " distances are no matrix of " +
                   std::to_string(items) + " items");
  }
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] >= 0 || i / items == i % items) continue;
    return invalid("the distance from item " + std::to_string(i / items) + " to item " +
                   std::to_string(i % items) + " is negative or not a number");
  }
  return {};
}

}  // namespace

Result<RetrievalJudge> RetrievalJudge::make(std::vector<std::string> labels,
                                            const EvaluationOptions& options) {
  if (options.recall_points < 2 || options.recall_points > kMostRecallPoints) {
    return invalid("recall_points is " + std::to_string(options.recall_points) +
                   ", but must be from 2 to " + std::to_string(kMostRecallPoints));
  }
  return RetrievalJudge(std::move(labels), options.recall_points);
}

RetrievalJudge::RetrievalJudge(std::vector<std::string> labels, std::size_t recall_points)
    : labels_(std::move(labels)), recall_points_(recall_points) {
  for (const std::string& label : labels_) {
    if (!label.empty()) ++members_[label];
  }
}

std::size_t RetrievalJudge::relevantCount(std::size_t item) const {
  const auto members = members_.find(labels_[item]);
  return members == members_.end() ? 0 : members->second - 1;
}

Result<QueryEvaluation> RetrievalJudge::judge(std::size_t query,
                                              std::span<const std::size_t> ranked) const {
  if (query >= itemCount() || !isQuery(query)) {
    return invalid("item " + std::to_string(query) + " is no query");
  }
  std::vector<bool> seen(itemCount(), false);
  seen[query] = true;
  std::vector<std::size_t> ranks;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    if (ranked[i] >= itemCount() || seen[ranked[i]]) {
      return invalid("item " + std::to_string(ranked[i]) + " has no place in the answer to query " +
                     std::to_string(query) + ": unknown, there already, or the query itself");
    }
    seen[ranked[i]] = true;
    if (labels_[ranked[i]] == labels_[query]) ranks.push_back(i + 1);
  }
  const std::size_t relevant = relevantCount(query);
  QueryEvaluation evaluation;
  evaluation.query = query;
  evaluation.scores = scoresOf(ranks, relevant);
  evaluation.precision = precisionAt(ranks, relevant, recall_points_);
  if (!ranked.empty()) evaluation.nearest = labels_[ranked.front()];
  return evaluation;
}

Evaluation RetrievalJudge::summarize(std::vector<QueryEvaluation> queries) const {
  std::sort(queries.begin(), queries.end(),
            [](const auto& a, const auto& b) { return a.query < b.query; });
  Evaluation evaluation;
  evaluation.precision.assign(recall_points_, 0);
  std::map<std::string, ClassEvaluation> classes;
  std::map<std::string, double> queries_of;
  for (const QueryEvaluation& query : queries) {
    const std::string& label = labels_[query.query];
    ClassEvaluation& of_class = classes[label];
    add(query.scores, evaluation.scores);
    add(query.scores, of_class.scores);
    ++of_class.nearest[query.nearest];
    ++queries_of[label];
    for (std::size_t j = 0; j < recall_points_; ++j) evaluation.precision[j] += query.precision[j];
    if (query.tied) ++evaluation.tied;
  }
  const double count = std::max<double>(1, static_cast<double>(queries.size()));
  divide(count, evaluation.scores);
  for (double& value : evaluation.precision) value /= count;
  for (auto& [label, of_class] : classes) {
    of_class.label = label;
    of_class.members = members_.at(label);
    divide(queries_of[label], of_class.scores);
    evaluation.per_class.push_back(std::move(of_class));
  }
  evaluation.queries = std::move(queries);
  return evaluation;
}

Result<Evaluation> evaluateDistances(Context& context, const std::vector<std::string>& labels,
                                     std::span<const double> distances,
                                     const EvaluationOptions& options) {
  Context::Stage stage(context, "evaluate");
  const std::size_t items = labels.size();
  RETURN_IF_ERROR(checkDistances(items, distances));
  ASSIGN_OR_RETURN(const RetrievalJudge judge, RetrievalJudge::make(labels, options));
  std::vector<std::optional<QueryEvaluation>> answers(items);
  std::mutex mutex;
  Status failure;
  parallelBlocks(items, 16, [&](std::size_t begin, std::size_t end) {
    Status status = context.check();
    for (std::size_t query = begin; query < end && status.ok(); ++query) {
      if (!judge.isQuery(query)) continue;
      const std::span<const double> row = distances.subspan(query * items, items);
      const std::vector<std::size_t> order = ranking(query, row);
      Result<QueryEvaluation> answer = judge.judge(query, order);
      status = answer.status();
      if (!status.ok()) break;
      answer->tied = nearestIsTied(labels, query, row, order);
      answers[query] = *std::move(answer);
    }
    const std::scoped_lock lock(mutex);
    if (!status.ok()) failure = status;
  });
  RETURN_IF_ERROR(failure);
  std::vector<QueryEvaluation> queries;
  for (auto& answer : answers) {
    if (answer) queries.push_back(*std::move(answer));
  }
  return judge.summarize(std::move(queries));
}

}  // namespace moduli
