#include "client/cli/map_picture.h"

#include <utility>
#include <vector>

#include "client/cli/map_panels.h"
#include "client/cli/map_svg.h"
#include "core/picture/image.h"

namespace moduli::cli {
namespace {

Result<std::string> drawMapPng(const MapPanels& map, const PictureSize& size) {
  const PanelLayout layout = layOutPanels(size, static_cast<int>(map.panels().size()));
  std::vector<SheetCell> cells;
  for (const Panel& panel : map.panels()) {
    if (panel.kind == PanelKind::kDisk) {
      ASSIGN_OR_RETURN(Image image, drawShapes(map.shapes(layout.width, layout.height),
                                               layout.width, layout.height));
      cells.push_back({std::move(image), panel.title, panel.subtitle, false});
      continue;
    }
    const RenderOptions look = map.look(panel.kind, layout.width, layout.height);
    cells.push_back(
        {renderScene(map.scene(panel.kind, look, 1), look), panel.title, panel.subtitle, false});
  }
  ASSIGN_OR_RETURN(const Image picture, composePanels(map.heading(), size, layout, cells));
  return encodePng(picture);
}

}  // namespace

Result<std::string> drawMap(const MapPicture& picture) {
  const MapPanels map(picture);
  return picture.format == PictureFormat::kSvg ? drawMapSvg(map, picture.size)
                                               : drawMapPng(map, picture.size);
}

}  // namespace moduli::cli
