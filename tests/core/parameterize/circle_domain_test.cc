#include "core/parameterize/circle_domain.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>

#include "core/forms/bordered_period.h"
#include "core/mesh/prepare.h"
#include "core/spherical/circle_domain_capacity.h"
#include "core/topology/surface_topology.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

TriangleMesh prepared(const TriangleSoup& soup) {
  Context context;
  auto result = prepareMesh(context, soup, {});
  EXPECT_OK(result);
  return std::move(result->mesh);
}

Result<Parameterization> toCircles(const TriangleMesh& mesh,
                                   const CircleDomainOptions& options = {}) {
  Context context;
  return parameterizeCircleDomain(context, mesh.connectivity(), mesh.edgeLengths(),
                                  mesh.positions(), options);
}

/// A unit square less square holes of the given cells, n x n cells in all.
TriangleSoup squareWithHoles(int n, const std::set<std::pair<int, int>>& holes, int fine) {
  TriangleSoup soup;
  const int steps = n * fine;
  const auto at = [&](int i, int j) { return static_cast<Index>(j * (steps + 1) + i); };
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= steps; ++i) {
      soup.vertices.emplace_back(static_cast<double>(i) / steps, static_cast<double>(j) / steps, 0);
    }
  }
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      if (holes.contains({i / fine, j / fine})) continue;
      soup.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return soup;
}

/// Every vertex of a loop on its circle, every other one between them.
void expectCircleDomain(const TriangleMesh& mesh, const Parameterization& result) {
  EXPECT_EQ(result.certificate.quality.flipped_faces, 0);
  EXPECT_LT(*result.certificate.boundary_deviation, 1e-8);
  ASSERT_FALSE(result.circles.empty());
  EXPECT_EQ(result.circles[0].center, Complex(0));
  EXPECT_EQ(result.circles[0].radius, 1);
  const SurfaceTopology topology = computeTopology(mesh.connectivity());
  ASSERT_EQ(result.circles.size(), topology.boundary_loops.size());
  for (const std::vector<Index>& loop : topology.boundary_loops) {
    double best = 1;
    for (const Circle& circle : result.circles) {
      double worst = 0;
      for (const Index h : loop) {
        const Complex w = result.points[mesh.connectivity().tail(h)];
        worst = std::max(worst, std::abs(circle.distance(w)));
      }
      best = std::min(best, worst);
    }
    EXPECT_LT(best, 1e-12);
  }
  for (const Complex& w : result.points) {
    EXPECT_LT(std::abs(w), 1 + 1e-12);
    for (std::size_t k = 1; k < result.circles.size(); ++k) {
      EXPECT_GT(result.circles[k].distance(w), -1e-12);
    }
  }
}

/// The largest relative difference of the fluxes of a surface and of its circle domain.
double fluxDifference(const TriangleMesh& mesh, const Parameterization& result) {
  Context context;
  const auto surface = computeBorderedPeriods(context, mesh.connectivity(), mesh.edgeLengths());
  EXPECT_OK(surface);
  // computeBorderedPeriods counts loops from the first of computeTopology; fluxes of any two sets
  // of b - 1 loops say the same: compare the full matrices, rows of sum 0.
  const auto circles = circleDomainCapacity(context, result.circles);
  EXPECT_OK(circles);
  const auto full = [](const Eigen::MatrixXd& reduced) {
    const Eigen::Index b = reduced.rows() + 1;
    Eigen::MatrixXd matrix(b, b);
    matrix.bottomRightCorner(b - 1, b - 1) = reduced;
    matrix.block(0, 1, 1, b - 1) = -reduced.colwise().sum();
    matrix.col(0).tail(b - 1) = -reduced.rowwise().sum();
    matrix(0, 0) = reduced.sum();
    return matrix;
  };
  const Eigen::MatrixXd on_surface = full(surface->capacity), on_circles = full(circles->capacity);
  // Loops are in another order there: the outer one first.
  const SurfaceTopology topology = computeTopology(mesh.connectivity());
  std::vector<Eigen::Index> place;
  for (const std::vector<Index>& loop : topology.boundary_loops) {
    Eigen::Index found = 0;
    for (std::size_t k = 0; k < result.circles.size(); ++k) {
      const Complex w = result.points[mesh.connectivity().tail(loop[0])];
      if (std::abs(result.circles[k].distance(w)) < 1e-12) found = static_cast<Eigen::Index>(k);
    }
    place.push_back(found);
  }
  double largest = 0;
  for (Eigen::Index j = 0; j < on_surface.rows(); ++j) {
    for (Eigen::Index k = 0; k < on_surface.cols(); ++k) {
      largest = std::max(largest, std::abs(on_surface(j, k) - on_circles(place[j], place[k])));
    }
  }
  return largest / on_surface.diagonal().maxCoeff();
}

