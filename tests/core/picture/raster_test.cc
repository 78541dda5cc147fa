#include "core/picture/raster.h"

#include <random>

#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(Raster, ASampleOnACommonEdgeIsInOneOfItsFacesAtLeast) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-3, 3);
  for (int trial = 0; trial < 20000; ++trial) {
    // An edge through the sample at (4.5, 4.5), up to rounding, and a face on each side.
    const Vec3 d = {offset(random), offset(random), 0};
    const double back = 0.1 + std::abs(offset(random));
    const Vec3 a = {4.5 + d[0], 4.5 + d[1], 0}, b = {4.5 - back * d[0], 4.5 - back * d[1], 0};
    const Vec3 left = {4.5 - 3 * d[1], 4.5 + 3 * d[0], 0};
    const Vec3 right = {4.5 + 3 * d[1], 4.5 - 3 * d[0], 0};
    Raster raster(9, 0, 9);
    raster.drawTriangle(0, a, b, left);
    raster.drawTriangle(1, b, a, right);
    ASSERT_NE(raster.at(4, 4).what, Sample::kNothing) << trial;
  }
}

TEST(Raster, TellsTheFaceItsDepthAndThePlaceInIt) {
  Raster raster(10, 20, 10);  // Rows 20 to 29.
  raster.drawTriangle(7, {0, 20, 0}, {10, 20, 10}, {0, 30, 20});
  const Sample& sample = raster.at(2, 24);  // At (2.5, 24.5).
  EXPECT_EQ(sample.what, 7);
  EXPECT_FLOAT_EQ(sample.second, 0.25F);
  EXPECT_FLOAT_EQ(sample.third, 0.45F);
  EXPECT_FLOAT_EQ(sample.depth, 0.25F * 10 + 0.45F * 20);
  EXPECT_EQ(raster.at(9, 29).what, Sample::kNothing);
}

TEST(Raster, FacesAndLinesFarOutsideCostNothingAndHitNothing) {
  Raster raster(8, 8, 8);
  raster.drawTriangle(0, {1e30, 1e30, 0}, {2e30, 1e30, 0}, {1e30, 2e30, 0});
  raster.drawTriangle(1, {0, 0, 0}, {5, 0, 0}, {0, 7.4, 0});
  raster.drawLine(0, {-1e9, 3, 0}, {1e9, 3, 0}, 2, 0);
  for (int y = 8; y < 16; ++y) {
    for (int x = 0; x < 8; ++x) EXPECT_EQ(raster.at(x, y).what, Sample::kNothing);
  }
}

}  // namespace
}  // namespace moduli
