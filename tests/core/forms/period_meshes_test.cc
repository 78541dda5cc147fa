// Periods of smooth samples under refinement and inversion of space, and of real meshes.

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/forms/bordered_period.h"
#include "core/forms/cotan.h"
#include "core/forms/energy_lattice.h"
#include "core/forms/harmonic.h"
#include "core/forms/period_matrix.h"
#include "core/forms/siegel.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/topology/surface_topology.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

struct Periods {
  PeriodMatrix matrix;
  Eigen::MatrixXd raw;  ///< E_h of a closed surface.
};

Result<Periods> periodsOf(const MetricSurface& mesh) {
  Context context;
  if (!computeTopology(mesh.surface).boundary_loops.empty()) {
    ASSIGN_OR_RETURN(BorderedPeriods bordered,
                     computeBorderedPeriods(context, mesh.surface, mesh.lengths));
    return Periods{std::move(bordered.periods), {}};
  }
  ASSIGN_OR_RETURN(ClosedPeriods closed, computePeriods(context, mesh.surface, mesh.lengths));
  return Periods{std::move(closed.periods), std::move(closed.energy)};
}

std::vector<double> spectrum(const PeriodMatrix& periods, std::size_t count = 32) {
  Context context;
  auto energies = shortestEnergies(context, periods.energy, count);
  EXPECT_OK(energies);
  return energies.ok() ? *energies : std::vector<double>();
}

double largestChange(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(largest, std::abs(std::log(a[k] / b[k])));
  }
  return largest;
}

/// x -> (x - c) / |x - c|^2 keeps angles.
TriangleSoup inverted(TriangleSoup soup, const Eigen::Vector3d& center) {
  for (Eigen::Vector3d& p : soup.vertices) p = (p - center) / (p - center).squaredNorm();
  return soup;
}

MetricSurface metricOf(const TriangleSoup& soup) {
  return fromPositions(soup.vertices, soup.faces);
}

/// Samples of one smooth surface each, at three resolutions, and a point off them to invert in.
struct SmoothSample {
  std::string kind;
  std::map<std::string, double> values;
  std::vector<double> resolutions;
  Eigen::Vector3d center;
};

class Smooth : public testing::TestWithParam<SmoothSample> {
 protected:
  static TriangleSoup sample(double resolution) {
    auto values = GetParam().values;
    values["resolution"] = resolution;
    auto soup = makeSample(GetParam().kind, values);
    EXPECT_OK(soup);
    return *std::move(soup);
  }
};

INSTANTIATE_TEST_SUITE_P(
    Samples, Smooth,
    testing::Values(SmoothSample{"torus", {{"R", 2}, {"r", 1}}, {8, 16, 32, 64}, {0.3, 0.2, 1.4}},
                    SmoothSample{"genus", {{"genus", 2}}, {4, 8, 16, 32}, {1.5, 0.4, 2.5}}),
    [](const auto& sample) { return sample.param.kind; });

/// The conformal structure of a smooth surface is kept, that of its polyhedra only up to their
/// distance from it, which falls at second order.
TEST_P(Smooth, InversionOfSpaceChangesPeriodsAtSecondOrder) {
  std::vector<double> changes;
  for (const double resolution : GetParam().resolutions) {
    const TriangleSoup soup = sample(resolution);
    const auto there = periodsOf(metricOf(soup));
    const auto here = periodsOf(metricOf(inverted(soup, GetParam().center)));
    ASSERT_OK(there);
    ASSERT_OK(here);
    changes.push_back(largestChange(spectrum(there->matrix), spectrum(here->matrix)));
  }
  for (std::size_t k = changes.size() - 2; k < changes.size(); ++k) {
    const double order = std::log2(changes[k - 1] / changes[k]);
    EXPECT_GT(order, 1.75) << changes[k - 1] << ' ' << changes[k];
    // On the torus, whose grid runs along its lines of curvature as that of its image does, the
    // second-order errors of both are equal, and the change is of fourth order.
    if (GetParam().kind == "torus") continue;
    EXPECT_LT(order, 2.25) << changes[k - 1] << ' ' << changes[k];
  }
  EXPECT_LT(changes.back(), 0.01);
}

TEST_P(Smooth, PeriodsConvergeAtSecondOrder) {
  std::vector<std::vector<double>> spectra;
  for (const double resolution : GetParam().resolutions) {
    const auto periods = periodsOf(metricOf(sample(resolution)));
    ASSERT_OK(periods);
    spectra.push_back(spectrum(periods->matrix));
  }
  // Differences of successive refinements fall as the errors do.
  const double first = largestChange(spectra[1], spectra[2]);
  const double second = largestChange(spectra[2], spectra[3]);
  EXPECT_NEAR(std::log2(first / second), 2, 0.25) << first << ' ' << second;
}

std::vector<std::string> meshesWithPeriods() {
  std::vector<std::string> paths;
  for (const std::string folder : {"genus1", "genus2", "genus3plus", "multi_boundary"}) {
    const auto found = sharedMeshes(folder);
    paths.insert(paths.end(), found.begin(), found.end());
  }
  for (const std::string name : {"bad/gpeyre__hypersheet.off", "bad/cfwen__eight.open.off"}) {
    const auto path = sharedMesh(name);
    if (path) paths.push_back(*path);
  }
  return paths;
}

