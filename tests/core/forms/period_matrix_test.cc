// Period matrices of surfaces whose periods are known, in every marking and triangulation.

#include "core/forms/period_matrix.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/forms/siegel.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/forms/period_testing.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Eigen::MatrixXd J(Eigen::Index genus) {
  return standardSymplecticForm(genus).cast<double>();
}

/// A value of the lattice and how many primitive pairs +-n have it.
struct Level {
  double value;
  int pairs;
};

/// Surfaces whose projected energies are exact at any refinement (CHECKS D1 to D6).
struct ExactSurface {
  std::string name;
  MetricSurface base;
  Eigen::Index genus;
  std::vector<Level> levels;
};

std::vector<ExactSurface> exactSurfaces() {
  const double root2 = std::numbers::sqrt2;
  const double root3 = std::numbers::sqrt3;
  const double root7 = std::sqrt(7.0);
  const double fifth = std::numbers::pi / 5;
  return {
      {"square-tiled L",
       squareTiledL(),
       2,
       {{2 / 3.0, 2}, {4 / 3.0, 2}, {5 / 3.0, 4}, {7 / 3.0, 8}}},
      {"octahedron cover", octahedronCover(), 2, {{root2, 12}, {2 * root2, 12}}},
      {"octagon", gluedPolygon(8), 2, {{root2, 12}, {2 * root2, 12}}},
      {"hexagon cover", hexagonCover(), 2, {{2 / root3, 6}, {4 / root3, 18}}},
      {"decagon",
       gluedPolygon(10),
       2,
       {{2 / std::tan(fifth) / std::sqrt(5.0), 5},
        {2 / (std::sqrt(5.0) * std::sin(fifth)), 5},
        {2.1715298, 5},
        {2.7527638, 5}}},
      {"Klein quartic", kleinQuartic(), 3, {{4 / root7, 21}, {6 / root7, 28}}},
  };
}

class ExactPeriods : public testing::TestWithParam<std::size_t> {
 protected:
  static const ExactSurface& surface() {
    static const std::vector<ExactSurface> all = exactSurfaces();
    return all[GetParam()];
  }
};

INSTANTIATE_TEST_SUITE_P(Surfaces, ExactPeriods, testing::Range<std::size_t>(0, 6));

void expectLevels(const std::vector<double>& energies, const std::vector<Level>& levels,
                  const std::string& name) {
  std::size_t at = 0;
  for (const Level& level : levels) {
    // Values given with eight digits are held to these.
    const bool rounded = std::abs(level.value * 1e7 - std::round(level.value * 1e7)) < 1e-6;
    for (int k = 0; k < level.pairs; ++k, ++at) {
      if (at == energies.size()) return;
      EXPECT_NEAR(energies[at] / level.value, 1, rounded ? 5e-8 : 1e-10) << name << ' ' << at;
    }
  }
  ASSERT_LT(at, energies.size()) << name;
  EXPECT_GT(energies[at], levels.back().value * (1 + 1e-6)) << name;
}

TEST_P(ExactPeriods, ProjectedEnergiesAreExactOnCoarseMeshes) {
  for (const int n : {3, 4, 7}) {
    const auto closed = closedPeriodsOf(subdivide(surface().base, n));
    ASSERT_OK(closed);
    ASSERT_EQ(closed->periods.period.rows(), surface().genus);
    expectLevels(spectrum(closed->periods.energy), surface().levels, surface().name);
  }
}

/// MATH 4.3: J^T E_h^-1 J <= E <= E_h, here with E known, and M between them.
TEST_P(ExactPeriods, BoundsEncloseTheTruth) {
  double before = std::numeric_limits<double>::infinity();
  for (const int n : {2, 4, 8}) {
    const auto closed = closedPeriodsOf(subdivide(surface().base, n));
    ASSERT_OK(closed);
    const PeriodMatrix& periods = closed->periods;
    const Eigen::MatrixXd& upper = closed->energy;
    const Eigen::MatrixXd j = J(surface().genus);
    const Eigen::MatrixXd lower = j.transpose() * upper.inverse() * j;
    const auto least = [](const Eigen::MatrixXd& m) {
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m).eigenvalues()[0];
    };
    // The projection is exact on these surfaces: M is E.
    EXPECT_GT(least(upper - lower), -1e-12 * upper.norm());
    EXPECT_GT(least(upper - periods.energy), -1e-11 * upper.norm());
    EXPECT_GT(least(periods.energy - lower), -1e-11 * upper.norm());
    EXPECT_GT(least(std::exp(periods.spread) * periods.energy - upper), 0);
    EXPECT_LT(periods.spread, before);
    before = periods.spread;
  }
}

TEST_P(ExactPeriods, ProjectionIsAComplexStructure) {
  const auto closed = closedPeriodsOf(subdivide(surface().base, 3));
  ASSERT_OK(closed);
  const PeriodMatrix& periods = closed->periods;
  const Eigen::MatrixXd star = J(surface().genus).transpose() * periods.energy;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(star.rows(), star.cols());
  EXPECT_LT((star * star + identity).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(periods.period, periods.period.transpose());
  EXPECT_LT(periods.symmetry_residual, 1e-12);
  const Eigen::MatrixXd imaginary = periods.period.imag();
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(imaginary).eigenvalues()[0], 0.1);
  EXPECT_LE(periods.period.real().cwiseAbs().maxCoeff(), 0.5 + 1e-12);
}

