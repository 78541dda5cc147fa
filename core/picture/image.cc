#include "core/picture/image.h"

#include <algorithm>
#include <cmath>

namespace moduli {
namespace {

struct Stop {
  double red, green, blue;
};

Color interpolate(const Stop* stops, int count, double t) {
  const double position = (std::isnan(t) ? 0.0 : std::clamp(t, 0.0, 1.0)) * (count - 1);
  const int i = std::min(static_cast<int>(position), count - 2);
  const double w = position - i;
  const auto mix = [w](double a, double b) {
    return static_cast<std::uint8_t>(std::lround((1 - w) * a + w * b));
  };
  return {mix(stops[i].red, stops[i + 1].red), mix(stops[i].green, stops[i + 1].green),
          mix(stops[i].blue, stops[i + 1].blue)};
}

}  // namespace

Color sequentialColor(double t) {
  // Equal steps of lightness, CIE L* from 15 to 90.
  static constexpr Stop kStops[] = {{43, 16, 88},   {49, 66, 138},  {33, 112, 140},
                                    {38, 155, 128}, {116, 194, 88}, {240, 228, 66}};
  return interpolate(kStops, 6, t);
}

Color heatColor(double t) {
  static constexpr Stop kStops[] = {{238, 240, 242}, {250, 222, 142}, {243, 156, 75},
                                    {214, 80, 66},   {148, 32, 88},   {64, 14, 74}};
  return interpolate(kStops, 6, t);
}

Color divergingColor(double t) {
  static constexpr Stop kStops[] = {
      {38, 76, 156}, {130, 166, 214}, {245, 245, 245}, {226, 150, 126}, {164, 32, 50}};
  return interpolate(kStops, 5, (t + 1) / 2);
}

}  // namespace moduli