Result<TriangleSoup> readSoup(const std::string& path) {
  Context context;
  ASSIGN_OR_RETURN(TriangleSoup soup, readMeshFile(context, path));
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, {}));
  return TriangleSoup{prepared.mesh.positions(), prepared.mesh.connectivity().faces()};
}

double leastEigenvalue(const Eigen::MatrixXd& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

/// CHECKS D8, D9 on everything at hand.
TEST(RealMeshes, BoundsHoldAndProjectionsAreComplexStructures) {
  const auto paths = meshesWithPeriods();
  if (paths.empty()) GTEST_SKIP() << "needs the shared meshes; set MODULI_SHARED";
  for (const std::string& path : paths) {
    const auto soup = readSoup(path);
    ASSERT_OK(soup) << path;
    const auto periods = periodsOf(metricOf(*soup));
    ASSERT_OK(periods) << path;
    const PeriodMatrix& matrix = periods->matrix;
    const Eigen::MatrixXd j = standardSymplecticForm(matrix.period.rows()).cast<double>();
    if (periods->raw.size() > 0) {
      const Eigen::MatrixXd& upper = periods->raw;
      const Eigen::MatrixXd lower = j.transpose() * upper.inverse() * j;
      EXPECT_GT(leastEigenvalue(upper - lower), -1e-12 * upper.norm()) << path;
      EXPECT_GT(leastEigenvalue(std::exp(matrix.spread) * matrix.energy - upper),
                -1e-12 * upper.norm())
          << path;
      EXPECT_GT(upper.determinant(), 1) << path;
    }
    const Eigen::MatrixXd star = j.transpose() * matrix.energy;
    EXPECT_LT(
        (star * star + Eigen::MatrixXd::Identity(star.rows(), star.cols())).cwiseAbs().maxCoeff(),
        1e-12 * matrix.energy.squaredNorm())
        << path;
    EXPECT_LT(matrix.symmetry_residual, 1e-12) << path;
    EXPECT_GT(leastEigenvalue(matrix.period.imag()), 0) << path;
  }
}

/// Other numberings give the same numbers, finer and flipped triangulations others within the
/// bounds.
TEST(RealMeshes, InvariantsSurviveNumberingAndRetriangulation) {
  const std::vector<std::string> names{
      "genus1/ceaedf__Kitten.off",         "genus2/cfwen__eight.off",
      "genus2/cfwen__eight.hole.off",      "genus3plus/libigl-data__fertility.off",
      "multi_boundary/gpeyre__pipes.off",  "bad/gpeyre__hypersheet.off",
      "genus1/ceaedf__rocker-arm2500.off", "multi_boundary/libigl-data__halftunnel.off"};
  for (const std::string& name : names) {
    MODULI_NEED_SHARED_MESH(path, name);
    const auto soup = readSoup(path);
    ASSERT_OK(soup);
    const MetricSurface mesh = metricOf(*soup);
    const auto periods = periodsOf(mesh);
    ASSERT_OK(periods);
    const auto energies = spectrum(periods->matrix);
    const auto other = periodsOf(scale(renumber(mesh, 7), 1e4));
    ASSERT_OK(other);
    EXPECT_LT(largestChange(energies, spectrum(other->matrix)), 1e-10) << name;
    for (const MetricSurface& again :
         {subdivide(mesh, 2), flipEdges(mesh, mesh.surface.edgeCount(), 1)}) {
      const auto changed = periodsOf(again);
      ASSERT_OK(changed);
      const double change = largestChange(energies, spectrum(changed->matrix));
      EXPECT_GT(change, 0) << name;
      EXPECT_LE(change, periods->matrix.spread + changed->matrix.spread) << name;
    }
  }
}

/// How far inversion moves the invariants of real meshes, beside the certified bounds, for the
/// reader of the log: a mesh is no smooth surface, and so no bound is asserted but sanity.
TEST(RealMeshes, InversionOfSpaceChangesLittle) {
  for (const std::string folder : {"genus1", "genus2"}) {
    const auto paths = sharedMeshes(folder);
    if (paths.empty()) GTEST_SKIP() << "needs the shared meshes; set MODULI_SHARED";
    for (const std::string& path : paths) {
      const auto soup = readSoup(path);
      ASSERT_OK(soup);
      Eigen::Vector3d low = soup->vertices[0], high = low;
      for (const auto& p : soup->vertices) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
      const Eigen::Vector3d center = high + 0.5 * (high - low);
      const auto there = periodsOf(metricOf(*soup));
      const auto here = periodsOf(metricOf(inverted(*soup, center)));
      ASSERT_OK(there);
      ASSERT_OK(here);
      const double change = largestChange(spectrum(there->matrix), spectrum(here->matrix));
      std::printf("%-40s inversion changes log energies by %.2e, certified spreads %.2e and %.2e\n",
                  std::filesystem::path(path).filename().c_str(), change, there->matrix.spread,
                  here->matrix.spread);
      EXPECT_LT(change, 0.1) << path;
    }
  }
}

}  // namespace
}  // namespace moduli
