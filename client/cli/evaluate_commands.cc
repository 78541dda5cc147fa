#include <algorithm>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/file_writer.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/report.h"
#include "client/cli/session.h"
#include "core/picture/precision_recall.h"

/// evaluate, duplicates: what compares all shapes of a collection.
namespace moduli::cli {
namespace {

Status writeCurve(const std::string& path, const std::string& collection,
                  const v1::Evaluation& evaluation) {
  const PrecisionRecallCurve curve{v1::Signature::Space_Name(evaluation.space()),
                                   {evaluation.precision().begin(), evaluation.precision().end()}};
  PrecisionRecallOptions options;
  options.title = "Precision and recall of " + safe(collection);
  ASSIGN_OR_RETURN(const std::string svg, drawPrecisionRecall({&curve, 1}, options));
  FileWriter writer(path, true);
  RETURN_IF_ERROR(writer.open());
  RETURN_IF_ERROR(writer.write(svg));
  return writer.commit();
}

Status runEvaluate(Session& session, const Arguments& arguments) {
  const std::string collection = arguments.text("collection");
  v1::EvaluateCollectionRequest request;
  request.set_parent(collectionName(collection));
  request.set_space(spaceOf(arguments));
  request.set_filter(arguments.text("filter"));
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const Result<v1::Evaluation> result = client->evaluate(request);
  if (!result.ok()) return session.explain(collection, result.status());
  if (arguments.has("curve")) {
    RETURN_IF_ERROR(writeCurve(arguments.text("curve"), collection, *result));
  }
  if (session.json()) return session.printJson(*result);
  if (session.quiet()) return {};
  return session.print(evaluationReport(collection, *result, arguments.has("confusion")));
}

Status runDuplicates(Session& session, const Arguments& arguments) {
  const std::string collection = arguments.text("collection");
  v1::FindDuplicatesRequest request;
  request.set_parent(collectionName(collection));
  request.set_space(spaceOf(arguments));
  request.set_filter(arguments.text("filter"));
  if (arguments.has("threshold")) request.set_threshold(arguments.number("threshold", 0));
  request.set_mirror(arguments.has("mirror"));
  request.set_same_scale(arguments.has("same-scale"));
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const Result<v1::Duplicates> result = client->findDuplicates(request);
  if (!result.ok()) return session.explain(collection, result.status());
  if (session.json()) return session.printJson(*result);
  return session.quiet() ? Status() : session.print(duplicatesReport(collection, *result));
}

OptionSpec filterOption(const std::string& help) {
  return {.names = "--filter", .value = "EXPR", .help = help};
}

}  // namespace

std::vector<CommandSpec> evaluateCommands() {
  return {
      {.path = "evaluate",
       .summary = "Judge how well a collection's labels are found",
       .details =
           "Every labelled shape queries all others; those of the same label are right. Nearest "
           "neighbour: whether the first one found is. First and second tier: the share of the "
           "right ones among as many, and twice as many, as there are. Mean average precision and "
           "discounted cumulative gain weigh the whole order. All are 1 where the right ones come "
           "first. Labels that one shape alone has query nothing.",
       .arguments = {},
       .options = {collectionOption(),
                   spaceOption("What counts as near (shape)"),
                   filterOption("Only among these shapes"),
                   {.names = "--confusion",
                    .value = "",
                    .help = "Also tell which labels are taken for which others"},
                   {.names = "--curve",
                    .value = "OUT.svg",
                    .help = "Draw precision over recall",
                    .completion = Completion::kFile}},
       .run = runEvaluate,
       .examples = "moduli add -c shapes models --recursive --label-from dir\n"
                   "moduli evaluate -c shapes --curve shapes.svg\n"
                   "moduli evaluate -c shapes --space metric --json"},
      {.path = "duplicates",
       .summary = "Find shapes that are the same, or nearly",
       .details = "Groups shapes whose distance is at most the threshold, and what is as near to "
                  "one of these, and so on. Copies that were moved, scaled or renumbered are at "
                  "distance 0 up to rounding.",
       .arguments = {},
       .options = {collectionOption(),
                   spaceOption("What counts as near (shape)"),
                   filterOption("Only among these shapes"),
                   {.names = "--threshold",
                    .value = "D",
                    .help = "The largest distance (1e-6: rounding)",
                    .check = isDistance},
                   {.names = "--mirror",
                    .value = "",
                    .help = "Mirror images are the same, where the space tells them apart"},
                   {.names = "--same-scale",
                    .value = "",
                    .help = "Only shapes of the same size are the same"}},
       .run = runDuplicates,
       .examples = "moduli duplicates -c shapes\nmoduli duplicates -c shapes --threshold 0.05 "
                   "--same-scale"}};
}

}  // namespace moduli::cli
