#include "tests/bench/retrieval/score.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

using Clock = std::chrono::steady_clock;

struct Computed {
  std::vector<std::optional<DescriptorVector>> vectors;
  Status status;
  double seconds = 0;
};

Computed computeOne(const Descriptor& descriptor, const Variant& variant) {
  Context context;
  Computed computed;
  computed.vectors.resize(descriptor.names.size());
  const auto start = Clock::now();
  Result<PreparedMesh> prepared = prepareMesh(context, variant.soup, {});
  computed.status = prepared.status();
  if (!prepared.ok()) return computed;
  auto vectors = descriptor.compute(context, *prepared);
  computed.status = vectors.status();
  if (vectors.ok()) computed.vectors = *std::move(vectors);
  computed.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return computed;
}

std::vector<double> distancesOf(const std::vector<Computed>& computed, std::size_t which) {
  std::vector<double> distances;
  distances.reserve(computed.size() * computed.size());
  for (const Computed& a : computed) {
    for (const Computed& b : computed) {
      distances.push_back(descriptorDistance(a.vectors[which], b.vectors[which]));
    }
  }
  return distances;
}

// Whether the nearest original of a variant is its own.
bool findsOriginal(const std::vector<Variant>& variants, std::size_t query, const double* row) {
  double nearest = std::numeric_limits<double>::infinity();
  bool own = false;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    if (i == query || variants[i].kind != "original" || !(row[i] < nearest)) continue;
    nearest = row[i];
    own = variants[i].label == variants[query].label;
  }
  return own;
}

void addTo(const RetrievalScores& scores, double weight, RetrievalScores& sum) {
  sum.nearest_neighbour += weight * scores.nearest_neighbour;
  sum.first_tier += weight * scores.first_tier;
  sum.second_tier += weight * scores.second_tier;
  sum.mean_average_precision += weight * scores.mean_average_precision;
  sum.dcg += weight * scores.dcg;
}

std::map<std::string, KindScores> scoresByKind(const std::vector<Variant>& variants,
                                               const std::vector<double>& distances,
                                               const Evaluation& evaluation) {
  std::map<std::string, KindScores> by_kind;
  for (const Variant& variant : variants) ++by_kind[variant.kind].queries;
  for (const QueryEvaluation& query : evaluation.queries) {
    KindScores& kind = by_kind[variants[query.query].kind];
    const double weight = 1 / static_cast<double>(kind.queries);
    addTo(query.scores, weight, kind.scores);
    const double* row = distances.data() + query.query * variants.size();
    if (findsOriginal(variants, query.query, row)) kind.nearest_original += weight;
  }
  return by_kind;
}

std::string padded(std::string text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 0, ' ');
}

std::string number(double value, int decimals = 3) {
  std::string text(32, '\0');
  text.resize(
      static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.*f", decimals, value)));
  return text;
}

constexpr std::size_t kNameWidth = 14, kWidth = 11;

// One row a kind, one column a descriptor.
template <typename Value>
std::string kindTable(const std::string& title, const std::vector<DescriptorScores>& scores,
                      Value value) {
  std::string text = '\n' + title + '\n' + padded("", kNameWidth);
  for (const DescriptorScores& score : scores) text += padded(score.name, kWidth);
  text += '\n';
  for (const std::string& kind : variantKinds()) {
    std::string row = padded(kind, kNameWidth);
    bool any = false;
    for (const DescriptorScores& score : scores) {
      const auto found = score.by_kind.find(kind);
      any |= found != score.by_kind.end();
      row += padded(found == score.by_kind.end() ? "" : number(value(found->second)), kWidth);
    }
    if (any) text += row + '\n';
  }
  return text;
}

std::string jsonScores(const RetrievalScores& scores) {
  return "\"nearest_neighbour\":" + number(scores.nearest_neighbour, 6) +
         ",\"first_tier\":" + number(scores.first_tier, 6) +
         ",\"second_tier\":" + number(scores.second_tier, 6) +
         ",\"mean_average_precision\":" + number(scores.mean_average_precision, 6) +
         ",\"dcg\":" + number(scores.dcg, 6);
}

std::string jsonDescriptor(const DescriptorScores& score) {
  std::string text = "{\"name\":\"" + score.name + "\"," + jsonScores(score.evaluation.scores) +
                     ",\"queries\":" + std::to_string(score.evaluation.queries.size()) +
                     ",\"tied\":" + std::to_string(score.evaluation.tied) +
                     ",\"missing\":" + std::to_string(score.missing) +
                     ",\"failed\":" + std::to_string(score.failures.size()) +
                     ",\"seconds\":" + number(score.seconds, 6) + ",\"precision\":[";
  for (const double value : score.evaluation.precision) text += number(value, 6) + ',';
  if (text.back() == ',') text.pop_back();
  text += "],\"kinds\":{";
  for (const auto& [kind, scores] : score.by_kind) {
    text += '"' + kind + "\":{\"queries\":" + std::to_string(scores.queries) +
            ",\"nearest_original\":" + number(scores.nearest_original, 6) + ',' +
            jsonScores(scores.scores) + "},";
  }
  if (text.back() == ',') text.pop_back();
  text += "},\"per_class\":{";
  for (const ClassEvaluation& of_class : score.evaluation.per_class) {
    text += '"' + of_class.label + "\":{" + jsonScores(of_class.scores) + "},";
  }
  if (text.back() == ',') text.pop_back();
  return text + "}}";
}

}  // namespace

