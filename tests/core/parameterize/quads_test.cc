#include "core/parameterize/quads.h"

#include <cmath>
#include <complex>
#include <iostream>
#include <string>
#include <vector>

#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

using ::testing::HasSubstr;
using Plane = std::complex<double>;

Result<Parameterization> mapped(const MetricSurface& given, double most_squares = 2000) {
  Context context;
  return parameterizeQuads(context, given.surface, given.lengths, {most_squares});
}

/// Cut open to a disk whose sides fit by Gaussian integers.
void expectWholePeriods(const MetricSurface& given, const Parameterization& map) {
  const PlanarFaces faces{given.surface, map.points, map.corner};
  ASSERT_TRUE(faces.namesAllCorners());
  EXPECT_EQ(countOverlaps(map.points, map.corner), 0);
  if (*map.certificate.islands == 1) {
    EXPECT_EQ(faces.eulerCharacteristic(), 1);
  }
  EXPECT_LE(*map.certificate.holonomy_residual, 1e-9);
  double largest = 0, size = 0;
  for (const Plane p : map.points) size = std::max(size, std::abs(p));
  for (Index h = 0; h < given.surface.halfedgeCount(); ++h) {
    const Index twin = given.surface.twin(h);
    const Plane way = faces.at(h) - faces.at(Connectivity::next(twin));
    largest = std::max({largest, std::abs(way.real() - std::round(way.real())),
                        std::abs(way.imag() - std::round(way.imag()))});
    // The integral of a closed form: both sides of an edge make the same of it.
    EXPECT_NEAR(std::abs(faces.along(h) + faces.along(twin)), 0, 1e-13 * size);
  }
  EXPECT_LE(largest, 1e-9);
  const QuadDomain& quads = *map.quads;
  EXPECT_EQ(static_cast<Index>(quads.periods.size()), 2 - given.surface.eulerCharacteristic());
  // The area of the image is that of the classes, by Riemann's bilinear relation.
  double area = 0;
  const std::size_t g = quads.periods.size() / 2;
  for (std::size_t k = 0; k < g; ++k) {
    const Plane a = quads.periods[k], b = quads.periods[g + k];
    EXPECT_EQ(a, Plane(std::round(a.real()), std::round(a.imag())));
    area += std::imag(std::conj(a) * b);
  }
  EXPECT_NEAR(imageArea(faces), area, 1e-9 * area);
  EXPECT_EQ(quads.squares, area);
  int zeros = 0;
  for (const FormZero& zero : quads.zeros) zeros += zero.index;
  EXPECT_EQ(zeros, given.surface.eulerCharacteristic());
}

TEST(ParameterizeQuads, OfASquareTiledSurfaceAreItsSquares) {
  // Three squares in an L, with one zero of order two, and forms with whole periods exactly.
  for (const MetricSurface& given : {subdivide(squareTiledL(), 4), subdivide(squareTiledL(), 8)}) {
    const auto map = mapped(given);
    ASSERT_OK(map);
    expectWholePeriods(given, *map);
    EXPECT_NEAR(map->quads->squares, 3, 1e-9);
    EXPECT_LE(map->quads->misfit, 1e-6);
    EXPECT_NEAR(map->certificate.quality.max_dilatation, 1, 1e-6);
    EXPECT_EQ(map->certificate.quality.flipped_faces, 0);
  }
}

TEST(ParameterizeQuads, OfATorusOfSquaresAreItsSquares) {
  for (const int long_side : {1, 2, 5}) {
    const MetricSurface torus = flatTorus(Plane(0, long_side), 6, 6 * long_side, 0.2, 1);
    const auto map = mapped(torus);
    ASSERT_OK(map);
    expectWholePeriods(torus, *map);
    EXPECT_NEAR(map->quads->squares, long_side, 1e-9);
    EXPECT_NEAR(map->certificate.quality.max_dilatation, 1, 1e-6);
    EXPECT_TRUE(map->quads->zeros.empty());
  }
}

