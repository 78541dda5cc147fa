#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <utility>

#include "client/cli/command.h"
#include "client/cli/file_writer.h"
#include "client/cli/landmark_file.h"
#include "client/cli/match_picture.h"
#include "client/cli/mesh_argument.h"
#include "client/cli/prepare_arguments.h"
#include "client/cli/report.h"
#include "client/cli/session.h"
#include "client/cli/vertex_map_file.h"
#include "core/base/context.h"
#include "core/mesh/read.h"

/// match.
namespace moduli::cli {
namespace {

/// Two meshes share one request, which has room for 8 MiB: larger ones are uploaded.
constexpr std::uint64_t kInlineShare = 2ULL << 20;

Result<v1::MatchOptions> optionsOf(const Arguments& arguments) {
  v1::MatchOptions options;
  options.set_mirror(arguments.has("mirror"));
  if (arguments.has("same-triangulation")) {
    options.set_same_triangulation(arguments.text("same-triangulation") == "on");
  }
  if (arguments.has("initial-delaunay")) {
    options.set_initial_delaunay(arguments.text("initial-delaunay") == "on");
  }
  options.set_alternative(arguments.integer("alternative", 0));
  if (arguments.has("landmarks")) {
    ASSIGN_OR_RETURN(v1::SphereRegistration landmarks, readLandmarks(arguments.text("landmarks")));
    options.mutable_landmarks()->Swap(landmarks.mutable_landmarks());
    options.mutable_curves()->Swap(landmarks.mutable_curves());
  }
  if (arguments.has("soft-landmarks")) {
    ASSIGN_OR_RETURN(v1::SphereRegistration landmarks,
                     readLandmarks(arguments.text("soft-landmarks")));
    options.mutable_soft_landmarks()->Swap(landmarks.mutable_landmarks());
    options.mutable_soft_curves()->Swap(landmarks.mutable_curves());
  }
  return options;
}

/// The two surfaces of the command line.
class Pair {
 public:
  static Result<Pair> open(const Session& session, const Arguments& arguments) {
    const std::string format = arguments.text("format");
    ASSIGN_OR_RETURN(MeshArgument a, MeshArgument::open(session, arguments.text("A"), format));
    ASSIGN_OR_RETURN(MeshArgument b, MeshArgument::open(session, arguments.text("B"), format));
    return Pair(std::move(a), std::move(b),
                {arguments.text("landmarks"), arguments.text("soft-landmarks")});
  }

  const MeshArgument& a() const { return a_; }
  const MeshArgument& b() const { return b_; }
  StoreNeed need() const { return std::max(a_.need(), b_.need()); }

  /// Failures speak of the file that their message begins with, or of both surfaces.
  Status explain(const Session& session, const Status& status) const {
    for (const std::string& name : {a_.name(), b_.name(), a_.resource(), b_.resource(),
                                    landmarks_.front(), landmarks_.back()}) {
      if (!name.empty() && status.message().starts_with(name + ":")) {
        return session.explain("", status);
      }
    }
    return session.explain(a_.name() + " and " + b_.name(), status);
  }

 private:
  Pair(MeshArgument a, MeshArgument b, std::array<std::string, 2> landmarks)
      : a_(std::move(a)), b_(std::move(b)), landmarks_(std::move(landmarks)) {}

  MeshArgument a_, b_;
  std::array<std::string, 2> landmarks_;  ///< Files.
};

Result<TriangleSoup> soupOf(Client& client, const MeshArgument& mesh, const std::string& format) {
  ASSIGN_OR_RETURN(const std::string bytes, mesh.content(client));
  Context context;
  ReadOptions options;
  options.name = mesh.name();
  if (!mesh.stored()) options.format = formatFromName(format);
  return readMesh(context, bytes, options);
}

Result<std::string> pictureOf(Client& client, const Arguments& arguments, const Pair& pair,
                              const MatchedSurfaces& match) {
  const std::string format = arguments.text("format");
  ASSIGN_OR_RETURN(const TriangleSoup a, soupOf(client, pair.a(), format));
  ASSIGN_OR_RETURN(const TriangleSoup b, soupOf(client, pair.b(), format));
  const auto shortName = [](const MeshArgument& mesh) {
    return std::filesystem::path(mesh.name()).filename().string();
  };
  MatchPicture picture{shortName(pair.a()),    shortName(pair.b()), a, b, match, {}, {},
                       arguments.has("mirror")};
  if (arguments.has("size")) {
    ASSIGN_OR_RETURN(picture.size, parsePictureSize(arguments.text("size")));
  }
  if (arguments.has("view")) {
    ASSIGN_OR_RETURN(picture.view, parsePictureView(arguments.text("view")));
  }
  return drawMatch(picture);
}

/// The files that a run writes.
class Outputs {
 public:
  explicit Outputs(const Arguments& arguments)
      : arguments_(arguments),
        map_(arguments.text("output"), true),
        inverse_(arguments.text("inverse"), true),
        picture_(arguments.text("picture"), true) {}

