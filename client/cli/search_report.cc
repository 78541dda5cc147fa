#include <algorithm>
#include <vector>

#include "client/cli/output.h"
#include "client/cli/report.h"
#include "client/cli/report_lines.h"

/// Reports of what was found in collections.
namespace moduli::cli {
namespace {

// Of a SearchResult or a QueryResult.
template <typename Message>
std::string hitsReport(const Message& result) {
  if (result.hits().empty()) return "nothing found\n";
  std::vector<std::string> head = {"#", "distance", "name", "label"};
  for (const v1::PartDistance& part : result.hits(0).parts()) head.push_back(safe(part.name()));
  std::vector<std::vector<std::string>> rows;
  for (const v1::SearchHit& hit : result.hits()) {
    std::vector<std::string> row = {std::to_string(rows.size() + 1), brief(hit.distance()),
                                    safe(hit.name()), safe(hit.label())};
    for (const v1::PartDistance& part : hit.parts()) row.push_back(brief(part.distance()));
    row.resize(head.size());
    rows.push_back(std::move(row));
  }
  std::string text = alignedTable(head, rows);
  if (result.has_recall()) {
    text +=
        "approximate: finds " + brief(100 * result.recall()) + "% of the nearest, as measured\n";
  } else if (!result.exact()) {
    text += "approximate: a nearer shape may have been missed\n";
  }
  return text;
}

}  // namespace

std::string searchReport(const v1::SearchResult& result) {
  return hitsReport(result);
}

std::string batchReport(const std::vector<v1::QueryResult>& results) {
  std::string text;
  for (const v1::QueryResult& result : results) {
    if (!text.empty()) text += "\n";
    text += safe(result.query()) + "\n";
    if (!result.has_failure()) {
      text += hitsReport(result);
      continue;
    }
    const v1::QueryFailure& failure = result.failure();
    text += "failed: " + safe(failure.message()) + " (" + safe(failure.reason()) + ")";
    text += (failure.hint().empty() ? "" : "; " + safe(failure.hint())) + "\n";
  }
  return text.empty() ? "nothing to search for\n" : text;
}

std::string evaluationReport(const std::string& title, const v1::Evaluation& evaluation,
                             bool confusion) {
  const auto row = [](const std::string& label, int members, const auto& scores) {
    return std::vector<std::string>{label,
                                    std::to_string(members),
                                    brief(scores.nearest_neighbour()),
                                    brief(scores.first_tier()),
                                    brief(scores.second_tier()),
                                    brief(scores.mean_average_precision()),
                                    brief(scores.dcg())};
  };
  std::vector<std::vector<std::string>> rows = {row("all", evaluation.queries(), evaluation)};
  for (const v1::Evaluation::PerClass& one : evaluation.per_class()) {
    rows.push_back(row(safe(one.label()), one.members(), one));
  }
  std::string text = safe(title) + ", space " + v1::Signature::Space_Name(evaluation.space()) +
                     "\n" +
                     alignedTable({"label", "queries", "nearest", "first tier", "second tier",
                                   "mean average precision", "gain"},
                                  rows);
  if (evaluation.without_numbers() > 0) {
    text += counted(evaluation.without_numbers(), "labelled shape has", "labelled shapes have") +
            " no numbers in this space\n";
  }
  if (evaluation.tied() > 0) {
    text += counted(evaluation.tied(), "query has", "queries have") +
            " right and wrong shapes at the same smallest distance\n";
  }
  if (!confusion) return text;
  for (const v1::Evaluation::PerClass& one : evaluation.per_class()) {
    // By label: the map has no order of its own.
    std::vector<std::string> firsts;
    for (const auto& [label, count] : one.nearest()) {
      firsts.push_back((label.empty() ? "(none)" : safe(label)) + " " + std::to_string(count));
    }
    std::sort(firsts.begin(), firsts.end());
    text += joinedLine(safe(one.label()), firsts);
  }
  return text;
}

std::string duplicatesReport(const std::string& title, const v1::Duplicates& duplicates) {
  std::string text = safe(title) + ": " + counted(duplicates.clusters_size(), "group", "groups") +
                     " among " + counted(duplicates.shapes(), "shape", "shapes") + "\n";
  std::vector<std::vector<std::string>> rows;
  for (const v1::DuplicateCluster& cluster : duplicates.clusters()) {
    std::string names;
    for (const std::string& name : cluster.names())
      names += (names.empty() ? "" : ", ") + safe(name);
    rows.push_back({std::to_string(cluster.names_size()), brief(cluster.linkage()), names});
  }
  return rows.empty() ? text : text + alignedTable({"shapes", "distance", "names"}, rows);
}

}  // namespace moduli::cli
