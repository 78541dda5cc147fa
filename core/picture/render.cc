#include "core/picture/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace moduli {
namespace {

Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec3 operator*(double s, const Vec3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 normalized(const Vec3& a) {
  const double length = std::sqrt(dot(a, a));
  return length > 0 ? (1 / length) * a : a;
}
bool finite(const Vec3& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

// Points and normals in the eye's frame: x to the right, y down, z towards the eye; x and y in
// samples.
struct Projected {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
};

struct Frame {
  Vec3 right, down, eye;
};

Frame frameOf(const RenderOptions& options) {
  const Vec3 eye = normalized(options.view_from);
  const Vec3 right = normalized(cross(options.up, eye));
  return {right, cross(right, eye), eye};
}

bool drawable(const CornerIndices& face, std::span<const Vec3> points) {
  for (const int i : face) {
    if (i < 0 || static_cast<std::size_t>(i) >= points.size() || !finite(points[i])) return false;
  }
  return true;
}

std::vector<CornerIndices> drawableFaces(std::span<const Vec3> points,
                                         std::span<const CornerIndices> faces) {
  std::vector<CornerIndices> kept;
  kept.reserve(faces.size());
  for (const CornerIndices& face : faces) {
    if (drawable(face, points)) kept.push_back(face);
  }
  return kept;
}

Projected project(std::span<const Vec3> points, const std::vector<CornerIndices>& faces,
                  const Frame& frame, int width, int height) {
  Projected result{std::vector<Vec3>(points.size(), Vec3{}),
                   std::vector<Vec3>(points.size(), Vec3{})};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low = {kInfinity, kInfinity, kInfinity}, high = {-kInfinity, -kInfinity, -kInfinity};
  for (const CornerIndices& face : faces) {
    for (const int i : face) {
      Vec3& p = result.points[i];
      p = {dot(points[i], frame.right), dot(points[i], frame.down), dot(points[i], frame.eye)};
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    }
  }
  constexpr double kFill = 0.92;  // Leaves a margin around the surface.
  const double extent = std::max({(high[0] - low[0]) / width, (high[1] - low[1]) / height,
                                  std::numeric_limits<double>::min()});
  const double scale = kFill / extent;
  for (Vec3& p : result.points) {
    p = {scale * (p[0] - (low[0] + high[0]) / 2) + 0.5 * width,
         scale * (p[1] - (low[1] + high[1]) / 2) + 0.5 * height, scale * (p[2] - high[2])};
  }
  for (const CornerIndices& face : faces) {  // Area-weighted vertex normals.
    const Vec3& a = result.points[face[0]];
    const Vec3 n = cross(result.points[face[1]] - a, result.points[face[2]] - a);
    for (const int i : face) {
      for (int axis = 0; axis < 3; ++axis) result.normals[i][axis] += n[axis];
    }
  }
  for (Vec3& n : result.normals) n = normalized(n);
  return result;
}

// A key light from the upper left, a weaker one from the right, some light from everywhere.
double brightness(const Vec3& normal) {
  static const Vec3 kKey = normalized({-0.5, -0.7, 0.9});
  static const Vec3 kFill = normalized({0.8, 0.2, 0.5});
  // The y axis points down, so a face seen from outside has its normal along -z before this.
  const Vec3 n = normal[2] < 0 ? -1.0 * normal : normal;
  return 0.32 + 0.58 * std::max(0.0, dot(n, kKey)) + 0.18 * std::max(0.0, dot(n, kFill));
}

struct Sample {
  float depth = -std::numeric_limits<float>::infinity();
  Color color;
};

class Rasterizer {
 public:
  Rasterizer(int width, int height, Color background)
      : width_(width),
        height_(height),
        samples_(std::size_t(width) * height,
                 {-std::numeric_limits<float>::infinity(), background}) {}

  void draw(const std::array<const Vec3*, 3>& p, const std::array<const Vec3*, 3>& n,
            const std::array<Color, 3>& c) {
    const double area = edge(*p[0], *p[1], *p[2]);
    if (area == 0) return;
    const auto [x0, x1] = range((*p[0])[0], (*p[1])[0], (*p[2])[0], width_);
    const auto [y0, y1] = range((*p[0])[1], (*p[1])[1], (*p[2])[1], height_);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Vec3 q = {x + 0.5, y + 0.5, 0};
        const Vec3 w = {edge(*p[1], *p[2], q) / area, edge(*p[2], *p[0], q) / area,
                        edge(*p[0], *p[1], q) / area};
        if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
        shade(samples_[std::size_t(y) * width_ + x], p, n, c, w);
      }
    }
  }

  Image downsampled(int factor) const {
    Image image(width_ / factor, height_ / factor, {});
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x)
        image.at(x, y) = average(x * factor, y * factor, factor);
    }
    return image;
  }

 private:
  static double edge(const Vec3& a, const Vec3& b, const Vec3& q) {
    return (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]);
  }

  static std::pair<int, int> range(double a, double b, double c, int limit) {
    const double low = std::max(0.0, std::floor(std::min({a, b, c})));
    const double high = std::min(limit - 1.0, std::ceil(std::max({a, b, c})));
    return {static_cast<int>(low), static_cast<int>(high)};
  }

  static void shade(Sample& sample, const std::array<const Vec3*, 3>& p,
                    const std::array<const Vec3*, 3>& n, const std::array<Color, 3>& c,
                    const Vec3& w) {
    const auto depth =
        static_cast<float>(w[0] * (*p[0])[2] + w[1] * (*p[1])[2] + w[2] * (*p[2])[2]);
    if (depth <= sample.depth) return;
    Vec3 normal{};
    Vec3 color{};
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) normal[axis] += w[i] * (*n[i])[axis];
      color[0] += w[i] * c[i].red;
      color[1] += w[i] * c[i].green;
      color[2] += w[i] * c[i].blue;
    }
    const double light = brightness(normalized(normal));
    const auto channel = [light](double value) {
      return static_cast<std::uint8_t>(std::clamp(light * value, 0.0, 255.0));
    };
    sample = {depth, {channel(color[0]), channel(color[1]), channel(color[2])}};
  }

  Color average(int x0, int y0, int factor) const {
    int red = 0, green = 0, blue = 0;
    for (int y = y0; y < y0 + factor; ++y) {
      for (int x = x0; x < x0 + factor; ++x) {
        const Color& color = samples_[std::size_t(y) * width_ + x].color;
        red += color.red;
        green += color.green;
        blue += color.blue;
      }
    }
    const int count = factor * factor;
    return {static_cast<std::uint8_t>(red / count), static_cast<std::uint8_t>(green / count),
            static_cast<std::uint8_t>(blue / count)};
  }

  int width_, height_;
  std::vector<Sample> samples_;
};

}  // namespace

Image renderSurface(std::span<const Vec3> points, std::span<const CornerIndices> faces,
                    std::span<const Color> colors, const RenderOptions& options) {
  const int factor = std::clamp(options.supersampling, 1, 8);
  const int width = factor * options.width, height = factor * options.height;
  const std::vector<CornerIndices> kept = drawableFaces(points, faces);
  Rasterizer raster(width, height, options.background);
  if (!kept.empty()) {
    const Projected scene = project(points, kept, frameOf(options), width, height);
    for (const CornerIndices& face : kept) {
      std::array<const Vec3*, 3> p{}, n{};
      std::array<Color, 3> c{};
      for (int i = 0; i < 3; ++i) {
        p[i] = &scene.points[face[i]];
        n[i] = &scene.normals[face[i]];
        c[i] = colors.size() == points.size() ? colors[face[i]] : options.surface;
      }
      raster.draw(p, n, c);
    }
  }
  return raster.downsampled(factor);
}

}  // namespace moduli
