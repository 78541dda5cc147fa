#include "client/cli/search_picture.h"

#include <cstdio>
#include <filesystem>
#include <utility>

#include "core/base/context.h"
#include "core/mesh/format.h"
#include "core/mesh/read.h"
#include "core/picture/render.h"
#include "core/picture/sheet.h"

namespace moduli::cli {
namespace {

constexpr int kColumns = 4;
constexpr int kSide = 240;

Result<Image> drawMesh(std::string_view bytes, const std::string& name) {
  // An intrinsic triangulation has no place in space: its cell stays empty.
  if (detectFormat(bytes, name) == MeshFormat::kJson) {
    return Image(kSide, kSide, RenderOptions().background);
  }
  Context context;
  ReadOptions options;
  options.name = name;
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMesh(context, bytes, options));
  std::vector<Vec3> points;
  points.reserve(soup.vertices.size());
  for (const Eigen::Vector3d& p : soup.vertices) points.push_back({p.x(), p.y(), p.z()});
  RenderOptions look;
  look.width = look.height = kSide;
  look.up = {0, 1, 0};  // As most mesh files mean it.
  look.view_from = {0.55, 0.4, 1};
  return renderSurface(points, soup.faces, {}, look);
}

Result<Image> drawStored(Client& client, const std::string& resource) {
  std::string bytes;
  const auto header = client.download(resource, [&bytes](std::string_view piece) {
    bytes.append(piece);
    return Status();
  });
  if (!header.ok()) return header.status();
  return drawMesh(bytes, header->file_name);
}

Result<Image> drawQuery(Client& client, const SearchPicture& picture) {
  if (picture.mesh == nullptr) return drawStored(client, picture.query_resource);
  ASSIGN_OR_RETURN(const std::string bytes, picture.mesh->content());
  return drawMesh(bytes, picture.mesh->name());
}

std::string distanceText(double distance) {
  char text[32];
  std::snprintf(text, sizeof text, "distance %.4g", distance);
  return text;
}

}  // namespace

Result<std::string> drawSearch(Client& client, const SearchPicture& picture) {
  std::vector<SheetCell> cells;
  ASSIGN_OR_RETURN(Image query, drawQuery(client, picture));
  const std::string name = std::filesystem::path(picture.query).filename().string();
  cells.push_back({std::move(query), name, "the query", true});
  for (const v1::SearchHit& hit : picture.result.hits()) {
    ASSIGN_OR_RETURN(Image image, drawStored(client, shapeName(picture.collection, hit.name())));
    const std::string label = hit.label().empty() ? "" : ", " + hit.label();
    cells.push_back({std::move(image), hit.name(), distanceText(hit.distance()) + label, false});
  }
  ASSIGN_OR_RETURN(
      const Image sheet,
      composeSheet("Nearest to " + name + " in " + picture.collection, cells, kColumns));
  return encodePng(sheet);
}

}  // namespace moduli::cli
