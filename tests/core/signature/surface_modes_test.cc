#include "core/signature/surface_modes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/core/signature/modes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::modesOf;
using surfaces::sample;

constexpr double kPi = std::numbers::pi;
/// So few that a triangulation is not refined.
constexpr double kNoEdges = 0.1;

TEST(SurfaceModes, OfASphereConvergeAtSecondOrder) {
  // Area 1: 4 pi l (l + 1), 2 l + 1 times. The polyhedron is off the sphere by O(h^2).
  double last = 0;
  for (const int resolution : {6, 12, 24}) {
    const SurfaceModes modes =
        modesOf(mesh(sample("sphere", {{"resolution", resolution}})), kNoEdges);
    double error = 0;
    for (int l = 1, k = 0; l <= 4; ++l) {
      for (int m = -l; m <= l; ++m, ++k) {
        error = std::max(error, std::abs(modes.values[k] / (4 * kPi * l * (l + 1)) - 1));
      }
    }
    if (last > 0) {
      EXPECT_NEAR(last / error, 4, 0.5);
    }
    last = error;
  }
  EXPECT_LT(last, 0.003);
}

/// The largest relative error of eight eigenvalues of the torus of n x n rhombi of two equilateral
/// faces each. Area 1: 4 pi^2 (2 / sqrt(3)) (i^2 + i j + j^2).
double hexagonalTorusError(int n) {
  std::vector<Triangle> faces;
  const auto at = [n](int i, int j) { return static_cast<Index>((i % n) * n + j % n); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const auto surface = Connectivity::fromFaces(n * n, faces);
  EXPECT_OK(surface);
  Context context;
  const auto modes =
      surfaceModes(context, *surface, std::vector<double>(surface->edgeCount(), 1.0), kNoEdges);
  EXPECT_OK(modes);
  std::vector<double> exact;
  for (int i = -5; i <= 5; ++i) {
    for (int j = -5; j <= 5; ++j) {
      if (i != 0 || j != 0) {
        exact.push_back(4 * kPi * kPi * 2 / std::numbers::sqrt3 * (i * i + i * j + j * j));
      }
    }
  }
  std::sort(exact.begin(), exact.end());
  double largest = 0;
  for (int k = 0; k < 8; ++k) {
    largest = std::max(largest, std::abs(modes->values[k] / exact[k] - 1));
  }
  return largest;
}

TEST(SurfaceModes, OfAnEquilateralTorusConvergeAtFourthOrder) {
  // Lumped masses alone leave errors of second order.
  EXPECT_NEAR(std::log2(hexagonalTorusError(20) / hexagonalTorusError(40)), 4, 0.3);
}

struct FlatSurface {
  Connectivity surface;
  std::vector<double> lengths;
  std::vector<double> exact;  ///< Ascending.
};

/// Two right triangles.
FlatSurface squareOfTwoFaces() {
  const auto surface = Connectivity::fromFaces(4, {{0, 1, 2}, {0, 2, 3}});
  EXPECT_OK(surface);
  FlatSurface square{*surface, std::vector<double>(surface->edgeCount(), 1.0), {}};
  square.lengths[surface->edge(2)] = std::numbers::sqrt2;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      if (i + j > 0) square.exact.push_back(kPi * kPi * (i * i + j * j));
    }
  }
  std::sort(square.exact.begin(), square.exact.end());
  return square;
}

/// The same with opposite sides glued: all corners are one vertex.
FlatSurface torusOfTwoFaces() {
  const auto surface = Connectivity::fromGluing(1, {{0, 0, 0}, {0, 0, 0}}, {4, 5, 3, 2, 0, 1});
  EXPECT_OK(surface);
  FlatSurface torus{*surface, std::vector<double>(surface->edgeCount(), 1.0), {}};
  torus.lengths[surface->edge(2)] = std::numbers::sqrt2;
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) {
      if (i != 0 || j != 0) torus.exact.push_back(4 * kPi * kPi * (i * i + j * j));
    }
  }
  std::sort(torus.exact.begin(), torus.exact.end());
  return torus;
}

/// The largest relative error of the first eight values.
double firstError(const FlatSurface& flat, double edges_per_wave) {
  Context context;
  const auto modes = surfaceModes(context, flat.surface, flat.lengths, edges_per_wave);
  EXPECT_OK(modes);
  double largest = 0;
  for (int k = 0; k < 8; ++k) {
    largest = std::max(largest, std::abs(modes->values[k] / flat.exact[k] - 1));
  }
  return largest;
}

TEST(SurfaceModes, OfASquareAndATorusOfTwoFacesAreThoseOfTheSurface) {
  // Lumped masses lose mu h^2 / 16 at the worst; no edge h is longer than an eighth of the
  // wavelength 2 pi / sqrt(200 pi).
  const double longest = 2 * kPi / std::sqrt(200 * kPi) / 8;
  for (const FlatSurface& flat : {squareOfTwoFaces(), torusOfTwoFaces()}) {
    Context context;
    const auto modes = surfaceModes(context, flat.surface, flat.lengths);
    ASSERT_OK(modes);
    for (Eigen::Index k = 0; k < kModeCount; ++k) {
      EXPECT_NEAR(modes->values[k] / flat.exact[k], 1, flat.exact[k] * longest * longest / 16) << k;
    }
    // Halved edges: second order.
    EXPECT_NEAR(firstError(flat, 4) / firstError(flat, 8), 4, 0.3);
  }
}

TEST(SurfaceModes, AreOrthonormalAndKnowNoScale) {
  const TriangleSoup soup = sample("torus", {{"R", 2}, {"resolution", 16}, {"seed", 3}});
  const TriangleMesh one = mesh(soup), other = mesh(surfaces::moved(soup, 1e-4));
  const SurfaceModes modes = modesOf(one), scaled = modesOf(other);
  const Eigen::Map<const Eigen::VectorXd> areas(modes.areas.data(),
                                                static_cast<Eigen::Index>(modes.areas.size()));
  EXPECT_NEAR(areas.sum(), 1, 1e-12);
  const Eigen::MatrixXd gram = modes.functions.transpose() * areas.asDiagonal() * modes.functions;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(kModeCount, kModeCount)).cwiseAbs().maxCoeff(),
            1e-10);
  EXPECT_LT(((modes.values - scaled.values).array() / modes.values.array()).abs().maxCoeff(),
            1e-10);
}

TEST(SurfaceModes, OfFewVerticesAreFilledUp) {
  const SurfaceModes modes = modesOf(mesh(sample("sphere", {{"resolution", 1}})), kNoEdges);
  ASSERT_EQ(modes.values.size(), kModeCount);
  EXPECT_NEAR(modes.values[11], modes.values[10] + 4 * kPi, 1e-9);
  EXPECT_EQ(modes.functions.col(11).norm(), 0);
  EXPECT_GT(modes.functions.col(10).norm(), 0);
}

TEST(ModeTaper, FallsSmoothlyToNothing) {
  EXPECT_EQ(modeTaper(0, 100), 1);
  EXPECT_EQ(modeTaper(75, 100), 1);
  EXPECT_DOUBLE_EQ(modeTaper(87.5, 100), 0.5);
  EXPECT_EQ(modeTaper(100, 100), 0);
}

}  // namespace
}  // namespace moduli
