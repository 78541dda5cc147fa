#include "client/cli/texture_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "client/cli/map_pattern.h"
#include "core/picture/image.h"

namespace moduli::cli {

TextureLayout fitUnitSquare(const ParameterizedMesh& mesh) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double low[2] = {kInfinity, kInfinity}, high[2] = {-kInfinity, -kInfinity};
  for (const std::int32_t corner : mesh.corners) {
    if (corner < 0) continue;
    for (std::size_t k = 0; k < 2; ++k) {
      const double x = mesh.points[2 * static_cast<std::size_t>(corner) + k];
      low[k] = std::min(low[k], x);
      high[k] = std::max(high[k], x);
    }
  }
  const double scale = 1 / std::max(high[0] - low[0], high[1] - low[1]);
  if (!(scale > 0) || !std::isfinite(scale)) return {};
  return {scale, low[0], low[1]};
}

SplitVertices splitVertices(const ParameterizedMesh& mesh) {
  constexpr std::int32_t kUnseen = -2;
  SplitVertices split;
  const std::size_t vertices = mesh.positions.size() / 3;
  split.vertex.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) split.vertex[v] = static_cast<std::int32_t>(v);
  split.point.assign(vertices, kUnseen);
  split.corner.reserve(mesh.faces.size());
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> others;
  for (std::size_t k = 0; k < mesh.faces.size(); ++k) {
    const std::int32_t vertex = mesh.faces[k], point = mesh.corners[k];
    std::int32_t& first = split.point[static_cast<std::size_t>(vertex)];
    if (first == kUnseen) first = point;
    if (first == point) {
      split.corner.push_back(vertex);
      continue;
    }
    const auto next = static_cast<std::int32_t>(split.vertex.size());
    const auto [other, is_new] = others.try_emplace({vertex, point}, next);
    if (is_new) {
      split.vertex.push_back(vertex);
      split.point.push_back(point);
    }
    split.corner.push_back(other->second);
  }
  std::replace(split.point.begin(), split.point.end(), kUnseen, -1);
  return split;
}

Result<std::string> checkerTexture(const ParameterizedMesh& mesh, const TextureLayout& layout,
                                   int side) {
  constexpr int kSamples = 2;  // Per pixel and direction.
  const Pattern pattern(makeDrawing(mesh, {}), mesh.result.target());
  const double step = 1.0 / (kSamples * side);
  const auto sample = [&](int x, int y) {
    const double s = (x + 0.5) * step, t = 1 - (y + 0.5) * step;
    return pattern.at({layout.u0 + s / layout.scale, layout.v0 + t / layout.scale, 0});
  };
  Image image(side, side, kPatternLight);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      int red = 0, green = 0, blue = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const Color color = sample(kSamples * x + k % kSamples, kSamples * y + k / kSamples);
        red += color.red;
        green += color.green;
        blue += color.blue;
      }
      constexpr int kCount = kSamples * kSamples;
      image.at(x, y) = {static_cast<std::uint8_t>(red / kCount),
                        static_cast<std::uint8_t>(green / kCount),
                        static_cast<std::uint8_t>(blue / kCount)};
    }
  }
  return encodePng(image);
}

}  // namespace moduli::cli
