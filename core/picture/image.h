#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.h"

namespace moduli {

struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
  bool operator==(const Color&) const = default;
};

/// Opaque pixels, row by row from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Color> pixels;

  Image() = default;
  Image(int image_width, int image_height, Color fill)
      : width(image_width), height(image_height), pixels(std::size_t(width) * height, fill) {}

  Color& at(int x, int y) { return pixels[std::size_t(y) * width + x]; }
  const Color& at(int x, int y) const { return pixels[std::size_t(y) * width + x]; }
};

/// The bytes of a PNG file. Fails with kInternal if the library refuses (sizes beyond 32767).
Result<std::string> encodePng(const Image& image);

/// A perceptually even colour from dark blue over green to yellow; t is clamped to [0, 1].
Color sequentialColor(double t);

/// From nearly white over yellow and red to dark violet, ever darker, for what is better small; t
/// is clamped to [0, 1].
Color heatColor(double t);

/// Blue, white, red for -1, 0, 1; clamped.
Color divergingColor(double t);

}  // namespace moduli
