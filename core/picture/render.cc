#include "core/picture/render.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/picture/raster.h"

namespace moduli {
namespace {

using namespace vec3;

constexpr double kFill = 0.92;  // Leaves a margin around the surface.
constexpr std::size_t kBandSamples = std::size_t{1} << 22;

bool drawable(const CornerIndices& face, std::span<const Vec3> points) {
  return std::all_of(face.begin(), face.end(), [&](int i) {
    return i >= 0 && static_cast<std::size_t>(i) < points.size() && finite(points[i]);
  });
}

std::vector<int> drawableFaces(const Scene& scene) {
  std::vector<int> kept;
  kept.reserve(scene.faces.size());
  for (std::size_t f = 0; f < scene.faces.size(); ++f) {
    if (drawable(scene.faces[f], scene.points)) kept.push_back(static_cast<int>(f));
  }
  return kept;
}

bool drawable(const Segment& segment) {
  return finite(segment[0]) && finite(segment[1]);
}

struct Box {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low = {kInfinity, kInfinity, kInfinity};
  Vec3 high = {-kInfinity, -kInfinity, -kInfinity};

  void add(const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
};

// A key light from the upper left, a weaker one from the right, some light from everywhere.
double brightness(const Vec3& normal) {
  static const Vec3 kKey = normalized({-0.5, -0.7, 0.9});
  static const Vec3 kSide = normalized({0.8, 0.2, 0.5});
  // The y axis points down, so a face seen from outside has its normal along -z before this.
  const Vec3 n = normal[2] < 0 ? -1.0 * normal : normal;
  return 0.32 + 0.58 * std::max(0.0, dot(n, kKey)) + 0.18 * std::max(0.0, dot(n, kSide));
}

/// A scene on its way to pixels; everything in samples.
class Renderer {
 public:
  Renderer(const Scene& scene, const RenderOptions& options)
      : scene_(scene),
        options_(options),
        factor_(std::clamp(options.supersampling, 1, 8)),
        faces_(drawableFaces(scene)),
        projection_(scene, options) {
    if (!projection_.valid()) return;
    points_.assign(scene.points.size(), Vec3{});
    for (const int f : faces_) {
      for (const int i : scene.faces[f]) points_[i] = factor_ * projection_(scene.points[i]);
    }
    if (options.shaded) findNormals();
  }

  Image render() const {
    Image image(std::max(1, options_.width), std::max(1, options_.height), options_.background);
    if (!projection_.valid()) return image;
    const std::size_t row = static_cast<std::size_t>(factor_) * factor_ * image.width;
    const int rows = static_cast<int>(
        std::clamp<std::size_t>(kBandSamples / row, 1, static_cast<std::size_t>(image.height)));
    for (int y = 0; y < image.height; y += rows) {
      renderBand(image, y, std::min(rows, image.height - y));
    }
    return image;
  }

 private:
  // Weighted by area.
  void findNormals() {
    normals_.assign(points_.size(), Vec3{});
    for (const int f : faces_) {
      const CornerIndices& face = scene_.faces[f];
      const Vec3& a = points_[face[0]];
      const Vec3 n = cross(points_[face[1]] - a, points_[face[2]] - a);
      for (const int i : face) normals_[i] = normals_[i] + n;
    }
    for (Vec3& n : normals_) n = normalized(n);
  }

  void renderBand(Image& image, int first_row, int rows) const {
    Raster raster(factor_ * image.width, factor_ * first_row, factor_ * rows);
    for (const int f : faces_) {
      const CornerIndices& face = scene_.faces[f];
      raster.drawTriangle(f, points_[face[0]], points_[face[1]], points_[face[2]]);
    }
    for (std::size_t i = 0; i < scene_.lines.size(); ++i) {
      const LineSet& lines = scene_.lines[i];
      for (const Segment& segment : lines.segments) {
        if (!drawable(segment)) continue;
        raster.drawLine(static_cast<int>(i), factor_ * projection_(segment[0]),
                        factor_ * projection_(segment[1]), factor_ * lines.width, 2.0 * factor_);
      }
    }
    for (int y = first_row; y < first_row + rows; ++y) {
      for (int x = 0; x < image.width; ++x) image.at(x, y) = pixel(raster, x, y);
    }
  }

