#include "client/cli/parameterize_picture.h"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "client/cli/map_picture.h"
#include "core/base/context.h"
#include "core/mesh/format.h"
#include "core/mesh/read.h"

namespace moduli::cli {
namespace {

struct MeshText {
  std::string bytes, name;
};

Result<MeshText> textOf(Client& client, const MeshArgument& mesh) {
  MeshText text;
  text.name = mesh.name();
  if (!mesh.stored()) {
    ASSIGN_OR_RETURN(text.bytes, mesh.content());
    return text;
  }
  const auto header = client.download(mesh.resource(), [&](std::string_view piece) {
    text.bytes.append(piece);
    return Status();
  });
  RETURN_IF_ERROR(header.status());
  text.name = header->file_name;
  return text;
}

/// x y z of every vertex of a mesh; nothing for an intrinsic triangulation.
Result<std::optional<std::vector<double>>> placeInSpace(Client& client, const MeshArgument& mesh) {
  ASSIGN_OR_RETURN(const MeshText text, textOf(client, mesh));
  if (detectFormat(text.bytes, text.name) == MeshFormat::kJson) {
    return std::optional<std::vector<double>>();
  }
  Context context;
  ReadOptions options;
  options.name = text.name;
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMesh(context, text.bytes, options));
  std::vector<double> places;
  places.reserve(3 * soup.vertices.size());
  for (const Eigen::Vector3d& p : soup.vertices) places.insert(places.end(), {p.x(), p.y(), p.z()});
  return std::optional(std::move(places));
}

}  // namespace

std::vector<OptionSpec> pictureOptions() {
  return {{.names = "--picture",
           .value = "OUT.png|OUT.svg",
           .help = "Draw the surface and its image side by side, under one checkerboard",
           .completion = Completion::kFile},
          {.names = "--size", .value = "WxH", .help = "Of the picture, in pixels (1200x480)"},
          {.names = "--view",
           .value = "SIDE|X,Y,Z",
           .help = "From where the picture shows the surface: front, back, left, right, top, "
                   "bottom, or the direction towards the eye"}};
}

std::optional<std::string> checkPicture(const Arguments& arguments) {
  if (!arguments.has("picture")) {
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

Result<std::string> pictureOf(Client& client, const Arguments& arguments, const MeshArgument& mesh,
                              const ParameterizedMesh& map) {
  MapPicture picture;
  picture.name = std::filesystem::path(mesh.name()).filename().string();
  picture.map = &map;
  ASSIGN_OR_RETURN(picture.format, parsePictureFormat(arguments.text("picture")));
  if (arguments.has("size")) {
    ASSIGN_OR_RETURN(picture.size, parsePictureSize(arguments.text("size")));
  }
  if (arguments.has("view")) {
    ASSIGN_OR_RETURN(picture.view, parsePictureView(arguments.text("view")));
  }
  ASSIGN_OR_RETURN(const std::optional<std::vector<double>> space, placeInSpace(client, mesh));
  picture.in_space = space.has_value();
  if (space && map.result.target() == v1::ParameterizationOptions::SPHERE) picture.space = *space;
  return drawMap(picture);
}

}  // namespace moduli::cli
