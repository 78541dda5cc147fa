#include "client/cli/command.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/report.h"
#include "client/cli/session.h"

/// inspect, signature, distance: computing on meshes without storing anything.
namespace moduli::cli {
namespace {

constexpr const char* kMeshHelp =
    "A file, '-' for standard input, or COLLECTION/SHAPE of the store; an existing file wins, "
    "store:COLLECTION/SHAPE names the store in any case";

Status runInspect(Session& session, const Arguments& arguments) {
  ASSIGN_OR_RETURN(const MeshArgument mesh,
                   MeshArgument::open(session, arguments.text("MESH"), arguments.text("format")));
  ASSIGN_OR_RETURN(Client* const client, session.client(mesh.need()));
  v1::InspectMeshRequest request;
  Result<v1::MeshSource> source = mesh.source(*client);
  if (!source.ok()) return session.explain(mesh.name(), source.status());
  *request.mutable_source() = *std::move(source);
  const Result<v1::Inspection> result = client->inspect(request);
  if (!result.ok()) return session.explain(mesh.name(), result.status());
  if (session.json()) return session.printJson(*result);
  return session.quiet() ? Status() : session.print(inspectionReport(mesh.name(), *result));
}

Status runSignature(Session& session, const Arguments& arguments) {
  ASSIGN_OR_RETURN(const MeshArgument mesh,
                   MeshArgument::open(session, arguments.text("MESH"), arguments.text("format")));
  ASSIGN_OR_RETURN(Client* const client, session.client(mesh.need()));
  v1::ComputeSignatureRequest request;
  Result<v1::MeshSource> source = mesh.source(*client);
  if (!source.ok()) return session.explain(mesh.name(), source.status());
  *request.mutable_source() = *std::move(source);
  *request.mutable_prepare() = prepareOf(arguments);
  request.set_space(spaceOf(arguments));
  if (arguments.has("initial-delaunay")) {
    request.set_initial_delaunay(arguments.text("initial-delaunay") == "on");
  }
  if (arguments.has("spectrum-length")) {
    request.set_spectrum_length(arguments.number("spectrum-length", 0));
  }
  const Result<v1::Signature> result = client->computeSignature(request);
  if (!result.ok()) return session.explain(mesh.name(), result.status());
  if (session.json()) return session.printJson(*result);
  return session.quiet() ? Status() : session.print(signatureReport(mesh.name(), *result));
}

Status runDistance(Session& session, const Arguments& arguments) {
  const std::string format = arguments.text("format");
  ASSIGN_OR_RETURN(const MeshArgument a, MeshArgument::open(session, arguments.text("A"), format));
  ASSIGN_OR_RETURN(const MeshArgument b, MeshArgument::open(session, arguments.text("B"), format));
  ASSIGN_OR_RETURN(Client* const client, session.client(a.stored() ? a.need() : b.need()));
  v1::CompareSignaturesRequest request;
  *request.mutable_prepare() = prepareOf(arguments);
  const auto send = [&](const MeshArgument& mesh, v1::MeshSource& target) -> Status {
    Result<v1::MeshSource> source = mesh.source(*client);
    if (!source.ok()) return session.explain(mesh.name(), source.status());
    target = *std::move(source);
    return {};
  };
  RETURN_IF_ERROR(send(a, *request.mutable_a()->mutable_source()));
  RETURN_IF_ERROR(send(b, *request.mutable_b()->mutable_source()));
  const Result<v1::SignatureDistances> result = client->compareSignatures(request);
  if (!result.ok()) {
    const Status status = result.status();
    const bool named =
        status.message().starts_with(a.name()) || status.message().starts_with(b.name());
    return session.explain(named ? "" : a.name() + " and " + b.name(), status);
  }
  if (session.json()) return session.printJson(*result);
  return session.quiet() ? Status() : session.print(distancesReport(*result));
}

std::optional<std::string> checkDistance(const Arguments& arguments) {
  if (arguments.text("A") != "-" || arguments.text("B") != "-") return std::nullopt;
  return "only one of the two can come from standard input";
}

std::vector<OptionSpec> signatureOptions() {
  std::vector<OptionSpec> options = {
      spaceOption("Compute this space only, and do only the work that it needs; default: all")};
  options.push_back(initialDelaunayOption());
  options.push_back(
      {.names = "--spectrum-length",
       .value = "L",
       .help =
           "Find all closed geodesics of a hyperbolic surface up to this length (curvature -1), "
           "as far as they are not too many; default: half as long again as the shortest, or "
           "less where that takes long",
       .check = isPositiveNumber});
  for (OptionSpec& option : prepareOptions()) options.push_back(std::move(option));
  options.push_back(formatOption());
  return options;
}

std::vector<OptionSpec> distanceOptions() {
  std::vector<OptionSpec> options = prepareOptions();
  options.push_back(formatOption());
  return options;
}

}  // namespace

std::vector<CommandSpec> computeCommands() {
  return {
      {.path = "inspect",
       .summary = "Tell a mesh's topology and every defect",
       .details = "Exits 0 on any file that can be read, valid or not, names every defect with the "
                  "numbers of its elements (counted from 0 in the file's order), and says what "
                  "--repair would do about it. An intrinsic triangulation (.json) that has defects "
                  "cannot be read: the first one is the error.",
       .arguments = {{.name = "MESH", .help = kMeshHelp}},
       .options = {formatOption()},
       .run = runInspect,
       .examples = "moduli inspect bunny.obj\nmoduli inspect --json - --format off < torus.off"},
      {.path = "signature",
       .summary = "Compute the signature of a surface",
       .details = "The signature tells what a surface keeps when it is deformed: its conformal "
                  "class (space conformal), what bending keeps (metric), and what rigid motion and "
                  "scaling keep (shape). Every connected surface has a conformal class: tau for a "
                  "torus, the modulus of a ring, a period matrix and its energies for anything "
                  "with more handles or holes, each with a certified error; the latter also have a "
                  "hyperbolic metric: their closed geodesics, shortest first, the generators of "
                  "their group, and lengths and twists of the curves that cut them into pairs of "
                  "pants. Every "
                  "surface has the other two as well, unless it comes without positions, as an "
                  "intrinsic triangulation (.json). The certificate that comes with it "
                  "carries the residuals to judge it by. A surface of several components is "
                  "refused unless --component says which one is meant.",
       .arguments = {{.name = "MESH", .help = kMeshHelp}},
       .options = signatureOptions(),
       .run = runSignature,
       .examples =
           "moduli signature kitten.off\nmoduli signature --json --space conformal pretzel.off\n"
           "moduli signature pretzel.off --spectrum-length 4"},
      {.path = "distance",
       .summary = "Tell how far two surfaces are apart in each space",
       .details = "Compares the signatures of two surfaces, without a map between them. A space in "
                  "which the two have no distance, because their topologies differ, is left out.",
       .arguments = {{.name = "A", .help = kMeshHelp}, {.name = "B", .help = "As A"}},
       .options = distanceOptions(),
       .check = checkDistance,
       .run = runDistance,
       .examples = "moduli distance kitten.off kitten-coarse.off"}};
}

}  // namespace moduli::cli
