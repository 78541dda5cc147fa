#pragma once

#include <string>

#include "client/cli/map_panels.h"
#include "core/base/status.h"

namespace moduli::cli {

/// A map's picture as SVG, as drawMap says. size: of the whole.
Result<std::string> drawMapSvg(const MapPanels& map, const PictureSize& size);

}  // namespace moduli::cli