TEST(ParameterizeQuads, FitBetterWithMoreSquares) {
  const MetricSurface given = planeSample("genus", {{"genus", 2}, {"resolution", 8}, {"seed", 1}});
  double last = 1;
  for (const double most : {20.0, 400.0, 8000.0, 160000.0}) {
    const auto map = mapped(given, most);
    ASSERT_OK(map);
    expectWholePeriods(given, *map);
    EXPECT_LE(map->quads->squares, most);
    EXPECT_LE(map->quads->misfit, last);
    last = map->quads->misfit;
    std::cout << map->quads->squares << " squares, misfit " << map->quads->misfit << ", mean K "
              << map->certificate.quality.mean_dilatation << ", turned over "
              << map->certificate.quality.flipped_faces << '\n';
  }
}

TEST(ParameterizeQuads, OfATorusRoundItsPeriodsWell) {
  // Forms of flat tori are exact, and only the rounding is left. By rounding each number for itself
  // it would be about 1 / sqrt(squares); a pair of them is found together.
  const MetricSurface torus = flatTorus({0.3141, 1.4142}, 6, 8, 0.2, 1);
  for (const double most : {100.0, 10000.0, 1000000.0}) {
    const auto map = mapped(torus, most);
    ASSERT_OK(map);
    expectWholePeriods(torus, *map);
    std::cout << map->quads->squares << " squares, misfit " << map->quads->misfit << '\n';
    EXPECT_LE(map->quads->misfit, 1 / std::sqrt(most));
    EXPECT_LE(map->certificate.quality.max_dilatation, 1 + 2 / std::sqrt(most));
    EXPECT_EQ(map->certificate.quality.flipped_faces, 0);
  }
}

TEST(ParameterizeQuads, KnowNoUnitAndNoNumbering) {
  const MetricSurface given = planeSample("genus", {{"genus", 2}, {"resolution", 4}, {"seed", 1}});
  const auto map = mapped(given);
  const auto other = mapped(scale(given, 1e5));
  ASSERT_OK(map);
  ASSERT_OK(other);
  EXPECT_NEAR(other->quads->squares, map->quads->squares, 1e-6);
  const MetricSurface same = renumber(given, 8);
  const auto third = mapped(same);
  ASSERT_OK(third);
  expectWholePeriods(same, *third);
}

TEST(ParameterizeQuads, SayWhatHasNone) {
  const auto sphere = mapped(planeSample("sphere", {{"resolution", 2}}));
  EXPECT_THAT(sphere, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(sphere.status().message(), HasSubstr("no holomorphic forms"));
  EXPECT_THAT(mapped(squareFrame(2, 1)), FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(mapped(squareTiledL(), 0.5), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(mapped(squareTiledL(), std::nan("")), FailsWith(Reason::kInvalidOption));
  // Ten squares in a row around a torus: less will not do.
  const MetricSurface narrow = flatTorus(Plane(0, 10), 4, 40, 0.2, 1);
  EXPECT_THAT(mapped(narrow, 5), FailsWith(Reason::kInvalidOption));
  EXPECT_OK(mapped(narrow, 10.5));
}

class QuadMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, QuadMesh,
                         testing::Values("genus1/ceaedf__Kitten.off", "genus2/cfwen__eight.off",
                                         "genus2/odedstein__skull_low_resolution.obj",
                                         "genus3plus/libigl-data__3holes.off"));

TEST_P(QuadMesh, HaveWholePeriods) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const MetricSurface given = surfaceOfFile(path);
  const auto map = mapped(given);
  ASSERT_OK(map);
  expectWholePeriods(given, *map);
  // A face that holds a simple zero is turned over, and few beside it.
  EXPECT_LE(map->certificate.quality.flipped_faces, -2 * given.surface.eulerCharacteristic());
  std::cout << map->quads->squares << " squares, misfit " << map->quads->misfit << ", residual "
            << *map->certificate.holonomy_residual << ", turned over "
            << map->certificate.quality.flipped_faces << '\n';
}

}  // namespace
}  // namespace moduli
