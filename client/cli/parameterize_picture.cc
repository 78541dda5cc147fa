#include "client/cli/parameterize_picture.h"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "client/cli/map_picture.h"
#include "client/cpp/mesh_bytes.h"
#include "core/base/context.h"
#include "core/mesh/format.h"
#include "core/mesh/read.h"
#include "core/mesh/vertex_data.h"

namespace moduli::cli {
namespace {

/// One value a vertex, of the file that --field names.
Result<std::vector<double>> fieldOf(const std::string& path, std::size_t vertices) {
  ASSIGN_OR_RETURN(const MeshBytes file, MeshBytes::ofFile(path));
  ASSIGN_OR_RETURN(const std::string bytes, file.read(0, file.size()));
  Context context;
  ASSIGN_OR_RETURN(VertexData data, readVertexData(context, bytes, path, vertices));
  return std::move(data.values);
}

/// x y z of every vertex of a mesh; nothing for an intrinsic triangulation.
Result<std::optional<std::vector<double>>> placeInSpace(Client& client, const MeshArgument& mesh) {
  ASSIGN_OR_RETURN(const std::string bytes, mesh.content(client));
  if (detectFormat(bytes, mesh.name()) == MeshFormat::kJson) {
    return std::optional<std::vector<double>>();
  }
  Context context;
  ReadOptions options;
  options.name = mesh.name();
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMesh(context, bytes, options));
  std::vector<double> places;
  places.reserve(3 * soup.vertices.size());
  for (const Eigen::Vector3d& p : soup.vertices) places.insert(places.end(), {p.x(), p.y(), p.z()});
  return std::optional(std::move(places));
}

}  // namespace

std::vector<OptionSpec> pictureOptions() {
  return {
      {.names = "--picture",
       .value = "OUT.png|OUT.svg",
       .help = "Draw the surface and its image side by side, under one checkerboard",
       .completion = Completion::kFile},
      {.names = "--draw",
       .value = "WHAT",
       .help = "What the picture and the colours of OUT.glb show instead: how far faces are "
               "from keeping their angles (dilatation), how much longer lengths become (scale), "
               "or islands and seams (layout)",
       .choices = {"checker", "dilatation", "scale", "layout"}},
      {.names = "--size", .value = "WxH", .help = "Of the picture, in pixels (1200x480)"},
      {.names = "--view",
       .value = "SIDE|X,Y,Z",
       .help = "From where the picture shows the surface: front, back, left, right, top, "
               "bottom, or the direction towards the eye"}};
}

std::optional<std::string> checkPicture(const Arguments& arguments) {
  if (arguments.text("draw") == "layout" && arguments.text("to") == "sphere") {
    return "a map to the sphere has no layout to draw";
  }
  if (!arguments.has("picture")) {
    const std::string output = arguments.text("output");
    if (arguments.has("draw") && !output.ends_with(".glb")) {
      return "--draw is what a --picture or the colours of OUT.glb show";
    }
    if (arguments.has("size")) return "--size is that of a --picture";
    if (arguments.has("view")) return "--view is that of a --picture";
    return std::nullopt;
  }
  Status status = parsePictureFormat(arguments.text("picture")).status();
  if (status.ok() && arguments.has("size")) {
    status = parsePictureSize(arguments.text("size")).status();
  }
  if (status.ok() && arguments.has("view")) {
    status = parsePictureView(arguments.text("view")).status();
  }
  if (status.ok()) return std::nullopt;
  return status.hint().empty() ? status.message() : status.message() + "; " + status.hint();
}

Result<DrawnMap> DrawnMap::open(Client& client, const Arguments& arguments,
                                const MeshArgument& mesh, const ParameterizedMesh& map) {
  DrawnMap drawn;
  MapPicture& picture = drawn.picture_;
  picture.name = std::filesystem::path(mesh.name()).filename().string();
  picture.map = &map;
  if (arguments.has("picture")) {
    ASSIGN_OR_RETURN(picture.format, parsePictureFormat(arguments.text("picture")));
  }
  if (arguments.has("draw")) {
    ASSIGN_OR_RETURN(picture.draw, parsePictureDraw(arguments.text("draw")));
  }
  if (arguments.has("size")) {
    ASSIGN_OR_RETURN(picture.size, parsePictureSize(arguments.text("size")));
  }
  if (arguments.has("view")) {
    ASSIGN_OR_RETURN(picture.view, parsePictureView(arguments.text("view")));
  }
  ASSIGN_OR_RETURN(std::optional<std::vector<double>> space, placeInSpace(client, mesh));
  picture.in_space = space.has_value();
  if (space && arguments.has("field")) {
    ASSIGN_OR_RETURN(drawn.field_, fieldOf(arguments.text("field"), space->size() / 3));
    picture.field_name = std::filesystem::path(arguments.text("field")).filename().string();
  }
  if (space && map.result.target() == v1::ParameterizationOptions::SPHERE) {
    drawn.space_ = *std::move(space);
  }
  RETURN_IF_ERROR(checkDrawable(drawn.picture()));
  return drawn;
}

MapPicture DrawnMap::picture() const {
  MapPicture picture = picture_;
  picture.space = space_;
  picture.field = field_;
  return picture;
}

}  // namespace moduli::cli
