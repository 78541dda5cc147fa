#include "core/forms/torus_period.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "core/forms/cotan.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

const Complex kI(0, 1);

Result<TorusPeriod> periodOf(const MetricSurface& torus) {
  Context context;
  return computeTorusPeriod(context, torus.surface, torus.lengths);
}

Complex reduce(Complex tau) {
  return reduceToFundamentalDomain(tau)->tau;
}

/// The flat tori whose period is known exactly, by any triangulation (CHECKS C3-C7).
struct FlatTorus {
  std::string name;
  MetricSurface surface;
  Complex tau;
};

std::vector<FlatTorus> flatTori() {
  std::vector<FlatTorus> result;
  // Published up to mirror images, with |Re tau|; this one is the mirror image.
  result.push_back(
      {"C3", mirror(diplotorus(6, 0.03, 0.6, -2, 0)), {0.21186415123083058, 1.5046387422955194}});
  result.push_back({"C4", diplotorus(6, 0.03, 1, -2, 0), {0.08080910797965801, 1.40932760701893}});
  result.push_back({"C5", diplotorus(7, 0.3, 1, 0, 3), {0.0863497779088, 1.4484331056612}});
  result.push_back({"C6 skew", flatTorus({0.31, 0.97}, 5, 4, 0.2, 1), reduce({0.31, 0.97})});
  result.push_back({"C6 long", flatTorus({0.25, 40}, 3, 20, 0.2, 2), {0.25, 40}});
  result.push_back({"C6 far from reduced", flatTorus({7.3, 0.4}, 9, 7, 0, 3), reduce({7.3, 0.4})});
  result.push_back({"C6 one vertex", flatTorus({0.4, 1.3}, 1, 1, 0, 4), {0.4, 1.3}});
  result.push_back({"C6 two vertices", flatTorus({0.1, 1.1}, 2, 1, 0, 5), {0.1, 1.1}});
  const double angle = std::numbers::pi / 3;
  result.push_back({"C7 regular", disphenoidCover(1, 1, 1), std::polar(1.0, angle)});
  result.push_back({"C7 pillow", disphenoidCover(1, 1, std::sqrt(2.0)), kI});
  return result;
}

TEST(TorusPeriod, FlatToriAreExactUnderEveryTriangulation) {
  for (const FlatTorus& flat : flatTori()) {
    const std::vector<MetricSurface> triangulations{
        flat.surface,
        subdivide(flat.surface, 2),
        subdivide(flat.surface, 5),
        flipEdges(flat.surface, 100, 1),
        flipEdges(insertVertices(flat.surface, 40, 0.05, 1), 300, 2),
        flipEdges(subdivide(flat.surface, 4), 3000, 3),
        insertVertices(subdivide(flat.surface, 3), 200, 0.01, 2)};
    for (std::size_t k = 0; k < triangulations.size(); ++k) {
      const auto period = periodOf(triangulations[k]);
      ASSERT_OK(period) << flat.name;
      // The expected values of C3 to C5 are given with 13 decimals and more; lengths are rounded.
      EXPECT_LT(std::abs(period->tau - flat.tau), 1e-12 * flat.tau.imag()) << flat.name << k;
      EXPECT_LT(period->determinant_gap, 1e-12) << flat.name << k;
      EXPECT_LT(period->riemann_residual, 1e-12) << flat.name << k;
      EXPECT_LT(period->closure_residual, 1e-12) << flat.name << k;
    }
  }
}

TEST(TorusPeriod, DiplotoriFollowTheirFormula) {
  for (const auto& [n, phi, h, s, s2] :
       {std::tuple(5, 0.1, 0.8, -1, 1), {8, 0.02, 1.5, -3, 0}, {9, 0.2, 0.5, 2, -2}}) {
    const auto period = periodOf(diplotorus(n, phi, h, s, s2));
    ASSERT_OK(period);
    EXPECT_LT(std::abs(period->tau - reduce(diplotorusTau(n, phi, h, s, s2))), 1e-13);
  }
}

TEST(TorusPeriod, DisphenoidCoverHasTheShapeOfTheFace) {
  const double a = 1;
  const double b = 1.2;
  const double c = 0.9;
  // The face with the side a from 0 to 1 has its third corner at tau; b and c follow in the
  // direction of the boundary of face 012, whose sides 01, 12, 20 are a, b, c.
  const double x = (a * a + c * c - b * b) / (2 * a * a);
  const Complex shape(x, std::sqrt(c * c / (a * a) - x * x));
  const auto period = periodOf(disphenoidCover(a, b, c));
  ASSERT_OK(period);
  EXPECT_LT(std::abs(period->tau - reduce(shape)), 1e-14);
}