  Color pixel(const Raster& raster, int x, int y) const {
    int red = 0, green = 0, blue = 0;
    for (int sy = factor_ * y; sy < factor_ * (y + 1); ++sy) {
      for (int sx = factor_ * x; sx < factor_ * (x + 1); ++sx) {
        const Color color = look(raster.at(sx, sy));
        red += color.red;
        green += color.green;
        blue += color.blue;
      }
    }
    const int count = factor_ * factor_;
    return {static_cast<std::uint8_t>(red / count), static_cast<std::uint8_t>(green / count),
            static_cast<std::uint8_t>(blue / count)};
  }

  Color look(const Sample& sample) const {
    if (sample.what == Sample::kNothing) return options_.background;
    if (sample.what < 0) return scene_.lines[Sample::lineOf(sample.what)].color;
    const double second = sample.second, third = sample.third;
    const Vec3 weights = {1 - second - third, second, third};
    const Color color = scene_.paint ? scene_.paint(sample.what, weights) : options_.surface;
    return options_.shaded ? lit(color, sample.what, weights) : color;
  }

  Color lit(const Color& color, int f, const Vec3& weights) const {
    const CornerIndices& face = scene_.faces[f];
    Vec3 normal{};
    for (int i = 0; i < 3; ++i) normal = normal + weights[i] * normals_[face[i]];
    const double light = brightness(normalized(normal));
    const auto channel = [light](double value) {
      return static_cast<std::uint8_t>(std::clamp(light * value, 0.0, 255.0));
    };
    return {channel(color.red), channel(color.green), channel(color.blue)};
  }

  const Scene& scene_;
  const RenderOptions& options_;
  int factor_;
  std::vector<int> faces_;
  Projection projection_;
  std::vector<Vec3> points_, normals_;
};

Color mixed(const Color& a, const Color& b, const Color& c, const Vec3& weights) {
  const auto channel = [&weights](double x, double y, double z) {
    const double value = weights[0] * x + weights[1] * y + weights[2] * z;
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  };
  return {channel(a.red, b.red, c.red), channel(a.green, b.green, c.green),
          channel(a.blue, b.blue, c.blue)};
}

}  // namespace

RenderOptions planeView(int width, int height) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.view_from = {0, 0, 1};
  options.up = {0, 1, 0};
  options.shaded = false;
  return options;
}

Projection::Projection(const Scene& scene, const RenderOptions& options) {
  eye_ = normalized(options.view_from);
  right_ = normalized(cross(options.up, eye_));
  down_ = cross(right_, eye_);
  Box box;
  const auto add = [&](const Vec3& p) { box.add({dot(p, right_), dot(p, down_), dot(p, eye_)}); };
  for (const CornerIndices& face : scene.faces) {
    if (!drawable(face, scene.points)) continue;
    for (const int i : face) add(scene.points[i]);
  }
  for (const LineSet& lines : scene.lines) {
    for (const Segment& segment : lines.segments) {
      if (!drawable(segment)) continue;
      add(segment[0]);
      add(segment[1]);
    }
  }
  const Vec3 size = box.high - box.low;
  if (!(size[0] >= 0) || !finite(size)) return;
  half_width_ = 0.5 * std::max(1, options.width);
  half_height_ = 0.5 * std::max(1, options.height);
  const double extent = std::max({size[0] / (2 * half_width_), size[1] / (2 * half_height_),
                                  std::numeric_limits<double>::min()});
  middle_ = {box.low[0] + size[0] / 2, box.low[1] + size[1] / 2, box.high[2]};
  scale_ = kFill / extent;
}

Vec3 Projection::operator()(const Vec3& point) const {
  return {scale_ * (dot(point, right_) - middle_[0]) + half_width_,
          scale_ * (dot(point, down_) - middle_[1]) + half_height_,
          scale_ * (dot(point, eye_) - middle_[2])};
}

Image renderScene(const Scene& scene, const RenderOptions& options) {
  return Renderer(scene, options).render();
}

Image renderSurface(std::span<const Vec3> points, std::span<const CornerIndices> faces,
                    std::span<const Color> colors, const RenderOptions& options) {
  Scene scene;
  scene.points = points;
  scene.faces = faces;
  if (colors.size() == points.size()) {
    scene.paint = [&](int f, const Vec3& weights) {
      const CornerIndices& face = faces[f];
      return mixed(colors[face[0]], colors[face[1]], colors[face[2]], weights);
    };
  }
  return renderScene(scene, options);
}

}  // namespace moduli
