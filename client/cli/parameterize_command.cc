#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <complex>
#include <iterator>
#include <optional>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/parameterize_files.h"
#include "client/cli/parameterize_picture.h"
#include "client/cli/plane_options.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/registration.h"
#include "client/cli/report.h"
#include "client/cli/session.h"
#include "client/cli/side_file.h"

/// parameterize.
namespace moduli::cli {
namespace {

using Options = v1::ParameterizationOptions;

// "vertex-scaling" of VERTEX_SCALING: how enum values are spelled on the command line.
std::string spelled(std::string name) {
  for (char& c : name) c = c == '_' ? '-' : static_cast<char>(std::tolower(c));
  return name;
}

// The enum value that is spelled so; its zero for "" and for a word that names none.
template <typename Enum>
Enum valueOf(const std::string& word, bool (*parse)(google::protobuf::ConstStringParam, Enum*)) {
  std::string name = word;
  for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
  Enum value{};
  return word == spelled(name) && parse(name, &value) ? value : Enum{};
}

Options::Boundary boundaryOf(const Arguments& arguments) {
  return valueOf(arguments.text("boundary"), Options::Boundary_Parse);
}

// "1", "-0.5", "2i", "0.3-1.2i": a number with or without an imaginary part.
std::optional<std::complex<double>> parseComplex(std::string_view word) {
  const auto number = [](std::string_view text) -> std::optional<double> {
    if (text == "+" || text == "-" || text.empty()) return text == "-" ? -1 : 1;
    if (text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
  };
  if (word.empty()) return std::nullopt;
  if (word.back() != 'i') {
    const std::optional<double> real = number(word);
    const bool digits = word.find_first_of("0123456789") != std::string_view::npos;
    return real && digits ? std::optional(std::complex<double>(*real, 0)) : std::nullopt;
  }
  word.remove_suffix(1);
  // The sign that starts the imaginary part: the last one that belongs to no exponent.
  std::size_t split = word.size();
  while (split-- > 0) {
    const bool sign = word[split] == '+' || word[split] == '-';
    if (sign && (split == 0 || (word[split - 1] != 'e' && word[split - 1] != 'E'))) break;
  }
  if (split == std::string_view::npos) split = 0;
  const std::optional<double> imaginary = number(word.substr(split));
  const std::optional<double> real = split == 0 ? 0 : number(word.substr(0, split));
  if (!real || !imaginary) return std::nullopt;
  return std::complex<double>(*real, *imaginary);
}

std::vector<std::string> listed(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ',') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

// Four boundary vertices; nothing where they are not that.
std::optional<std::array<int, 4>> parseCorners(const std::string& text) {
  const std::vector<std::string> words = listed(text);
  std::array<int, 4> corners{};
  if (words.size() != corners.size()) return std::nullopt;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const std::string& word = words[n];
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), corners[n]);
    if (error != std::errc() || end != word.data() + word.size() || corners[n] < 0) {
      return std::nullopt;
    }
  }
  return corners;
}

std::optional<std::array<std::complex<double>, 4>> parseMobius(const std::string& text) {
  const std::vector<std::string> words = listed(text);
  std::array<std::complex<double>, 4> entries;
  if (words.size() != entries.size()) return std::nullopt;
  for (std::size_t n = 0; n < entries.size(); ++n) {
    const std::optional<std::complex<double>> entry = parseComplex(words[n]);
    if (!entry) return std::nullopt;
    entries[n] = *entry;
  }
  return entries;
}

Status readInto(const std::string& path, const std::string& hint, std::vector<ConeLine>& cones) {
  const Result<std::vector<ConeLine>> lines = readCones(path);
  if (!lines.ok()) {
    const Status status = lines.status();
    if (status.reason() != Reason::kFileNotFound) return status;
    return {status.reason(), status.message(), hint};
  }
  cones.insert(cones.end(), lines->begin(), lines->end());
  return {};
}

