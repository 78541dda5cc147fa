#include "client/cli/panel_sheet.h"

#include <algorithm>

namespace moduli::cli {
namespace {

constexpr int kLeastPanel = 64;

}  // namespace

void pasteImage(Image& target, const Image& image, int x0, int y0) {
  const int columns = std::min(image.width, target.width - x0);
  const int rows = std::min(image.height, target.height - y0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) target.at(x0 + x, y0 + y) = image.at(x, y);
  }
}

PanelLayout layOutPanels(const PictureSize& size, int count) {
  PanelLayout best, bare;
  int best_side = 0, bare_side = 0;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const PanelLayout worded = {
        columns, (size.width - kSheetMargin * (columns + 1)) / columns,
        (size.height - kSheetHeading - kSheetMargin - rows * kSheetWords) / rows, true};
    if (const int side = std::min(worded.width, worded.height); side > best_side) {
      best_side = side;
      best = worded;
    }
    const PanelLayout plain = {columns, std::max(1, size.width / columns),
                               std::max(1, size.height / rows), false};
    if (const int side = std::min(plain.width, plain.height); side > bare_side) {
      bare_side = side;
      bare = plain;
    }
  }
  return best_side >= kLeastPanel ? best : bare;
}

Result<Image> composePanels(const std::string& heading, const PictureSize& size,
                            const PanelLayout& layout, const std::vector<SheetCell>& cells) {
  Image picture(size.width, size.height, RenderOptions().background);
  if (layout.words) {
    // What does not divide evenly among the panels is left at the right and below.
    ASSIGN_OR_RETURN(const Image sheet, composeSheet(heading, cells, layout.columns));
    pasteImage(picture, sheet, 0, 0);
    return picture;
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int column = static_cast<int>(i) % layout.columns;
    const int row = static_cast<int>(i) / layout.columns;
    pasteImage(picture, cells[i].image, column * layout.width, row * layout.height);
  }
  return picture;
}

RenderOptions surfaceLook(const PictureView& view, int width, int height) {
  RenderOptions options;
  options.view_from = view.towards_eye;
  options.up = view.up;
  options.width = width;
  options.height = height;
  options.supersampling = samplesFor(width, height);
  return options;
}

int samplesFor(int width, int height) {
  const double pixels = double(width) * height;
  return pixels < 5e5 ? 4 : pixels < 2e6 ? 3 : pixels < 3.2e7 ? 2 : 1;
}

}  // namespace moduli::cli
