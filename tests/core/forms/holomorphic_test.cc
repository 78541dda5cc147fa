#include "core/forms/holomorphic.h"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/forms/siegel.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/forms/period_testing.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

std::vector<MetricSurface> closedSurfaces() {
  const auto three = makeSample("genus", {{"genus", 3}, {"resolution", 2}, {"seed", 5}});
  return {torusOfRevolution(2, 1, 20, 11), subdivide(squareTiledL(), 3),
          subdivide(kleinQuartic(), 2), fromPositions(three->vertices, three->faces)};
}

/// The integral of x ^ y over the surface, face by face.
Complex wedge(const Connectivity& surface, const auto& x, const auto& y) {
  Complex sum = 0;
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    sum += 0.5 * (x(h) * y(h + 1) - x(h + 1) * y(h));
  }
  return sum;
}

/// CHECKS D12 (Riemann's bilinear relations), of the forms themselves.
TEST(HolomorphicForms, ObeyTheBilinearRelations) {
  for (const MetricSurface& mesh : closedSurfaces()) {
    const auto closed = closedPeriodsOf(mesh);
    ASSERT_OK(closed);
    const HolomorphicForms zeta = holomorphicForms(*closed);
    const Eigen::MatrixXcd& period = closed->periods.period;
    ASSERT_EQ(zeta.count(), period.rows());
    for (Eigen::Index j = 0; j < zeta.count(); ++j) {
      const auto x = [&](Index h) { return zeta.along(mesh.surface, h, j); };
      for (Eigen::Index k = 0; k < zeta.count(); ++k) {
        const auto y = [&](Index h) { return zeta.along(mesh.surface, h, k); };
        const auto conjugate = [&](Index h) { return std::conj(y(h)); };
        EXPECT_LT(std::abs(wedge(mesh.surface, x, y)), 1e-12 * std::abs(period(j, j)));
        const Complex area = Complex(0, 0.5) * wedge(mesh.surface, x, conjugate);
        EXPECT_NEAR(area.real(), period(j, k).imag(), 1e-12 * std::abs(period(j, j)));
        EXPECT_NEAR(area.imag(), 0, 1e-12 * std::abs(period(j, j)));
      }
    }
  }
}

/// The energy of a form is at least its area, and equal for holomorphic ones: what is left falls
/// with the mesh width, at the order of the energy's error.
TEST(HolomorphicForms, BecomeConformalUnderRefinement) {
  const auto coarse = makeSample("genus", {{"genus", 2}, {"resolution", 2}});
  double before = 1;
  for (const int n : {1, 2, 4}) {
    const auto closed =
        closedPeriodsOf(subdivide(fromPositions(coarse->vertices, coarse->faces), n));
    ASSERT_OK(closed);
    EXPECT_GT(closed->periods.riemann_residual, 0);
    EXPECT_LT(closed->periods.riemann_residual, before / 1.8);
    before = closed->periods.riemann_residual;
  }
}

int indexSum(const std::vector<FormZero>& zeros) {
  int sum = 0;
  for (const FormZero& zero : zeros) sum += zero.index;
  return sum;
}

TEST(FormZeros, AddUpToTheEulerCharacteristicForEveryClosedForm) {
  std::mt19937 random(3);
  for (const MetricSurface& mesh : closedSurfaces()) {
    const auto closed = closedPeriodsOf(mesh);
    ASSERT_OK(closed);
    const HolomorphicForms zeta = holomorphicForms(*closed);
    for (int trial = 0; trial < 5; ++trial) {
      std::vector<Complex> c;
      for (Eigen::Index k = 0; k < zeta.count(); ++k) {
        c.emplace_back(uniform(random) - 0.5, uniform(random) - 0.5);
      }
      const auto zeros = zerosOfForm(mesh.surface, realPart(mesh.surface, zeta, c));
      EXPECT_EQ(indexSum(zeros), mesh.surface.eulerCharacteristic());
    }
    // A rough exact form has many extrema and saddles, and an integer one has many ties.
    std::vector<double> height(mesh.surface.vertexCount());
    for (double& value : height) value = std::floor(4 * uniform(random));
    std::vector<double> exact(mesh.surface.edgeCount());
    for (Index e = 0; e < mesh.surface.edgeCount(); ++e) {
      const Index h = mesh.surface.halfedge(e);
      exact[e] = height[mesh.surface.head(h)] - height[mesh.surface.tail(h)];
    }
    EXPECT_EQ(indexSum(zerosOfForm(mesh.surface, exact)), mesh.surface.eulerCharacteristic());
  }
}

