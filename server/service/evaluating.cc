#include "server/service/evaluating.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/retrieval/evaluation.h"
#include "core/signature/distance.h"
#include "server/rpc/convert.h"
#include "server/service/collection_signatures.h"
#include "server/service/request.h"

namespace moduli {
namespace {

/// What a query finds among all other shapes, nearest first; those at no distance are not found.
struct Answer {
  std::vector<std::size_t> ranked;
  bool tied = false;  ///< Shapes of the query's label and others are nearest alike.
};

Answer answerTo(const std::vector<SignedShape>& shapes, std::size_t query, Space space) {
  std::vector<double> distance(shapes.size(), -1);
  Answer answer;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (i == query) continue;
    const auto found = signatureDistance(shapes[query].signature, shapes[i].signature, space);
    if (!found) continue;
    distance[i] = *found;
    answer.ranked.push_back(i);
  }
  std::stable_sort(answer.ranked.begin(), answer.ranked.end(),
                   [&](std::size_t a, std::size_t b) { return distance[a] < distance[b]; });
  bool same = false, other = false;
  for (const std::size_t i : answer.ranked) {
    if (distance[i] > distance[answer.ranked.front()]) break;
    (shapes[i].label == shapes[query].label ? same : other) = true;
  }
  answer.tied = same && other;
  return answer;
}

template <typename Message>
void setScores(const RetrievalScores& scores, Message& message) {
  message.set_nearest_neighbour(scores.nearest_neighbour);
  message.set_first_tier(scores.first_tier);
  message.set_second_tier(scores.second_tier);
  message.set_mean_average_precision(scores.mean_average_precision);
  message.set_dcg(scores.dcg);
}

v1::Evaluation toProto(const Evaluation& evaluation, Space space) {
  v1::Evaluation message;
  message.set_space(moduli::toProto(space));
  message.set_queries(static_cast<std::int32_t>(evaluation.queries.size()));
  setScores(evaluation.scores, message);
  for (const double precision : evaluation.precision) message.add_precision(precision);
  for (const ClassEvaluation& one : evaluation.per_class) {
    v1::Evaluation::PerClass& row = *message.add_per_class();
    row.set_label(one.label);
    row.set_members(static_cast<std::int32_t>(one.members));
    setScores(one.scores, row);
    for (const auto& [label, count] : one.nearest) {
      (*row.mutable_nearest())[label] = static_cast<std::int32_t>(count);
    }
  }
  message.set_tied(static_cast<std::int32_t>(evaluation.tied));
  return message;
}

}  // namespace

Result<v1::Evaluation> evaluateCollection(Context& context, const Backend& backend,
                                          const v1::EvaluateCollectionRequest& request) {
  ASSIGN_OR_RETURN(const Catalog* catalog, backend.catalog());
  ASSIGN_OR_RETURN(const std::string collection, parseCollectionName(request.parent()));
  ASSIGN_OR_RETURN(const Filter filter, Filter::parse(request.filter()));
  const Space space = fromProto(request.space()).value_or(Space::kShape);
  ASSIGN_OR_RETURN(const std::vector<SignedShape> all,
                   signaturesOf(context, *catalog, collection, filter));
  // Shapes without numbers of this space are at no distance from any, themselves included.
  std::vector<SignedShape> shapes;
  int without = 0;
  for (const SignedShape& shape : all) {
    if (signatureDistance(shape.signature, shape.signature, space)) {
      shapes.push_back(shape);
    } else if (!shape.label.empty()) {
      ++without;
    }
  }
  std::vector<std::string> labels;
  for (const SignedShape& shape : shapes) labels.push_back(shape.label);
  ASSIGN_OR_RETURN(const RetrievalJudge judge, RetrievalJudge::make(std::move(labels)));

  const Context::Stage stage(context, "compare");
  std::vector<std::size_t> queries;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (judge.isQuery(i)) queries.push_back(i);
  }
  if (queries.empty()) {
    return Status(Reason::kInvalidOption,
                  "no two of " + std::to_string(shapes.size()) + " shapes share a label",
                  "label shapes when they are added (add --label-from dir), or with moduli edit");
  }
  std::vector<QueryEvaluation> judged(queries.size());
  std::vector<Status> outcomes(queries.size());
  parallelBlocks(queries.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      outcomes[i] = context.check();
      if (!outcomes[i].ok()) continue;
      const Answer answer = answerTo(shapes, queries[i], space);
      Result<QueryEvaluation> result = judge.judge(queries[i], answer.ranked);
      outcomes[i] = result.status();
      if (!result.ok()) continue;
      judged[i] = *std::move(result);
      judged[i].tied = answer.tied;
    }
  });
  for (const Status& outcome : outcomes) RETURN_IF_ERROR(outcome);
  v1::Evaluation message = toProto(judge.summarize(std::move(judged)), space);
  message.set_without_numbers(without);
  return message;
}

}  // namespace moduli