Result<DescriptorScores> scoreDistances(Context& context, const std::string& name,
                                        const std::vector<Variant>& variants,
                                        const std::vector<double>& distances) {
  std::vector<std::string> labels;
  for (const Variant& variant : variants) labels.push_back(variant.label);
  DescriptorScores scores;
  scores.name = name;
  ASSIGN_OR_RETURN(scores.evaluation, evaluateDistances(context, labels, distances));
  scores.by_kind = scoresByKind(variants, distances, scores.evaluation);
  return scores;
}

Result<std::vector<DescriptorScores>> scoreDescriptor(Context& context,
                                                      const Descriptor& descriptor,
                                                      const std::vector<Variant>& variants) {
  std::vector<Computed> computed(variants.size());
  parallelBlocks(variants.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) computed[i] = computeOne(descriptor, variants[i]);
  });
  std::vector<DescriptorScores> all;
  for (std::size_t which = 0; which < descriptor.names.size(); ++which) {
    ASSIGN_OR_RETURN(
        DescriptorScores scores,
        scoreDistances(context, descriptor.names[which], variants, distancesOf(computed, which)));
    for (std::size_t i = 0; i < variants.size(); ++i) {
      if (!computed[i].vectors[which]) ++scores.missing;
      scores.seconds += computed[i].seconds / static_cast<double>(variants.size());
      if (computed[i].status.ok()) continue;
      scores.failures.push_back(variants[i].name + ": " + computed[i].status.toString());
    }
    all.push_back(std::move(scores));
  }
  return all;
}

std::string scoreTable(const std::vector<DescriptorScores>& scores) {
  std::string text = padded("all queries", kNameWidth);
  for (const char* head :
       {"nearest", "tier 1", "tier 2", "mAP", "DCG", "tied", "missing", "s/mesh"}) {
    text += padded(head, 9);
  }
  text += '\n';
  for (const DescriptorScores& score : scores) {
    const RetrievalScores& mean = score.evaluation.scores;
    text += padded(score.name, kNameWidth);
    for (const double value : {mean.nearest_neighbour, mean.first_tier, mean.second_tier,
                               mean.mean_average_precision, mean.dcg}) {
      text += padded(number(value), 9);
    }
    text += padded(std::to_string(score.evaluation.tied), 9) +
            padded(std::to_string(score.missing), 9) + number(score.seconds) + '\n';
  }
  text += kindTable("share of variants nearest to their own original, of all originals", scores,
                    [](const KindScores& kind) { return kind.nearest_original; });
  text += kindTable("mean average precision by kind of query, among all variants", scores,
                    [](const KindScores& kind) { return kind.scores.mean_average_precision; });
  text += kindTable("nearest neighbour by kind of query, among all variants", scores,
                    [](const KindScores& kind) { return kind.scores.nearest_neighbour; });
  return text;
}

std::string scoreJson(const std::vector<DescriptorScores>& scores) {
  std::string text = "{\"descriptors\":[";
  for (const DescriptorScores& score : scores) text += jsonDescriptor(score) + ',';
  if (text.back() == ',') text.pop_back();
  return text + "]}\n";
}

}  // namespace moduli
