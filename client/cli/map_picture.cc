#include "client/cli/map_picture.h"

#include <utility>
#include <vector>

#include "client/cli/map_panels.h"
#include "client/cli/map_svg.h"
#include "core/picture/image.h"

namespace moduli::cli {
namespace {

Result<std::string> drawMapPng(const MapPanels& map, const PictureSize& size) {
  const SheetPlan plan = planSheet(map, size);
  const PanelLayout& layout = plan.layout;
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
  ASSIGN_OR_RETURN(const Image sheet, composePanels(map.heading(), plan.panels, layout, cells));
  if (plan.legend_width == 0) return encodePng(sheet);
  const LegendDrawing drawing = makeLegend(*map.legend(), plan.legend_width, plan.legend_height);
  ASSIGN_OR_RETURN(const Image legend, drawShapes(drawing.shapes, plan.legend_width,
                                                  plan.legend_height, drawing.words));
  Image picture(size.width, size.height, RenderOptions().background);
  pasteImage(picture, sheet, 0, 0);
  pasteImage(picture, legend, plan.panels.width, kSheetHeading);
  return encodePng(picture);
}

}  // namespace

Status checkDrawable(const MapPicture& picture) {
  const bool to_sphere = picture.map->result.target() == v1::ParameterizationOptions::SPHERE;
  const bool numbers =
      picture.draw == PictureDraw::kDilatation || picture.draw == PictureDraw::kScale;
  if (numbers && (!picture.in_space || (to_sphere && picture.space.empty()))) {
    return {Reason::kInvalidOption, "the surface has no place in space to compare its image with",
            "draw its layout"};
  }
  if (picture.draw == PictureDraw::kLayout && to_sphere) {
    return {Reason::kInvalidOption, "a map to the sphere has no layout", "draw its dilatation"};
  }
  return {};
}

Result<std::string> drawMap(const MapPicture& picture) {
  RETURN_IF_ERROR(checkDrawable(picture));
  const MapPanels map(picture);
  return picture.format == PictureFormat::kSvg ? drawMapSvg(map, picture.size)
                                               : drawMapPng(map, picture.size);
}

}  // namespace moduli::cli