  bool wanted() const { return has("output") || has("inverse") || has("picture"); }

  /// Before the work, so that a place where nothing can be written is told in time.
  Status open() {
    if (has("output")) RETURN_IF_ERROR(map_.open());
    if (has("inverse")) RETURN_IF_ERROR(inverse_.open());
    if (has("picture")) RETURN_IF_ERROR(picture_.open());
    return {};
  }

  Status write(Client& client, const Pair& pair, const MatchedSurfaces& match) {
    if (has("output")) RETURN_IF_ERROR(writeMap(map_, match.map));
    if (has("inverse")) RETURN_IF_ERROR(writeMap(inverse_, match.inverse));
    if (has("picture")) {
      ASSIGN_OR_RETURN(const std::string bytes, pictureOf(client, arguments_, pair, match));
      RETURN_IF_ERROR(picture_.write(bytes));
      RETURN_IF_ERROR(picture_.commit());
    }
    if (has("inverse")) RETURN_IF_ERROR(inverse_.commit());
    return has("output") ? map_.commit() : Status();
  }

  /// What was written, as text.
  std::string lines(const MatchedSurfaces& match) const {
    std::string text;
    const auto add = [&](const std::string& key, const VertexMap& map) {
      if (!has(key)) return;
      text += safe(arguments_.text(key)) + ": " +
              counted(static_cast<long long>(map.faces.size()), "vertex", "vertices") + "\n";
    };
    add("output", match.map);
    add("inverse", match.inverse);
    return text;
  }

 private:
  bool has(const std::string& key) const { return arguments_.has(key); }

  static Status writeMap(FileWriter& writer, const VertexMap& map) {
    return writeVertexMap(map, [&writer](std::string_view text) { return writer.write(text); });
  }