TEST(TorusPeriod, DeterminantFallsToOneUnderRefinementOfOneMetric) {
  const MetricSurface coarse = torusOfRevolution(2, 1, 8, 5);
  double before = std::numeric_limits<double>::infinity();
  for (const int n : {1, 2, 4, 8}) {
    const auto period = periodOf(subdivide(coarse, n));
    ASSERT_OK(period);
    EXPECT_GT(period->determinant_gap, 0);
    EXPECT_LT(period->determinant_gap, before / (n == 1 ? 1 : 2));
    before = period->determinant_gap;
  }
  EXPECT_LT(before, 5e-3);
}

TEST(TorusPeriod, PrintedErrorBoundsTheTrueErrorOnFlatTori) {
  for (const FlatTorus& flat : flatTori()) {
    // The published decimals of C5 do not reach the last bits: take its formula.
    const Complex exact = flat.name == "C5" ? reduce(diplotorusTau(7, 0.3, 1, 0, 3)) : flat.tau;
    for (const int n : {1, 2, 7}) {
      const auto period = periodOf(subdivide(flat.surface, n));
      ASSERT_OK(period);
      EXPECT_LE(std::abs(period->tau - exact), period->tau_error) << flat.name << n;
      // The torus far from reduced is made of needles, which the bound allows for.
      EXPECT_LT(period->tau_error, 1e-10 * exact.imag()) << flat.name << n;
    }
  }
}

TEST(TorusPeriod, TriangulationsOfOneMetricAgreeWithinTheirBounds) {
  const MetricSurface coarse = torusOfRevolution(2, 1, 9, 6);
  const auto reference = periodOf(subdivide(coarse, 7));
  ASSERT_OK(reference);
  for (const int n : {1, 2, 3, 5}) {
    for (const MetricSurface& mesh :
         {subdivide(coarse, n), flipEdges(subdivide(coarse, n), 1000, 9)}) {
      const auto period = periodOf(mesh);
      ASSERT_OK(period);
      EXPECT_LE(std::abs(period->tau - reference->tau), period->tau_error + reference->tau_error);
    }
  }
}

TEST(TorusPeriod, NumberingChangesNothing) {
  for (const MetricSurface& torus :
       {torusOfRevolution(2, 1, 20, 11), torusOfRevolution(std::sqrt(2.0), 1, 12, 12),
        diplotorus(6, 0.03, 0.6, -2, 0), disphenoidCover(1, 1, 1)}) {
    const auto period = periodOf(torus);
    ASSERT_OK(period);
    for (unsigned seed = 1; seed < 8; ++seed) {
      const auto other = periodOf(renumber(torus, seed));
      ASSERT_OK(other);
      EXPECT_LT(std::abs(other->tau - period->tau), 1e-12);
      EXPECT_NEAR(other->tau_error, period->tau_error, 1e-12);
    }
  }
}

TEST(TorusPeriod, ScaleChangesNothing) {
  const MetricSurface torus = insertVertices(torusOfRevolution(2, 1, 20, 11), 50, 0.1, 1);
  const auto period = periodOf(torus);
  ASSERT_OK(period);
  for (const double factor : {0x1p-200, 0x1p200}) {
    const auto other = periodOf(scale(torus, factor));
    ASSERT_OK(other);
    EXPECT_EQ(other->tau, period->tau);
    EXPECT_EQ(other->tau_error, period->tau_error);
  }
  const auto tripled = periodOf(scale(torus, 3));
  ASSERT_OK(tripled);
  EXPECT_LT(std::abs(tripled->tau - period->tau), 1e-13);
}

TEST(TorusPeriod, MirrorImageHasTheMirroredPeriod) {
  const MetricSurface torus = diplotorus(6, 0.03, 0.6, -2, 0);
  const auto period = periodOf(torus);
  const auto image = periodOf(mirror(torus));
  ASSERT_OK(period);
  ASSERT_OK(image);
  EXPECT_LT(std::abs(image->tau - reduce(-std::conj(period->tau))), 1e-14);
  EXPECT_GT(std::abs(image->tau - period->tau), 0.1);
}

double smallestAngle(const MetricSurface& mesh) {
  double largest_cotangent = 0;
  for (const double cotangent : oppositeCotangents(mesh.surface, mesh.lengths)) {
    largest_cotangent = std::max(largest_cotangent, cotangent);
  }
  return std::atan(1 / largest_cotangent) * 180 / std::numbers::pi;
}