/// On a surface glued from a polygon the coordinate's differential is holomorphic; it vanishes
/// where the angle is more than 2 pi: to second order at the one cone of 6 pi.
TEST(FormZeros, OfAFlatSurfaceLieAtItsCones) {
  const MetricSurface octagon = gluedPolygon(8);
  const MetricSurface mesh = subdivide(octagon, 4);
  const auto closed = closedPeriodsOf(mesh);
  ASSERT_OK(closed);
  const HolomorphicForms zeta = holomorphicForms(*closed);
  // dx in a generic direction, from the corners of the triangles; its class gives c, as the forms
  // with period matrix Pi span the holomorphic ones: c is found by least squares on the edges.
  const Connectivity& surface = mesh.surface;
  Eigen::MatrixXcd columns(surface.edgeCount(), zeta.count());
  Eigen::VectorXcd target(surface.edgeCount());
  constexpr int kParts = 4;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const int sector = static_cast<int>(f / (kParts * kParts));
    const Complex u = std::polar(1.0 / kParts, std::numbers::pi * sector / 4);
    const Complex v = std::polar(1.0 / kParts, std::numbers::pi * (sector + 1) / 4);
    // Upright triangles have the sides u, v - u, -v, hanging ones -(-v, ...): told by the length.
    for (Index c = 0; c < 3; ++c) {
      const Index h = 3 * f + c;
      const Index at = f % (kParts * kParts);
      Index row = 0;
      Index left = at;
      while (left >= 2 * (kParts - row) - 1) left -= 2 * (kParts - row++) - 1;
      const bool upright = left % 2 == 0;
      const std::array<Complex, 3> sides =
          upright ? std::array<Complex, 3>{u, v - u, -v} : std::array<Complex, 3>{v, -u, u - v};
      const Index e = surface.edge(h);
      target[e] = static_cast<double>(surface.sign(h)) * sides[c];
      for (Eigen::Index k = 0; k < zeta.count(); ++k) {
        columns(e, k) = zeta.along(surface, surface.halfedge(e), k);
      }
    }
  }
  const Eigen::VectorXcd c = columns.colPivHouseholderQr().solve(target);
  // The harmonic forms of dx and dy are exact on this mesh, so that dz is in their span.
  EXPECT_LT((columns * c - target).norm(), 1e-10 * target.norm());
  std::vector<Complex> coefficients(c.begin(), c.end());
  for (Complex& value : coefficients) value *= std::polar(1.0, 0.3);
  const auto zeros = zerosOfForm(surface, realPart(surface, zeta, coefficients));
  ASSERT_EQ(zeros.size(), 1U);
  EXPECT_EQ(zeros[0].index, -2);
  double angle = 0;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    if (surface.tail(h) == zeros[0].vertex) angle += 1;
  }
  EXPECT_EQ(angle, 16) << "the corner of all sixteen triangles at the rim";
}

/// Face by face the star of the forms, projected, is J E_h^-1: the energy that it stands for is the
/// lower bound, and the two period matrices close in on each other.
TEST(StarByFaces, IsTheSecondWayToThePeriods) {
  for (const MetricSurface& coarse : {squareTiledL(), hexagonCover(), kleinQuartic()}) {
    double before = std::numeric_limits<double>::infinity();
    for (const int n : {2, 4, 8}) {
      const MetricSurface mesh = subdivide(coarse, n);
      const auto closed = closedPeriodsOf(mesh);
      ASSERT_OK(closed);
      const Eigen::MatrixXd star = starByFaces(mesh.surface, mesh.lengths, closed->harmonic);
      const Eigen::MatrixXd j =
          standardSymplecticForm(closed->periods.period.rows()).cast<double>();
      const Eigen::MatrixXd lower = -star * j;
      EXPECT_LT((lower - j.transpose() * closed->energy.inverse() * j).norm(), 1e-10);
      const auto from_below = periodOfEnergy(lower);
      const auto from_above = periodOfEnergy(closed->energy);
      ASSERT_OK(from_below);
      ASSERT_OK(from_above);
      const double apart = (from_below->period - from_above->period).norm();
      EXPECT_LT(apart, before);
      const Eigen::MatrixXcd& period = closed->periods.period;
      EXPECT_LT((from_below->period - period).cwiseAbs().maxCoeff(), closed->periods.error);
      EXPECT_LT((from_above->period - period).cwiseAbs().maxCoeff(), closed->periods.error);
      before = apart;
    }
  }
}

}  // namespace
}  // namespace moduli
