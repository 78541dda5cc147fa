#include <functional>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/file_writer.h"
#include "client/cli/report.h"
#include "client/cli/session.h"

/// list, show, remove, get: shapes of a collection.
namespace moduli::cli {
namespace {

constexpr std::size_t kRowsAtOnce = 1000;

// The conformal type; a dash where the block was left out.
std::string typeWord(const v1::Signature& signature) {
  return signature.has_conformal() ? v1::ConformalBlock::Type_Name(signature.conformal().type())
                                   : "-";
}

std::vector<std::string> listRow(const v1::Shape& shape) {
  const v1::Topology& topology = shape.signature().topology();
  return {safe(idOf(shape.name())),
          safe(shape.label()),
          typeWord(shape.signature()),
          topology.has_genus() ? std::to_string(topology.genus()) : "-",
          std::to_string(topology.boundary_loops()),
          std::to_string(topology.vertices()),
          std::to_string(topology.faces())};
}

Status eachShape(Session& session, const Arguments& arguments,
                 const std::function<Status(const v1::Shape&)>& use) {
  const std::string collection = arguments.text("collection");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  Pager<v1::Shape> pager = client->listShapes(collectionName(collection), arguments.text("filter"));
  while (true) {
    const Result<std::optional<v1::Shape>> next = pager.next();
    if (!next.ok()) return session.explain(collection, next.status());
    if (!*next) return {};
    RETURN_IF_ERROR(use(**next));
  }
}

// As a ListShapesResponse of one page. Each shape becomes text at once: as messages, a hundred
// thousand of them would fill the memory.
Status listAsJson(Session& session, const Arguments& arguments) {
  JsonWriter json;
  json.open("{").key("shapes").open("[");
  RETURN_IF_ERROR(eachShape(session, arguments, [&](const v1::Shape& shape) -> Status {
    ASSIGN_OR_RETURN(const std::string text, toJson(shape));
    json.document(text);
    return {};
  }));
  json.close("]").key("next_page_token").string("").close("}");
  return session.print(json.finish());
}

Status runList(Session& session, const Arguments& arguments) {
  if (session.json()) return listAsJson(session, arguments);
  std::vector<std::vector<std::string>> rows;
  const auto flush = [&]() -> Status {
    if (rows.empty() || !session.talks()) return {};
    const std::string table =
        alignedTable({"name", "label", "type", "genus", "loops", "vertices", "faces"}, rows);
    rows.clear();
    return session.print(table);
  };
  RETURN_IF_ERROR(eachShape(session, arguments, [&](const v1::Shape& shape) -> Status {
    rows.push_back(listRow(shape));
    return rows.size() == kRowsAtOnce ? flush() : Status();
  }));
  return flush();
}

Status runShow(Session& session, const Arguments& arguments) {
  const std::string shape = arguments.text("SHAPE");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const Result<v1::Shape> result = client->getShape(shapeName(arguments.text("collection"), shape));
  if (!result.ok()) return session.explain(shape, result.status());
  if (session.json()) return session.printJson(*result);
  return session.quiet() ? Status() : session.print(shapeReport(*result));
}

struct Removal {
  std::string name;
  Status status;
};

std::string removalJson(const std::vector<Removal>& removals, int removed) {
  JsonWriter json;
  json.open("{").key("removed").number(removed);
  json.key("failed").number(static_cast<double>(removals.size()) - removed);
  json.key("results").open("[");
  for (const Removal& removal : removals) {
    json.open("{").key("name").string(removal.name);
    json.key("outcome").string(removal.status.ok() ? "REMOVED" : "FAILED");
    json.key("reason").string(removal.status.ok() ? "" : reasonName(removal.status.reason()));
    json.key("message").string(removal.status.message()).close("}");
  }
  json.close("]").close("}");
  return json.finish();
}

Status runRemoveByFilter(Session& session, const Arguments& arguments) {
  const std::string collection = arguments.text("collection");
  v1::BatchDeleteShapesRequest request;
  request.set_parent(collectionName(collection));
  request.set_filter(arguments.text("filter"));
  request.set_validate_only(arguments.has("dry-run"));
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  const Result<v1::BatchDeleteShapesResponse> result = client->deleteShapes(request);
  if (!result.ok()) return session.explain(collection, result.status());
  if (session.json()) return session.printJson(*result);
  if (!session.talks()) return {};
  std::string text;
  for (const std::string& name : result->names()) text += safe(name) + "\n";
  if (result->names_size() < result->deleted_shapes()) text += "...\n";
  return session.print(text + collection + ": " +
                       counted(result->deleted_shapes(), "shape", "shapes") +
                       (request.validate_only() ? " would be removed\n" : " removed\n"));
}

Status runRemove(Session& session, const Arguments& arguments) {
  if (arguments.has("filter")) return runRemoveByFilter(session, arguments);
  const std::string collection = arguments.text("collection");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  std::vector<Removal> removals;
  int removed = 0;
  Status first;
  for (const std::string& shape : arguments.all("SHAPE")) {
    const Status status = session.explain(shape, client->deleteShape(shapeName(collection, shape)));
    removals.push_back({shape, status});
    if (status.ok()) ++removed;
    if (first.ok()) first = status;
  }
  if (session.json()) {
    RETURN_IF_ERROR(session.print(removalJson(removals, removed)));
  } else if (session.talks()) {
    RETURN_IF_ERROR(session.print(
        collection + ": " + counted(removed, "shape", "shapes") + " removed" +
        (first.ok() ? "" : ", " + std::to_string(removals.size() - removed) + " failed") + "\n"));
  }
  return first;
}

// A name of the server's, as one of a file in this folder: no path, nothing hidden, nothing that a
// terminal would obey.
std::string localFileName(const std::string& told, const std::string& shape) {
  std::string name = safe(idOf(told));
  while (name.starts_with('.') || name.starts_with('-')) name.erase(0, 1);
  return name.empty() ? safe(shape) : name;
}

std::string downloadJson(const std::string& shape, const std::string& file,
                         const Client::DownloadHeader& header) {
  JsonWriter json;
  json.open("{").key("name").string(shape).key("file").string(file);
  json.key("format").string(v1::MeshSource::Format_Name(header.format));
  json.key("bytes").number(static_cast<double>(header.size)).close("}");
  return json.finish();
}

Status runGet(Session& session, const Arguments& arguments) {
  const std::string collection = arguments.text("collection");
  const std::string shape = arguments.text("SHAPE");
  std::string output = arguments.text("output");
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  if (output.empty()) {
    const Result<v1::Shape> facts = client->getShape(shapeName(collection, shape));
    if (!facts.ok()) return session.explain(shape, facts.status());
    output = localFileName(facts->file_name(), shape);
  }
  const bool to_stdout = output == "-";
  FileWriter writer(output, arguments.has("force"));
  if (!to_stdout) RETURN_IF_ERROR(writer.open());
  const auto result = client->download(shapeName(collection, shape), [&](std::string_view piece) {
    return to_stdout ? session.print(piece) : writer.write(piece);
  });
  if (!result.ok()) return session.explain(shape, result.status());
  if (to_stdout) return {};
  RETURN_IF_ERROR(writer.commit());
  if (session.json()) return session.print(downloadJson(shape, output, *result));
  if (session.quiet()) return {};
  return session.print(safe(shape) + ": " + counted(result->size, "byte", "bytes") + " in " +
                       output + "\n");
}

std::optional<std::string> checkRemove(const Arguments& arguments) {
  if (arguments.has("filter") == arguments.has("SHAPE")) {
    return "what to remove is either named or said by --filter";
  }
  if (arguments.has("dry-run") && !arguments.has("filter")) return "--dry-run is for --filter";
  return std::nullopt;
}

Status runEdit(Session& session, const Arguments& arguments) {
  const std::string collection = arguments.text("collection"), shape = arguments.text("SHAPE");
  v1::UpdateShapeRequest request;
  request.mutable_shape()->set_name(shapeName(collection, shape));
  request.set_new_shape_id(arguments.text("rename"));
  if (arguments.has("label")) {
    request.mutable_shape()->set_label(arguments.text("label"));
    request.mutable_update_mask()->add_paths("label");
  }
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  if (arguments.has("tag") || arguments.has("untag")) {
    // Tags go as a whole: those that are there, with what is said of them.
    const Result<v1::Shape> now = client->getShape(request.shape().name());
    if (!now.ok()) return session.explain(shape, now.status());
    auto& tags = *request.mutable_shape()->mutable_tags();
    tags = now->tags();
    for (const std::string& key : arguments.all("untag")) tags.erase(key);
    for (const std::string& word : arguments.all("tag")) {
      const std::size_t sign = word.find('=');
      tags[word.substr(0, sign)] = word.substr(sign + 1);
    }
    request.mutable_update_mask()->add_paths("tags");
  }
  const Result<v1::Shape> result = client->updateShape(request);
  if (!result.ok()) return session.explain(shape, result.status());
  if (session.json()) return session.printJson(*result);
  return session.quiet() ? Status() : session.print(shapeReport(*result));
}

std::optional<std::string> checkEdit(const Arguments& arguments) {
  for (const char* key : {"rename", "label", "tag", "untag"}) {
    if (arguments.has(key)) return std::nullopt;
  }
  return "nothing to change is given: --rename, --label, --tag or --untag";
}

std::optional<std::string> checkGet(const Arguments& arguments) {
  if (arguments.text("SHAPE").find('/') == std::string::npos) return std::nullopt;
  return "SHAPE is a name within the collection, without '/'";
}

ArgumentSpec shapeArgument(int max) {
  return {.name = "SHAPE",
          .help = "Name of a shape in the collection",
          .max = max,
          .completion = Completion::kNothing};
}

}  // namespace

std::vector<CommandSpec> shapeCommands() {
  return {
      {.path = "list",
       .summary = "List the shapes of a collection",
       .details = "By name.",
       .arguments = {},
       .options = {collectionOption(),
                   {.names = "--filter",
                    .value = "EXPR",
                    .help = "Only shapes for which this holds, as in 'genus >= 1 AND label = "
                            "\"cup\"'; fields: name label type genus boundary_loops vertices faces "
                            "area tags.KEY"}},
       .run = runList,
       .examples = "moduli list -c demo\nmoduli list -c demo --filter 'type = \"TORUS\"' --json"},
      {.path = "show",
       .summary = "Tell all about a stored shape",
       .details = "Its label, tags, file and signature.",
       .arguments = {shapeArgument(1)},
       .options = {collectionOption()},
       .run = runShow},
      {.path = "remove",
       .summary = "Remove shapes from a collection",
       .details = "One that cannot be removed does not stop the others. With --filter all for "
                  "which it holds go in one step.",
       .arguments = {[] {
         ArgumentSpec shapes = shapeArgument(-1);
         shapes.min = 0;
         return shapes;
       }()},
       .options = {collectionOption(),
                   {.names = "--filter",
                    .value = "EXPR",
                    .help = "Remove all shapes for which this holds, as in 'label = \"cup\"'"},
                   {.names = "--dry-run",
                    .value = "",
                    .help = "Only tell which shapes --filter would remove"}},
       .check = checkRemove,
       .run = runRemove,
       .examples = "moduli remove -c demo kitten\n"
                   "moduli remove -c demo --filter 'genus > 3' --dry-run"},
      {.path = "edit",
       .summary = "Change the name, label or tags of a stored shape",
       .details = "Its file and signature stay.",
       .arguments = {shapeArgument(1)},
       .options = {collectionOption(),
                   {.names = "--rename", .value = "NAME", .help = "Another name"},
                   {.names = "--label", .value = "LABEL", .help = "Another label; '' for none"},
                   {.names = "--tag",
                    .value = "KEY=VALUE",
                    .help = "Set a tag; may be repeated",
                    .check = isKeyValue,
                    .repeated = true},
                   {.names = "--untag",
                    .value = "KEY",
                    .help = "Drop a tag; may be repeated",
                    .repeated = true}},
       .check = checkEdit,
       .run = runEdit,
       .examples = "moduli edit -c demo kitten --label cat --tag year=2020"},
      {.path = "get",
       .summary = "Get the file of a stored shape back",
       .details = "The very bytes that were added. The file goes under its old name into the "
                  "current folder unless --output names another; a file that is there is kept "
                  "unless --force is given.",
       .arguments = {shapeArgument(1)},
       .options = {collectionOption(),
                   {.names = "-o,--output",
                    .value = "FILE",
                    .help = "Where to; '-' for standard output",
                    .completion = Completion::kFile},
                   {.names = "--force", .value = "", .help = "Overwrite a file that is there"}},
       .check = checkGet,
       .run = runGet}};
}

}  // namespace moduli::cli