// The options of a request, with the side files read. A file of the boundary's curvatures is more
// cones, on a boundary that is straight elsewhere.
Result<Options> optionsOf(const Arguments& arguments) {
  Options options;
  options.set_target(valueOf(arguments.text("to"), Options::Target_Parse));
  options.set_scheme(valueOf(arguments.text("scheme"), Options::Scheme_Parse));
  options.set_solver(valueOf(arguments.text("solver"), Options::Solver_Parse));
  options.set_boundary(boundaryOf(arguments));
  options.set_method(valueOf(arguments.text("method"), Options::Method_Parse));
  if (arguments.has("refine")) options.set_refine(arguments.text("refine") == "auto");
  if (arguments.has("corners")) {
    const auto corners = parseCorners(arguments.text("corners")).value_or(std::array<int, 4>{});
    for (const int corner : corners) options.add_corners(corner);
  }
  if (arguments.has("mobius")) {
    const auto mobius =
        parseMobius(arguments.text("mobius")).value_or(std::array<std::complex<double>, 4>{});
    for (const std::complex<double>& entry : mobius) {
      v1::Complex& message = *options.add_mobius();
      message.set_re(entry.real());
      message.set_im(entry.imag());
    }
  }
  if (arguments.has("initial-delaunay")) {
    options.set_initial_delaunay(arguments.text("initial-delaunay") == "on");
  }
  setPlaneOptions(arguments, options);
  std::vector<ConeLine> cones;
  if (arguments.has("cones") && !choosesCones(arguments)) {
    RETURN_IF_ERROR(readInto(arguments.text("cones"), "check the path given to --cones", cones));
  }
  if (arguments.has("seams")) {
    ASSIGN_OR_RETURN(const auto seams, readSeams(arguments.text("seams")));
    for (const std::vector<int>& seam : seams) {
      v1::SeamPath& path = *options.add_seams();
      path.mutable_vertices()->Add(seam.begin(), seam.end());
    }
  }
  if (arguments.has("boundary") && options.boundary() == Options::BOUNDARY_UNSPECIFIED) {
    options.set_boundary(Options::STRAIGHT);
    RETURN_IF_ERROR(readInto(arguments.text("boundary"),
                             "--boundary takes straight, circle, free or a file", cones));
  }
  RETURN_IF_ERROR(checkDistinct(cones));
  for (const ConeLine& line : cones) {
    v1::Cone& cone = *options.add_cones();
    cone.set_vertex(line.vertex);
    cone.set_curvature(line.curvature);
  }
  return options;
}

std::string writtenLine(const std::string& path, const ParameterizedMesh& mesh) {
  const auto count = [](std::size_t numbers, std::size_t columns) {
    return static_cast<long long>(numbers / columns);
  };
  return safe(path) + ": " + counted(count(mesh.positions.size(), 3), "vertex", "vertices") + ", " +
         counted(count(mesh.faces.size(), 3), "face", "faces") + ", " +
         counted(count(mesh.points.size(), 2), "texture point", "texture points") + "\n";
}

Status runParameterize(Session& session, const Arguments& arguments) {
  v1::ParameterizeRequest request;
  ASSIGN_OR_RETURN(*request.mutable_options(), optionsOf(arguments));
  *request.mutable_prepare() = prepareOf(arguments);
  ParameterizeFiles outputs(arguments);
  request.set_omit_arrays(!outputs.wanted());
  ASSIGN_OR_RETURN(const RegistrationFiles registration,
                   RegistrationFiles::open(session, arguments));
  ASSIGN_OR_RETURN(const MeshArgument mesh,
                   MeshArgument::open(session, arguments.text("MESH"), arguments.text("format")));
  RETURN_IF_ERROR(outputs.open());
  ASSIGN_OR_RETURN(Client* const client,
                   session.client(std::max(mesh.need(), registration.need())));
  const auto explained = [&](const Status& status) {
    return session.explain(registration.subjectOf(status, mesh.name()), status);
  };
  Result<v1::MeshSource> source = mesh.source(*client, registration.inlineLimit());
  if (!source.ok()) return explained(source.status());
  *request.mutable_source() = *std::move(source);
  if (registration.wanted()) {
    Result<v1::SphereRegistration> message = registration.message(*client);
    if (!message.ok()) return explained(message.status());
    *request.mutable_options()->mutable_registration() = *std::move(message);
  }
  const Result<ParameterizedMesh> result = client->parameterize(request);
  if (!result.ok()) return explained(result.status());
  // Servers pass over what they do not know.
  if (registration.wanted() && !result->result.has_registration()) {
    return explained({Reason::kServerTooOld, "the server knows no registration"});
  }
  RETURN_IF_ERROR(outputs.write(*result, mesh, *client));
  if (session.json()) return session.printJson(result->result);
  if (session.quiet()) return {};
  std::string written =
      arguments.has("output") ? writtenLine(arguments.text("output"), *result) : "";
  if (arguments.has("carried")) {
    written += safe(arguments.text("carried")) + ": " +
               counted(static_cast<long long>(result->carried.size()), "value", "values") + "\n";
  }
  if (arguments.has("atlas")) {
    written += safe(arguments.text("atlas")) + ": " +
               counted(result->result.atlas().charts(), "chart", "charts") + ", " +
               counted(result->result.atlas().transitions(), "transition", "transitions") + "\n";
  }
  return session.print(parameterizationReport(mesh.name(), result->result) + written);
}