TEST(ParameterizeCircleDomain, KeepsTheFluxesOfThePlateAsItIsRefined) {
  const std::set<std::pair<int, int>> holes = {{1, 1}, {3, 1}, {2, 3}};
  const auto difference = [&](int fine) {
    const TriangleMesh mesh = prepared(squareWithHoles(5, holes, fine));
    const auto result = toCircles(mesh);
    EXPECT_OK(result);
    expectCircleDomain(mesh, *result);
    return fluxDifference(mesh, *result);
  };
  const double coarse = difference(3), fine = difference(6), finest = difference(12);
  // Corners of 3 pi / 2, and the smooth curves through them, leave the first order.
  const std::string figures =
      std::to_string(coarse) + ", " + std::to_string(fine) + ", " + std::to_string(finest);
  EXPECT_LT(fine, coarse / std::pow(2, 0.9)) << figures;
  EXPECT_LT(finest, fine / std::pow(2, 0.9)) << figures;
}

TEST(ParameterizeCircleDomain, OfAnAnnulusIsConcentric) {
  const TriangleMesh mesh = surfaces::mesh(surfaces::sample("annulus", {}));
  const auto result = toCircles(mesh);
  ASSERT_OK(result);
  expectCircleDomain(mesh, *result);
  ASSERT_TRUE(result->modulus);
  EXPECT_EQ(result->circles[1].center, Complex(0));
  Context context;
  const auto bounds = computeBorderedPeriods(context, mesh.connectivity(), mesh.edgeLengths());
  ASSERT_OK(bounds);
  EXPECT_NEAR(*result->modulus, bounds->modulus->value,
              bounds->modulus->upper - bounds->modulus->lower);
}

TEST(ParameterizeCircleDomain, HasNoFoldsOnRealSurfaces) {
  const std::vector<std::string> paths = sharedMeshes("multi_boundary");
  if (paths.empty()) GTEST_SKIP() << "no meshes; set MODULI_SHARED";
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const TriangleMesh mesh = prepared(surfaces::read(path));
    const auto result = toCircles(mesh);
    ASSERT_OK(result);
    expectCircleDomain(mesh, *result);
    EXPECT_LT(result->certificate.convergence_rate.value_or(0), 0.5);
    if (result->subdivision) {
      EXPECT_LE(result->subdivision->faces.size(), 1.05 * mesh.faceCount());
    }
  }
}

TEST(ParameterizeCircleDomain, CutsFacesWithAllCornersOnAHole) {
  // A corner of a square hole cut off: that face bends into the hole, whatever the map.
  TriangleSoup soup = squareWithHoles(5, {{1, 1}, {3, 3}}, 2);
  const auto corner = std::find_if(soup.faces.begin(), soup.faces.end(), [&](const Triangle& face) {
    // The lower right triangle of the cell at the hole's upper left corner, outside the hole.
    return face == Triangle{static_cast<Index>(2 * 11 + 1), static_cast<Index>(2 * 11 + 2),
                            static_cast<Index>(3 * 11 + 2)};
  });
  ASSERT_NE(corner, soup.faces.end());
  soup.faces.erase(corner);
  const TriangleMesh mesh = prepared(soup);
  const auto result = toCircles(mesh);
  ASSERT_OK(result);
  EXPECT_EQ(result->certificate.quality.flipped_faces, 0);
}

TEST(ParameterizeCircleDomain, RefusesWhatItCannotMap) {
  const auto result = toCircles(surfaces::mesh(surfaces::sample("sphere", {})));
  EXPECT_THAT(result, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(result.status().hint(), testing::HasSubstr("--to sphere"));
  CircleDomainOptions options;
  options.method = MapMethod::kLinear;
  EXPECT_THAT(toCircles(surfaces::mesh(surfaces::sample("annulus", {})), options),
              FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
