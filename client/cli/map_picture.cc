#include "client/cli/map_picture.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "client/cli/map_panels.h"
#include "client/cli/map_svg.h"
#include "core/picture/image.h"
#include "core/picture/sheet.h"

namespace moduli::cli {
namespace {

void paste(Image& target, const Image& image, int x0, int y0) {
  const int columns = std::min(image.width, target.width - x0);
  const int rows = std::min(image.height, target.height - y0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) target.at(x0 + x, y0 + y) = image.at(x, y);
  }
}

Result<Image> compose(const MapPanels& map, const PictureSize& size, const PanelLayout& layout,
                      std::vector<SheetCell> cells) {
  Image picture(size.width, size.height, RenderOptions().background);
  if (layout.words) {
    // What does not divide evenly among the panels is left at the right and below.
    ASSIGN_OR_RETURN(const Image sheet, composeSheet(map.heading(), cells, layout.columns));
    paste(picture, sheet, 0, 0);
    return picture;
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int column = static_cast<int>(i) % layout.columns;
    const int row = static_cast<int>(i) / layout.columns;
    paste(picture, cells[i].image, column * layout.width, row * layout.height);
  }
  return picture;
}

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
  ASSIGN_OR_RETURN(const Image picture, compose(map, size, layout, std::move(cells)));
  return encodePng(picture);
}

}  // namespace

Result<std::string> drawMap(const MapPicture& picture) {
  const MapPanels map(picture);
  return picture.format == PictureFormat::kSvg ? drawMapSvg(map, picture.size)
                                               : drawMapPng(map, picture.size);
}

}  // namespace moduli::cli