std::optional<std::string> checkParameterize(const Arguments& arguments) {
  if (arguments.has("boundary") && arguments.text("boundary").empty()) {
    return "--boundary takes straight, circle, free or a file";
  }
  if (arguments.has("corners") && !parseCorners(arguments.text("corners"))) {
    return "--corners takes four vertices of the boundary such as 0,12,40,55, not '" +
           arguments.text("corners") + "'";
  }
  if (arguments.has("mobius") && !parseMobius(arguments.text("mobius"))) {
    return "--mobius takes four numbers such as 1,0.2-0.1i,0.2+0.1i,1, not '" +
           arguments.text("mobius") + "'";
  }
  const bool rectangle = arguments.text("to") == "rectangle";
  if (rectangle != arguments.has("corners")) {
    return rectangle ? "--to rectangle needs its four corners: --corners a,b,c,d"
                     : "--corners are those of --to rectangle";
  }
  if (const auto wrong = checkPlaneOptions(arguments)) return wrong;
  if (const auto wrong = checkPicture(arguments)) return wrong;
  if (auto complaint = checkRegistrationArguments(arguments)) return complaint;
  return checkParameterizeFiles(arguments);
}

std::vector<OptionSpec> parameterizeOptions() {
  std::vector<OptionSpec> options = {
      {.names = "--to",
       .value = "TARGET",
       .help = "Where to",
       .choices = {"sphere", "disk", "circle-domain", "rectangle", "torus", "flat", "polycube",
                   "atlas", "quads", "hyperbolic"},
       .required = true},
      {.names = "--method",
       .value = "METHOD",
       .help = "How maps to the sphere and to disks are found (auto): 'robust' flattens with flips "
               "around a vertex at infinity, 'linear' solves linear systems alone, 'heat-flow' "
               "flows from the Gauss map to the harmonic one, disks by their double",
       .choices = {"auto", "robust", "linear", "heat-flow"}},
      {.names = "--corners",
       .value = "A,B,C,D",
       .help = "With --to rectangle: four vertices of the boundary in its order, the surface on "
               "the left; they go to 0, M, M + i and i"},
      {.names = "--mobius",
       .value = "A,B,C,D",
       .help = "With --to sphere or disk: moves the result by z -> (A z + B) / (C z + D), four "
               "numbers such as 0.5-2i; a disk must stay one"},
      {.names = "--refine",
       .value = "auto|off",
       .help = "Cut faces where no map of the given ones is free of folds (auto), or fail there",
       .choices = {"auto", "off"}},
      {.names = "--cones",
       .value = "FILE|auto",
       .help = "With --to flat: lines 'vertex curvature' (radians) where the plane has cones, or "
               "'auto': chosen to take stretching out. With --to polycube: its corners, of "
               "curvature pi/2 or -pi/2; chosen unless given",
       .completion = Completion::kFile},
      {.names = "--boundary",
       .value = "RULE|FILE",
       .help = "What the boundary becomes: 'free' (its lengths keep their ratios), 'circle' (every "
               "loop turns evenly where no cone stands), 'straight' (curvature 0 where no cone "
               "stands), or a file of lines 'vertex curvature' and straight elsewhere. Default: "
               "free, or straight where cones stand on it",
       .completion = Completion::kFile},
      {.names = "--scheme",
       .value = "SCHEME",
       .help = "How lengths change (vertex-scaling)",
       .choices = {"vertex-scaling", "thurston", "tangential", "inversive-distance"}},
      {.names = "--solver",
       .value = "SOLVER",
       .help = "How the metric is found (newton): by Newton's method, along affine normals of its "
               "energy, by limited-memory BFGS, or by the Ricci flow itself",
       .choices = {"newton", "affine-normal", "lbfgs", "flow"}},
      initialDelaunayOption()};
  std::vector<OptionSpec> files = parameterizeFileOptions();
  options.insert(options.begin() + 1, std::move_iterator(files.begin()),
                 std::move_iterator(files.end()));
  for (OptionSpec& option : planeOptions()) options.push_back(std::move(option));
  for (OptionSpec& option : pictureOptions()) options.push_back(std::move(option));
  for (OptionSpec& option : registrationOptions()) options.push_back(std::move(option));
  for (OptionSpec& option : prepareOptions()) options.push_back(std::move(option));
  options.push_back(formatOption());
  return options;
}

}  // namespace