TEST(TorusPeriod, CapsKeepTheExactPeriod) {
  for (const FlatTorus& flat : flatTori()) {
    for (const double height : {1e-2, 1e-4, 1e-6}) {
      // Its faces are needles already; caps in them would be thinner than lengths can tell.
      if (flat.name == "C6 far from reduced" && height < 1e-4) continue;
      const auto period = periodOf(insertNearEdges(flat.surface, height, 4));
      ASSERT_OK(period) << flat.name << height;
      // Rounding the lengths of a cap moves its height by 1e-16 / height: the metric itself, with
      // its cone angles, is known to 1e-10 only.
      EXPECT_LE(std::abs(period->tau - flat.tau), 1e-9 * flat.tau.imag()) << flat.name << height;
      EXPECT_LT(period->tau_error, 1e-8 * flat.tau.imag()) << flat.name << height;
    }
  }
}

TEST(TorusPeriod, NeedlesOfAMillionthOfADegreeKeepTheExactPeriod) {
  double smallest = 180;
  for (const FlatTorus& flat : flatTori()) {
    for (const double distance : {1e-2, 1e-4, 1e-6, 1e-8}) {
      const MetricSurface needles = insertNearCorners(flat.surface, distance, 4);
      smallest = std::min(smallest, smallestAngle(needles));
      const auto period = periodOf(needles);
      ASSERT_OK(period) << flat.name << distance;
      const double error = std::abs(period->tau - flat.tau);
      EXPECT_LE(error, 1e-8 * flat.tau.imag()) << flat.name << distance;
      EXPECT_LE(error, period->tau_error) << flat.name << distance;
      EXPECT_LT(period->tau_error, 1e-6 * flat.tau.imag()) << flat.name << distance;
    }
  }
  EXPECT_LT(smallest, 1e-6);
}

TEST(TorusPeriod, RefusesOtherTopologies) {
  const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<Triangle> tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const auto sphere = periodOf(fromPositions(corners, tetrahedron));
  ASSERT_THAT(sphere, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(sphere.status().message(), testing::HasSubstr("genus 0"));
  EXPECT_THAT(periodOf(fromPositions(corners, {tetrahedron[1], tetrahedron[2], tetrahedron[3]})),
              FailsWith(Reason::kUnsupportedTopology));
}

TEST(TorusPeriod, StopsWhenCancelled) {
  const MetricSurface torus = torusOfRevolution(2, 1, 10, 8);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(computeTorusPeriod(context, torus.surface, torus.lengths),
              FailsWith(Reason::kCancelled));
}

/// Adjacent faces agree along their common edge up to a lattice vector; on a flat torus every face
/// has its true shape and the faces fill the lattice's cell.
TEST(TorusLayout, TilesThePlaneByTheLattice) {
  for (const FlatTorus& flat : flatTori()) {
    const MetricSurface mesh = insertVertices(flat.surface, 20, 0.1, 1);
    const Connectivity& surface = mesh.surface;
    const auto period = periodOf(mesh);
    ASSERT_OK(period);
    const std::vector<Complex> z = layOutTorus(surface, *period);
    const double tall = period->tau.imag();
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      const Index twin = surface.twin(h);
      const Complex here = z[Connectivity::next(h)] - z[h];
      const Complex there = z[twin] - z[Connectivity::next(twin)];
      EXPECT_LT(std::abs(here - there), 1e-12 * tall);
      const Complex jump = z[h] - z[Connectivity::next(twin)];
      const double n = jump.imag() / tall;
      const double m = (jump - std::round(n) * period->tau).real();
      EXPECT_NEAR(n, std::round(n), 1e-11);
      EXPECT_NEAR(m, std::round(m), 1e-11 * tall);
    }
    double area = 0;
    const auto areas = faceAreas(surface, mesh.lengths);
    double total = 0;
    for (const double face : areas) total += face;
    for (Index f = 0; f < surface.faceCount(); ++f) {
      const Complex u = z[3 * f + 1] - z[3 * f];
      const Complex v = z[3 * f + 2] - z[3 * f];
      const double signed_area = (std::conj(u) * v).imag() / 2;
      EXPECT_NEAR(signed_area / tall, areas[f] / total, 1e-12);
      area += signed_area;
    }
    EXPECT_NEAR(area / tall, 1, 1e-12);
  }
}

}  // namespace
}  // namespace moduli
