#include "client/cli/disk_tiling.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/core/testing.h"

/// The picture of the Poincaré disk, of a surface whose tiling is known.
namespace moduli::cli {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr int kSize = 400;

void add(const Su11& g, v1::DiskIsometry& message) {
  message.mutable_a()->set_re(g.a.real());
  message.mutable_a()->set_im(g.a.imag());
  message.mutable_b()->set_re(g.b.real());
  message.mutable_b()->set_im(g.b.imag());
}

/// The regular octagon with angles of pi / 4, eight triangles around 0; opposite sides are glued.
ParameterizedMesh octagon() {
  ParameterizedMesh map;
  map.result.set_target(v1::ParameterizationOptions::HYPERBOLIC);
  v1::HyperbolicDomain& domain = *map.result.mutable_hyperbolic();
  // cosh of the distance of sides is cot(pi / 8), that of corners its square.
  const double cot = 1 + std::numbers::sqrt2;
  const double corner = std::tanh(std::acosh(cot * cot) / 2);
  map.points = {0, 0};
  for (int k = 0; k < 8; ++k) {
    const Complex z = std::polar(corner, kPi / 4 * k);
    map.points.insert(map.points.end(), {z.real(), z.imag()});
    map.corners.insert(map.corners.end(), {0, 1 + k, 1 + (k + 1) % 8});
  }
  map.faces = map.corners;
  for (std::size_t i = 0; i < map.points.size(); i += 2) {
    map.positions.insert(map.positions.end(), {map.points[i], map.points[i + 1], 0});
  }
  for (int k = 0; k < 4; ++k) {
    const Su11 turn = rotation(kPi / 4 * (k + 0.5));
    const Su11 g = turn * translation(2 * std::acosh(cot)) * inverse(turn);
    add(g, *domain.add_neighbours());
    add(inverse(g), *domain.add_neighbours());
    add(g, *domain.add_generators());
  }
  return map;
}

class Picture {
 public:
  explicit Picture(const ParameterizedMesh& map)
      : drawing_(makeDrawing(map, {})), tiling_(drawing_, map) {
    const auto image = drawShapes(tiling_.shapes(kSize, kSize, false), kSize, kSize);
    EXPECT_OK(image);
    if (image.ok()) image_ = *image;
  }

  Color at(Complex z) const {
    const double scale = DiskTiling::scale(kSize, kSize);
    return image_.at(static_cast<int>(kSize / 2.0 + scale * z.real()),
                     static_cast<int>(kSize / 2.0 - scale * z.imag()));
  }
  const DiskTiling& tiling() const { return tiling_; }

 private:
  MapDrawing drawing_;
  DiskTiling tiling_;
  Image image_;
};

/// Largest less smallest channel: 0 for grey.
int saturation(const Color& c) {
  return std::max({c.red, c.green, c.blue}) - std::min({c.red, c.green, c.blue});
}

TEST(DiskTiling, CopiesFillTheDiskAndThoseOfACutHaveOneHue) {
  const Picture picture(octagon());
  EXPECT_LT(saturation(picture.at(std::polar(0.3, kPi / 16))), 4);
  // Beyond the eight sides, out to where copies are some pixels wide.
  const auto beyond = [&](int k, double radius) {
    return picture.at(std::polar(radius, kPi / 4 * (k + 0.5) + 0.03));
  };
  for (int k = 0; k < 8; ++k) {
    EXPECT_GT(saturation(beyond(k, 0.81)), 20) << k;
    for (double radius = 0.79; radius < 0.97; radius += 0.01) {
      EXPECT_FALSE(beyond(k, radius) == (Color{236, 238, 241})) << k << " " << radius;
    }
  }
  // A copy and its inverse differ in lightness alone, other pairs by more.
  const auto difference = [](const Color& a, const Color& b) {
    return std::abs(a.red - b.red) + std::abs(a.green - b.green) + std::abs(a.blue - b.blue);
  };
  for (int k = 0; k < 4; ++k) {
    EXPECT_LT(difference(beyond(k, 0.81), beyond(k + 4, 0.81)), 45);
    EXPECT_GT(difference(beyond(k, 0.81), beyond((k + 1) % 4, 0.81)), 45);
  }
}

/// Between the chord of a side, at 0.777, and the side itself, a geodesic at 0.644 from the middle.
TEST(DiskTiling, SidesAreGeodesics) {
  const Picture picture(octagon());
  for (int k = 0; k < 8; ++k) {
    EXPECT_GT(saturation(picture.at(std::polar(0.7, kPi / 4 * (k + 0.5) + 0.03))), 20) << k;
    EXPECT_LT(saturation(picture.at(std::polar(0.6, kPi / 4 * (k + 0.5) + 0.03))), 4) << k;
  }
}

TEST(DiskTiling, DrawsNoMoreThanItIsTold) {
  ParameterizedMesh map = octagon();
  map.result.mutable_hyperbolic()->clear_neighbours();
  map.result.mutable_hyperbolic()->clear_generators();
  const Picture alone(map);
  EXPECT_EQ(alone.at(std::polar(0.8, kPi / 8)), (Color{236, 238, 241}));
  EXPECT_EQ(alone.tiling().geodesicCount(), 0);
}

TEST(DiskTiling, StandsWhateverTheServerSays) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Su11& wrong : {Su11{kNan, 0}, Su11{1, 0}, Su11{0, 0}, Su11{1e300, 1e300},
                            Su11{Complex(2, kNan), 1}, Su11{5, 1}, rotation(1)}) {
    ParameterizedMesh map = octagon();
    for (int n = 0; n < 1000; ++n) add(wrong, *map.result.mutable_hyperbolic()->add_neighbours());
    add(wrong, *map.result.mutable_hyperbolic()->add_generators());
    const Picture picture(map);
    EXPECT_LT(saturation(picture.at(0.1)), 4);
  }
  // Translations that generate no discrete group.
  ParameterizedMesh map = octagon();
  for (int n = 1; n < 200; ++n) {
    add(rotation(0.1 * n) * translation(0.01 * n) * rotation(-0.1 * n),
        *map.result.mutable_hyperbolic()->add_neighbours());
  }
  const Picture picture(map);
  EXPECT_LT(saturation(picture.at(0.1)), 60);
}

}  // namespace
}  // namespace moduli::cli