std::vector<CommandSpec> parameterizeCommands() {
  return {
      {.path = "parameterize",
       .summary = "Map a surface to the sphere, a disk or the plane, keeping angles",
       .details =
           "--to sphere: a closed surface without handles, on the unit sphere, its centre of area "
           "in the middle. --to disk: one with one boundary loop, likewise. --to rectangle: the "
           "same with four corners; its width at height 1 is its modulus. --to circle-domain: one "
           "with boundary loops, to the unit disk with round holes. --to flat: any surface, by the "
           "metric that has the same angles, as far as a discrete one can, and is flat but for the "
           "cones that --cones names, cut open through them and laid out at the area of the "
           "surface; on a closed surface the curvatures of the cones must sum to 2 pi times its "
           "Euler characteristic: 4 pi on a sphere; a torus needs none. --cones auto chooses them. "
           "--to torus: a surface with one handle, a fundamental domain of its lattice; copies of "
           "it "
           "fill the plane, and the picture shows them. --to polycube: a closed surface, flat but "
           "for corners of cubes. --to atlas: a closed surface, flat but for extraordinary points, "
           "with a chart around every other vertex. --to quads: a closed surface with handles, by "
           "a "
           "form whose periods are whole: the lines of the unit squares go on across every cut. "
           "--to hyperbolic: a surface "
           "with more handles or holes than those, cut open, into the Poincaré disk, by the metric "
           "of curvature -1 for which its boundary is geodesic; the picture shows the copies "
           "beside it, and the shortest closed geodesics there and on the surface. OUT.obj keeps "
           "the "
           "vertices, "
           "the faces (polygons as fans) and the order of their corners, and has a texture point "
           "for each corner; on the sphere the vertices themselves move. Faces of other "
           "components, "
           "and what --repair drops, are written without. Where a face has to be cut, its pieces "
           "stand in its place and new vertices follow the input's. The certificate tells how near "
           "the map is to what was asked for, and how far it is from keeping angles. With "
           "--reference "
           "the sphere is laid onto that of another surface, such as one hemisphere of a brain "
           "onto the other: by landmarks that have to meet, by the rotation under which two fields "
           "are most alike, or, without either, by how much the maps change areas.",
       .arguments = {{.name = "MESH",
                      .help =
                          "A file, '-' for standard input, or COLLECTION/SHAPE of the store; an "
                          "existing file wins, store:COLLECTION/SHAPE names the store in any "
                          "case"}},
       .options = parameterizeOptions(),
       .check = checkParameterize,
       .run = runParameterize,
       .examples = "moduli parameterize bunny.obj --to sphere -o sphere.obj --picture sphere.png\n"
                   "moduli parameterize lh.pial --to sphere --reference rh.pial --mirror --field "
                   "lh.sulc --reference-field rh.sulc -o lh.sphere.gii\n"
                   "moduli parameterize bunny.obj --to flat --cones cones.txt -o bunny.glb\n"
                   "moduli parameterize face.obj --to disk --mobius 1,0.3i,-0.3i,1 -o disk.obj\n"
                   "moduli parameterize face.obj --to rectangle --corners 0,40,80,120 --json\n"
                   "moduli parameterize plate.obj --to circle-domain -o circles.obj\n"
                   "moduli parameterize torus.ply --to torus -o flat.obj --picture tiles.png\n"
                   "moduli parameterize kitten.obj --to quads --most-squares 4000 -o squares.obj\n"
                   "moduli parameterize spot.obj --to flat --cones auto --seamless -o uv.obj\n"
                   "moduli parameterize spot.obj --to polycube --picture cubes.png\n"
                   "moduli parameterize pretzel.off --to atlas --atlas charts.json\n"
                   "moduli parameterize pretzel.off --to hyperbolic --picture disk.svg\n"
                   "moduli parameterize bunny.obj --to flat --cones cones.txt -o bunny-uv.obj\n"
                   "moduli parameterize face.obj --to flat --boundary circle --json"}};
}

}  // namespace moduli::cli
