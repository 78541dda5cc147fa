#pragma once

#include <string>
#include <vector>

#include "client/cli/picture_options.h"
#include "core/base/status.h"
#include "core/picture/image.h"
#include "core/picture/render.h"
#include "core/picture/sheet.h"

/// Pictures of several panels.
namespace moduli::cli {

/// Where the panels of a picture are, in pixels.
struct PanelLayout {
  int columns = 1;
  int width = 1, height = 1;  ///< Of a panel.
  bool words = true;          ///< As on a contact sheet; otherwise panels alone, without margins.
};

/// The layout with the largest panels. count: at least 1.
PanelLayout layOutPanels(const PictureSize& size, int count);

/// The picture of a layout: as a contact sheet under a heading, or the panels' images alone. Fails
/// as composeSheet does.
Result<Image> composePanels(const std::string& heading, const PictureSize& size,
                            const PanelLayout& layout, const std::vector<SheetCell>& cells);

/// Puts an image into another one, its upper left corner at (x, y); what does not fit is cut off.
void pasteImage(Image& target, const Image& image, int x, int y);

/// How a surface is seen in a panel.
RenderOptions surfaceLook(const PictureView& view, int width, int height);

/// Samples per pixel and direction: fewer where they would be too many to be worth their time.
int samplesFor(int width, int height);

}  // namespace moduli::cli