  const Arguments& arguments_;
  FileWriter map_, inverse_, picture_;
};

Status runMatch(Session& session, const Arguments& arguments) {
  v1::MatchSurfacesRequest request;
  ASSIGN_OR_RETURN(*request.mutable_options(), optionsOf(arguments));
  *request.mutable_prepare() = prepareOf(arguments);
  Outputs outputs(arguments);
  request.set_omit_arrays(!outputs.wanted());
  request.set_inverse(arguments.has("inverse"));
  ASSIGN_OR_RETURN(const Pair pair, Pair::open(session, arguments));
  RETURN_IF_ERROR(outputs.open());
  ASSIGN_OR_RETURN(Client* const client, session.client(pair.need()));
  const auto send = [&](const MeshArgument& mesh, v1::MeshSource& target) -> Status {
    Result<v1::MeshSource> source = mesh.source(*client, kInlineShare);
    if (!source.ok()) return session.explain(mesh.name(), source.status());
    target = *std::move(source);
    return {};
  };
  RETURN_IF_ERROR(send(pair.a(), *request.mutable_a()));
  RETURN_IF_ERROR(send(pair.b(), *request.mutable_b()));
  const Result<MatchedSurfaces> result = client->match(request);
  if (!result.ok()) return pair.explain(session, result.status());
  RETURN_IF_ERROR(outputs.write(*client, pair, *result));
  if (session.json()) return session.printJson(result->result);
  if (session.quiet()) return {};
  return session.print(matchReport(pair.a().name() + " to " + pair.b().name(), result->result) +
                       outputs.lines(*result));
}

std::optional<std::string> checkPicture(const Arguments& arguments) {
  if (!arguments.has("picture")) {
    if (arguments.has("size")) return "--size is that of a --picture";
    if (arguments.has("view")) return "--view is that of a --picture";
    return std::nullopt;
  }
  const auto format = parsePictureFormat(arguments.text("picture"));
  if (!format.ok() || *format != PictureFormat::kPng) {
    return "a picture of a match is written as PNG: its file must end in .png, not '" +
           arguments.text("picture") + "'";
  }
  Status status;
  if (arguments.has("size")) status = parsePictureSize(arguments.text("size")).status();
  if (status.ok() && arguments.has("view")) {
    status = parsePictureView(arguments.text("view")).status();
  }
  if (status.ok()) return std::nullopt;
  return status.message() + "; " + status.hint();
}

std::optional<std::string> checkMatch(const Arguments& arguments) {
  if (arguments.text("A") == "-" && arguments.text("B") == "-") {
    return "only one of the two can come from standard input";
  }
  if (arguments.has("output") && arguments.text("output") == arguments.text("inverse")) {
    return "--inverse and --output name the same file";
  }
  return checkPicture(arguments);
}

std::vector<OptionSpec> matchOptions() {
  std::vector<OptionSpec> options = {
      {.names = "-o,--output",
       .value = "MAP.csv",
       .help = "Write the map: lines 'vertex,face,b0,b1,b2', for every vertex of A a face of B and "
               "the weights of its corners, all in the order of the files (polygons as fans from "
               "their first corner); the face -1 and weights 0 for a vertex of no face that is "
               "mapped",
       .completion = Completion::kFile},
      {.names = "--inverse",
       .value = "FILE.csv",
       .help = "Write the map back likewise: for every vertex of B a face of A",
       .completion = Completion::kFile},
      {.names = "--mirror", .value = "", .help = "Match A to the mirror image of B"},
      {.names = "--landmarks",
       .value = "FILE",
       .help = "Pairs of points that have to meet, A first: lines 'vertexA vertexB', 'faceA b0 b1 "
               "b2 faceB b0 b1 b2' (weights of the corners) or 'curve COUNT: a1 a2 ... : b1 b2 "
               "...' (paths of vertices, resampled to COUNT pairs). A point on a boundary goes to "
               "one on a boundary",
       .completion = Completion::kFile},
      {.names = "--soft-landmarks",
       .value = "FILE",
       .help = "Pairs likewise that the map is drawn to, more than to anything else near them, but "
               "may miss",
       .completion = Completion::kFile},
      {.names = "--alternative",
       .value = "K",
       .help = "The K-th of the other answers that the best one lists, as symmetric surfaces have "
               "them",
       .check = isPositiveInteger},
      {.names = "--same-triangulation",
       .value = "on|off",
       .help = "Whether meshes that differ by the numbering and the places of their vertices alone "
               "correspond by their triangulation (on, the default), or by their surfaces (off, "
               "and wherever there are landmarks)",
       .choices = {"on", "off"}},
      initialDelaunayOption(),
      {.names = "--picture",
       .value = "OUT.png",
       .help = "Draw both surfaces side by side, with the colours of B, or of its mirror image, "
               "carried "
               "to A",
       .completion = Completion::kFile},
      {.names = "--size", .value = "WxH", .help = "Of the picture, in pixels (1200x480)"},
      {.names = "--view",
       .value = "SIDE|X,Y,Z",
       .help = "From where the picture shows the surfaces: front, back, left, right, top, bottom, "
               "or the direction towards the eye"}};
  for (OptionSpec& option : prepareOptions()) options.push_back(std::move(option));
  options.push_back(formatOption());
  return options;
}

}  // namespace

std::vector<CommandSpec> matchCommands() {
  return {
      {.path = "match",
       .summary = "Find where each point of a surface is on another one",
       .details =
           "Maps A onto B, one to one and without a fold, so that corresponding points correspond: "
           "by the meshes' triangulation where they differ by numbering and places alone, by what "
           "bending keeps where the surfaces are poses of one thing, or by what Möbius maps of "
           "space keep, whichever agrees best. Both have to be of one genus and number of "
           "boundary loops, and boundaries go onto each other; --fill-holes closes small holes, "
           "--component takes one part of several; these and --repair apply to both. "
           "The distance tells how far the map is from keeping all lengths but for one scale. The "
           "certificate tells how much it bends angles and areas, how far points are from where "
           "they started when they go to B and back, and, for a surface that is nearly symmetric, "
           "the result names the other answers that are nearly as good. Maps speak of the files' "
           "vertices and faces: a vertex whose image lies on a hole that was filled goes to the "
           "nearest point of the faces around it; one that --repair has split goes where the first "
           "of its parts goes.",
       .arguments = {{.name = "A",
                      .help = "A file, '-' for standard input, or COLLECTION/SHAPE of the store; "
                              "an existing file wins, store:COLLECTION/SHAPE names the store in "
                              "any case"},
                     {.name = "B", .help = "As A"}},
       .options = matchOptions(),
       .check = checkMatch,
       .run = runMatch,
       .examples =
           "moduli match horse.obj camel.obj -o map.csv --picture match.png\n"
           "moduli match lh.pial rh.pial --mirror -o map.csv --inverse back.csv\n"
           "moduli match scan1.ply scan2.ply --repair --fill-holes --landmarks points.txt --json"}};
}

}  // namespace moduli::cli