TEST(PeriodMatrix, NumberingMotionAndScaleChangeNoInvariant) {
  const auto soup = makeSample("genus", {{"genus", 3}, {"resolution", 2}, {"seed", 5}});
  const MetricSurface mesh = fromPositions(soup->vertices, soup->faces);
  const auto closed = closedPeriodsOf(mesh);
  ASSERT_OK(closed);
  const auto energies = spectrum(closed->periods.energy);
  for (unsigned seed = 1; seed < 6; ++seed) {
    const auto other = closedPeriodsOf(scale(renumber(mesh, seed), 0.01 * seed));
    ASSERT_OK(other);
    const auto same = spectrum(other->periods.energy);
    for (std::size_t k = 0; k < energies.size(); ++k) {
      EXPECT_NEAR(same[k] / energies[k], 1, 1e-11);
    }
    EXPECT_NEAR(other->periods.spread / closed->periods.spread, 1, 1e-9);
  }
  for (const double factor : {0x1p-900, 0x1p900}) {
    const auto other = closedPeriodsOf(scale(mesh, factor));
    ASSERT_OK(other);
    EXPECT_EQ(other->periods.period, closed->periods.period);
    EXPECT_EQ(other->periods.error, closed->periods.error);
  }
  // Orientation: the mirror image has the same energies; its Pi is -conj(Pi) in some marking.
  const auto image = closedPeriodsOf(mirror(mesh));
  ASSERT_OK(image);
  const auto mirrored = spectrum(image->periods.energy);
  for (std::size_t k = 0; k < energies.size(); ++k) {
    EXPECT_NEAR(mirrored[k] / energies[k], 1, 1e-11);
  }
}

/// Any two triangulations of one metric enclose the same exact energies.
TEST(PeriodMatrix, TriangulationsOfOneMetricAgreeWithinTheirBounds) {
  const auto soup = makeSample("genus", {{"genus", 2}, {"resolution", 2}});
  const MetricSurface mesh = fromPositions(soup->vertices, soup->faces);
  const auto reference = closedPeriodsOf(subdivide(mesh, 4));
  ASSERT_OK(reference);
  const auto exact = spectrum(reference->periods.energy);
  for (const MetricSurface& other :
       {mesh, subdivide(mesh, 2), flipEdges(subdivide(mesh, 2), 2000, 3),
        insertVertices(mesh, 300, 0.05, 4), insertNearCorners(mesh, 1e-5, 1)}) {
    const auto closed = closedPeriodsOf(other);
    ASSERT_OK(closed);
    const auto energies = spectrum(closed->periods.energy);
    for (std::size_t k = 0; k < energies.size(); ++k) {
      EXPECT_LE(std::abs(std::log(energies[k] / exact[k])),
                closed->periods.spread + reference->periods.spread);
    }
  }
}

TEST(PeriodMatrix, PrintedErrorIsTightOnFlatTori) {
  for (const std::complex<double> tau : {std::complex(0.31, 0.97), std::complex(0.1, 3.0)}) {
    const auto closed = closedPeriodsOf(flatTorus(tau, 5, 7, 0.2, 1));
    ASSERT_OK(closed);
    EXPECT_LT(std::abs(closed->periods.period(0, 0) - tau), closed->periods.error);
    EXPECT_LT(closed->periods.error, 1e-11);
  }
}

/// A long and a short handle: the error of the long one's period is the one that is printed.
TEST(PeriodMatrix, PrintedErrorCoversTheLargestEntry) {
  Eigen::MatrixXcd exact(2, 2);
  exact << std::complex(0.2, 1.1), std::complex(-0.3, 0.4), std::complex(-0.3, 0.4),
      std::complex(0.1, 30.0);
  const Eigen::MatrixXd energy = energyOfPeriod(exact);
  for (int direction = 0; direction < 4; ++direction) {
    // The energy of one class is too large by a thousandth.
    Eigen::MatrixXd upper = energy;
    upper(direction, direction) *= 1.001;
    const auto periods = certifyPeriods(upper, 0);
    ASSERT_OK(periods);
    const double largest = (periods->period - exact).cwiseAbs().maxCoeff();
    EXPECT_LE(largest, periods->error) << direction;
    if (direction % 2 == 1) {
      // No bound from the short handle would do.
      EXPECT_GT(largest, exact(0, 0).imag() * std::expm1(periods->spread));
    }
  }
  // Rounding widens the bounds by as much.
  const auto rounded = certifyPeriods(energy, 1e-3);
  ASSERT_OK(rounded);
  EXPECT_NEAR(rounded->spread, 1e-3, 1e-6);
}

TEST(PeriodMatrix, RefusesSurfacesWithoutPeriods) {
  const auto sphere = makeSample("sphere", {{"resolution", 3}});
  const auto none = closedPeriodsOf(fromPositions(sphere->vertices, sphere->faces));
  EXPECT_THAT(none, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(none.status().message(), testing::HasSubstr("no periods"));
  EXPECT_THAT(closedPeriodsOf(plate(4, 3, {{1, 1}})), FailsWith(Reason::kUnsupportedTopology));
}

TEST(PeriodMatrix, StopsWhenCancelled) {
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  const MetricSurface mesh = subdivide(squareTiledL(), 3);
  EXPECT_THAT(computePeriods(context, mesh.surface, mesh.lengths), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
