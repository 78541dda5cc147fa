#include "client/cli/command.h"
#include "client/cli/file_writer.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/report.h"
#include "client/cli/search_batch.h"
#include "client/cli/search_picture.h"
#include "client/cli/session.h"

/// search.
namespace moduli::cli {
namespace {

constexpr int kDefaultHits = 10;

Status writePicture(Client& client, const SearchPicture& picture, const std::string& path) {
  ASSIGN_OR_RETURN(const std::string png, drawSearch(client, picture));
  FileWriter writer(path, true);
  RETURN_IF_ERROR(writer.open());
  RETURN_IF_ERROR(writer.write(png));
  return writer.commit();
}

Status runSearch(Session& session, const Arguments& arguments) {
  if (isBatch(arguments)) return runSearchBatch(session, arguments);
  const std::string collection = arguments.text("collection");
  v1::SearchShapesRequest request;
  request.set_parent(collectionName(collection));
  request.set_k(arguments.integer("k", kDefaultHits));
  request.set_space(spaceOf(arguments));
  request.set_filter(arguments.text("filter"));
  request.set_explain(arguments.has("explain"));
  *request.mutable_prepare() = prepareOf(arguments);

  std::string what = arguments.text("id", arguments.text("MESH"));
  std::optional<MeshArgument> mesh;
  if (arguments.has("MESH")) {
    ASSIGN_OR_RETURN(mesh, MeshArgument::open(session, what, arguments.text("format")));
    what = mesh->name();
  }
  ASSIGN_OR_RETURN(Client* const client, session.client(StoreNeed::kExisting));
  if (!mesh) {
    request.set_shape(shapeName(collection, what));
  } else if (mesh->stored()) {
    request.set_shape(mesh->resource());
  } else {
    Result<v1::MeshSource> source = mesh->source(*client);
    if (!source.ok()) return session.explain(what, source.status());
    *request.mutable_source() = *std::move(source);
  }
  const Result<v1::SearchResult> result = client->search(request);
  if (!result.ok()) return session.explain(what, result.status());
  if (arguments.has("picture")) {
    const SearchPicture picture{.collection = collection,
                                .query = what,
                                .query_resource = request.shape(),
                                .mesh = mesh && !mesh->stored() ? &*mesh : nullptr,
                                .result = *result};
    RETURN_IF_ERROR(writePicture(*client, picture, arguments.text("picture")));
  }
  if (session.json()) return session.printJson(*result);
  return session.quiet() ? Status() : session.print(searchReport(*result));
}

std::optional<std::string> checkSearch(const Arguments& arguments) {
  const int ways = (arguments.has("MESH") || arguments.has("from-file") ? 1 : 0) +
                   (arguments.has("id") ? 1 : 0) + (arguments.has("all") ? 1 : 0);
  if (ways != 1) {
    return "what to search for is either MESH or --from-file LIST, --id ID, or --all";
  }
  if (arguments.has("picture") && isBatch(arguments)) return "--picture draws one query's hits";
  return std::nullopt;
}

}  // namespace

std::vector<CommandSpec> searchCommands() {
  std::vector<OptionSpec> options = {
      collectionOption(),
      {.names = "--id",
       .value = "ID",
       .help = "Search for a shape of this collection; may be repeated",
       .repeated = true},
      {.names = "--from-file",
       .value = "LIST",
       .help = "Also search for what this file names, one MESH a line; '-' for standard input",
       .completion = Completion::kFile},
      {.names = "--all", .value = "", .help = "Search for every shape of this collection"},
      {.names = "-k",
       .value = "N",
       .help = "Number of hits (10); more than there are gives all",
       .check = isPositiveInteger},
      spaceOption("What counts as near (shape)"),
      {.names = "--filter",
       .value = "EXPR",
       .help = "Only shapes for which this holds, as in 'genus >= 1 AND label = \"cup\"'"}};
  options.push_back({.names = "--explain",
                     .value = "",
                     .help = "Also tell how far each hit is in each part of the descriptor"});
  options.push_back({.names = "--picture",
                     .value = "OUT.png",
                     .help = "Draw the query and the hits",
                     .completion = Completion::kFile});
  for (OptionSpec& option : prepareOptions()) options.push_back(std::move(option));
  options.push_back(formatOption());
  return {{.path = "search",
           .summary = "Find the stored shapes nearest to a surface",
           .details = "Ranks the shapes of a collection by their distance from a surface: a mesh "
                      "that is signed first, or a shape that is stored. A stored shape finds "
                      "itself first; equal distances come by name. Several surfaces are searched "
                      "for at once, which is much faster, and get a list of hits each; one that "
                      "fails does not stop the others, and makes the exit code 1.",
           .arguments = {{.name = "MESH",
                          .help = "Files, '-' for standard input, or COLLECTION/SHAPE",
                          .min = 0,
                          .max = -1}},
           .options = options,
           .check = checkSearch,
           .run = runSearch,
           .examples = "moduli search -c demo bunny.obj -k 5\nmoduli search -c demo --id kitten "
                       "--space conformal\nmoduli search -c demo --all -k 2 --json"}};
}

}  // namespace moduli::cli
