#include <optional>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/session.h"
#include "core/base/text.h"

/// collection create, list, show, delete.
namespace moduli::cli {
namespace {

std::string recallText(const v1::Collection& collection) {
  if (!collection.has_wanted_recall()) return "";
  return ", approximate search (recall " + brief(collection.wanted_recall()) + " wanted, " +
         (collection.has_recall() ? brief(collection.recall()) + " measured" : "exact so far") +
         ")";
}

Status showCollection(Session& session, const v1::Collection& collection) {
  if (session.json()) return session.printJson(collection);
  if (session.quiet()) return {};
  return session.print(safe(idOf(collection.name())) + ": " +
                       counted(collection.shape_count(), "shape", "shapes") +
                       recallText(collection) + "\n");
}

std::optional<double> recallOf(const Arguments& arguments) {
  if (!arguments.has("approximate")) return std::nullopt;
  return arguments.number("approximate", 0);
}

Status runCreate(Session& session, const Arguments& arguments) {
  const std::string name = arguments.text("NAME");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kCreate));
  const Result<v1::Collection> result = client->createCollection(name, recallOf(arguments));
  if (!result.ok()) return session.explain(name, result.status());
  return showCollection(session, *result);
}

Status runEdit(Session& session, const Arguments& arguments) {
  const std::string name = arguments.text("NAME");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const auto result = client->setWantedRecall(collectionName(name), recallOf(arguments));
  if (!result.ok()) return session.explain(name, result.status());
  return showCollection(session, *result);
}

std::optional<std::string> checkEdit(const Arguments& arguments) {
  if (arguments.has("approximate") != arguments.has("exact")) return std::nullopt;
  return "give either --approximate or --exact";
}

Status runShow(Session& session, const Arguments& arguments) {
  const std::string name = arguments.text("NAME");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const Result<v1::Collection> result = client->getCollection(collectionName(name));
  if (!result.ok()) return session.explain(name, result.status());
  return showCollection(session, *result);
}

Status runDelete(Session& session, const Arguments& arguments) {
  const std::string name = arguments.text("NAME");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const auto result = client->deleteCollection(collectionName(name), arguments.has("force"));
  if (!result.ok()) return session.explain(name, result.status());
  if (session.json()) return session.printJson(*result);
  if (session.quiet()) return {};
  return session.print(name + ": deleted, with " +
                       counted(result->deleted_shapes(), "shape", "shapes") + "\n");
}

Result<v1::ListCollectionsResponse> allCollections(Session& session) {
  v1::ListCollectionsResponse all;
  if (!session.hasStore()) return all;  // Nothing is stored yet: an empty list, not an error.
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  Pager<v1::Collection> pager = client->listCollections();
  while (true) {
    Result<std::optional<v1::Collection>> next = pager.next();
    if (!next.ok()) return session.explain("collection list", next.status());
    if (!*next) return all;
    *all.add_collections() = **std::move(next);
  }
}

Status runList(Session& session, const Arguments&) {
  ASSIGN_OR_RETURN(const v1::ListCollectionsResponse all, allCollections(session));
  if (session.json()) return session.printJson(all);
  if (session.quiet()) return {};
  if (all.collections().empty()) return session.print("no collections\n");
  std::vector<std::vector<std::string>> rows;
  for (const v1::Collection& collection : all.collections()) {
    rows.push_back({safe(idOf(collection.name())), std::to_string(collection.shape_count())});
  }
  return session.print(alignedTable({"collection", "shapes"}, rows));
}

std::optional<std::string> isRecall(const std::string& value) {
  const auto number = parseDouble(value);
  if (number && *number > 0 && *number < 1) return std::nullopt;
  return "must be a number between 0 and 1";
}

OptionSpec approximateOption() {
  return {.names = "--approximate",
          .value = "[RECALL]",
          .help =
              "Large collections: find at least this share of the true ten nearest on average "
              "(0.99), faster",
          .check = isRecall,
          .bare_value = "0.99"};
}

ArgumentSpec nameArgument() {
  return {.name = "NAME",
          .help = "1 to 63 of letters, digits, '-', '_' and '.'",
          .completion = Completion::kNothing};
}

}  // namespace

std::vector<CommandSpec> collectionCommands() {
  return {
      {.path = "collection create",
       .summary = "Make an empty collection",
       .details = "Adding shapes to a collection that is not there makes it, too.",
       .arguments = {nameArgument()},
       .options = {approximateOption()},
       .run = runCreate,
       .examples = "moduli collection create parts\nmoduli collection create scans "
                   "--approximate=0.95"},
      {.path = "collection edit",
       .summary = "Change how a collection is searched",
       .details = "Approximate search looks at a part of a large collection, thousands of "
                  "shapes and more, in the metric and the shape space; its answers say what "
                  "share of the true nearest it finds, as measured. Smaller collections, "
                  "searches with a filter and the conformal space stay exact.",
       .arguments = {nameArgument()},
       .options = {approximateOption(),
                   {.names = "--exact", .value = "", .help = "Find all of the nearest"}},
       .check = checkEdit,
       .run = runEdit,
       .examples = "moduli collection edit scans --approximate"},
      {.path = "collection list",
       .summary = "List the collections",
       .details = "With the number of shapes in each.",
       .arguments = {},
       .options = {},
       .run = runList},
      {.path = "collection show",
       .summary = "Tell about one collection",
       .details = "How many shapes it has, and how it is searched. Fails if there is none of this "
                  "name.",
       .arguments = {nameArgument()},
       .options = {},
       .run = runShow},
      {.path = "collection delete",
       .summary = "Delete a collection",
       .details = "A collection that has shapes is refused without --force.",
       .arguments = {nameArgument()},
       .options = {{.names = "--force", .value = "", .help = "Also delete the shapes in it"}},
       .run = runDelete}};
}

}  // namespace moduli::cli
