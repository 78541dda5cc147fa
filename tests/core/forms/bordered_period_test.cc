// Surfaces with boundary: annuli, frames, plates with holes, handles with holes.

#include "core/forms/bordered_period.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/forms/cotan.h"
#include "core/forms/harmonic.h"
#include "core/forms/siegel.h"
#include "core/topology/surface_topology.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/forms/period_testing.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// CHECKS E2: a cylinder over a regular polygon is flat, its modulus height over perimeter.
TEST(AnnulusModulus, OfACylinderIsHeightOverPerimeter) {
  for (const int sides : {3, 5, 24}) {
    const double height = 1.7;
    std::vector<Eigen::Vector3d> positions;
    std::vector<Triangle> faces;
    constexpr int kRows = 4;
    for (int row = 0; row <= kRows; ++row) {
      for (int k = 0; k < sides; ++k) {
        const double angle = 2 * std::numbers::pi * k / sides;
        positions.emplace_back(std::cos(angle), std::sin(angle), height * row / kRows);
        if (row == kRows) continue;
        const int next = row * sides + (k + 1) % sides;
        faces.push_back({row * sides + k, next, next + sides});
        faces.push_back({row * sides + k, next + sides, (row + 1) * sides + k});
      }
    }
    const MetricSurface cylinder = fromPositions(positions, faces);
    const double exact = height / (2 * sides * std::sin(std::numbers::pi / sides));
    for (const MetricSurface& mesh :
         {cylinder, flipEdges(insertVertices(cylinder, 60, 0.05, 1), 300, 2)}) {
      const auto periods = borderedPeriodsOf(mesh);
      ASSERT_OK(periods);
      EXPECT_NEAR(periods->modulus->value / exact, 1, 1e-12);
      EXPECT_LE(periods->modulus->lower, exact);
      EXPECT_GE(periods->modulus->upper, exact);
      EXPECT_LT(periods->modulus->upper / periods->modulus->lower, 1 + 1e-10);
    }
  }
}

/// The double built and its periods computed as those of any closed surface: a second way to the
/// same numbers, for every kind of surface with boundary.
class Bordered : public testing::TestWithParam<int> {
 protected:
  static MetricSurface surface() {
    switch (GetParam()) {
      case 0:
        return sampleSurface("annulus", {{"resolution", 6}, {"seed", 3}});
      case 1:
        return subdivide(plate(7, 3, {{1, 1}, {4, 1}}), 2);
      case 2:
        return plate(9, 9, {{1, 1}, {4, 1}, {7, 1}, {1, 4}, {4, 6}, {7, 7}, {2, 7}});
      case 3:
        return withoutDisks(sampleSurface("torus", {{"resolution", 10}, {"seed", 2}}), 1);
      case 4:
        return withoutDisks(sampleSurface("genus", {{"genus", 2}, {"resolution", 2}}), 3);
      default:
        return withoutDisks(sampleSurface("genus", {{"genus", 3}, {"resolution", 2}}), 1);
    }
  }

  /// Without the faces around some vertices that are far apart in the numbering.
  static MetricSurface withoutDisks(const MetricSurface& closed, int count) {
    const Connectivity& surface = closed.surface;
    std::vector<bool> gone(surface.faceCount(), false);
    std::vector<bool> near(surface.vertexCount(), false);
    int removed = 0;
    for (Index v = 0; v < surface.vertexCount() && removed < count; ++v) {
      std::vector<Index> star;
      bool free = true;
      Index h = surface.outgoing(v);
      do {
        star.push_back(h);
        free = free && !near[surface.head(h)];
        h = surface.rotate(h);
      } while (h != surface.outgoing(v));
      if (near[v] || !free) continue;
      for (const Index spoke : star) {
        gone[spoke / 3] = true;
        near[surface.head(spoke)] = true;
        Index around = surface.outgoing(surface.head(spoke));
        const Index first = around;
        do {
          near[surface.head(around)] = true;
          around = surface.rotate(around);
        } while (around != first);
      }
      ++removed;
    }
    EXPECT_EQ(removed, count);
    std::vector<Index> number(surface.vertexCount(), kNone);
    std::vector<Index> face(surface.faceCount(), kNone);
    std::vector<Triangle> faces;
    Index vertices = 0;
    for (Index f = 0; f < surface.faceCount(); ++f) {
      if (gone[f]) continue;
      face[f] = static_cast<Index>(faces.size());
      Triangle corners = surface.face(f);
      for (Index& v : corners) {
        if (number[v] == kNone) number[v] = vertices++;
        v = number[v];
      }
      faces.push_back(corners);
    }
    std::vector<Index> twin(3 * faces.size(), kNone);
    std::vector<double> lengths(3 * faces.size());
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      if (gone[h / 3]) continue;
      const Index here = 3 * face[h / 3] + h % 3;
      const Index t = surface.twin(h);
      if (!gone[t / 3]) twin[here] = 3 * face[t / 3] + t % 3;
      lengths[here] = closed.lengths[surface.edge(h)];
    }
    return fromHalfedges(vertices, std::move(faces), std::move(twin), lengths);
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, Bordered, testing::Range(0, 6));

TEST_P(Bordered, PeriodsAreThoseOfTheDouble) {
  const MetricSurface mesh = surface();
  const auto bordered = borderedPeriodsOf(mesh);
  ASSERT_OK(bordered);
  const auto closed = closedPeriodsOf(doubled(mesh));
  ASSERT_OK(closed);
  ASSERT_EQ(bordered->periods.period.rows(), closed->periods.period.rows());
  EXPECT_NEAR(bordered->periods.spread / closed->periods.spread, 1, 1e-6);
  const auto mine = spectrum(bordered->periods.energy);
  const auto theirs = spectrum(closed->periods.energy);
  for (std::size_t k = 0; k < mine.size(); ++k) EXPECT_NEAR(mine[k] / theirs[k], 1, 1e-10) << k;
}

TEST_P(Bordered, ExtremeUnitsChangeNoDigit) {
  const MetricSurface mesh = surface();
  const auto bordered = borderedPeriodsOf(mesh);
  ASSERT_OK(bordered);
  for (const double factor : {0x1p-900, 0x1p900}) {
    const auto other = borderedPeriodsOf(scale(mesh, factor));
    ASSERT_OK(other);
    EXPECT_EQ(other->periods.period, bordered->periods.period);
    EXPECT_EQ(other->capacity, bordered->capacity);
  }
}

TEST_P(Bordered, NumberingScaleAndMirroringChangeNoInvariant) {
  const MetricSurface mesh = surface();
  const auto bordered = borderedPeriodsOf(mesh);
  ASSERT_OK(bordered);
  const auto energies = spectrum(bordered->periods.energy);
  for (const MetricSurface& other :
       {renumber(mesh, 1), scale(renumber(mesh, 2), 1e5), mirror(mesh)}) {
    const auto again = borderedPeriodsOf(other);
    ASSERT_OK(again);
    const auto same = spectrum(again->periods.energy);
    for (std::size_t k = 0; k < energies.size(); ++k) {
      EXPECT_NEAR(same[k] / energies[k], 1, 1e-10);
    }
  }
}

/// CHECKS D11: Pi = 2 i P_red^-1, in whatever loop is left out of P_red.
TEST(Capacity, GivesThePeriodsOfTheDoubleOfAPlate) {
  const MetricSurface mesh = subdivide(plate(7, 3, {{1, 1}, {4, 1}}), 3);
  const auto bordered = borderedPeriodsOf(mesh);
  ASSERT_OK(bordered);
  const Eigen::MatrixXd& p = bordered->capacity;
  ASSERT_EQ(p.rows(), 2);
  EXPECT_LT((p - p.transpose()).norm(), 1e-12);
  Eigen::MatrixXcd period = Eigen::MatrixXcd::Zero(2, 2);
  period.imag() = 2 * p.inverse();
  // P_h is an upper bound of P, so this Pi is off by the spread, no more.
  const auto raw = spectrum(energyOfPeriod(period));
  const auto projected = spectrum(bordered->periods.energy);
  for (std::size_t k = 0; k < raw.size(); ++k) {
    EXPECT_LE(std::abs(std::log(raw[k] / projected[k])), bordered->periods.spread * (1 + 1e-9));
  }
}

/// CHECKS E9: h = sum lambda_k u_k with P lambda = 2 pi (e_0 - e_1) is the logarithm of a map to a
/// circular slit annulus: constant on every loop, with the fluxes 2 pi and -2 pi through loops 0
/// and 1 and none through the slits.
TEST(Capacity, SolvesForTheFluxesOfASlitMap) {
  const MetricSurface mesh = subdivide(plate(9, 9, {{1, 1}, {4, 1}, {7, 1}, {1, 4}, {4, 6}}), 2);
  const auto bordered = borderedPeriodsOf(mesh);
  ASSERT_OK(bordered);
  const auto loops = computeTopology(mesh.surface).boundary_loops;
  const Eigen::MatrixXd& p = bordered->capacity;
  ASSERT_EQ(p.rows() + 1, static_cast<Eigen::Index>(loops.size()));
  // Loop 0 has lambda = 0; its flux is what the others leave.
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(p.rows());
  flux[0] = -2 * std::numbers::pi;
  const Eigen::VectorXd lambda = p.ldlt().solve(flux);
  std::vector<bool> fixed(mesh.surface.vertexCount(), false);
  RowMajorMatrix values = RowMajorMatrix::Zero(mesh.surface.vertexCount(), 1);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    for (const Index h : loops[k]) {
      fixed[mesh.surface.tail(h)] = true;
      values(mesh.surface.tail(h), 0) = k == 0 ? 0 : lambda[static_cast<Eigen::Index>(k) - 1];
    }
  }
  Context context;
  const auto weights = cotanWeights(mesh.surface, mesh.lengths);
  const auto h = harmonicFunctions(context, mesh.surface, weights, fixed, values);
  ASSERT_OK(h);
  std::vector<double> through(mesh.surface.vertexCount(), 0.0);
  for (Index e = 0; e < mesh.surface.edgeCount(); ++e) {
    const Index a = mesh.surface.tail(mesh.surface.halfedge(e));
    const Index b = mesh.surface.head(mesh.surface.halfedge(e));
    through[a] += weights[e] * ((*h)(a, 0) - (*h)(b, 0));
    through[b] += weights[e] * ((*h)(b, 0) - (*h)(a, 0));
  }
  for (std::size_t k = 0; k < loops.size(); ++k) {
    double sum = 0;
    for (const Index edge : loops[k]) sum += through[mesh.surface.tail(edge)];
    const double expected = k == 0 ? 2 * std::numbers::pi : k == 1 ? -2 * std::numbers::pi : 0;
    EXPECT_NEAR(sum, expected, 1e-9) << k;
  }
}

/// The energy of gamma and half the flux stand on the diagonal of the double's energy form, so that
/// the modulus is half the imaginary part of tau, or its reciprocal (MATH 5.1).
TEST(AnnulusModulus, IsHalfTheTauOfTheDouble) {
  const auto wide = borderedPeriodsOf(sampleSurface("annulus", {{"R", 8}, {"resolution", 6}}));
  const auto thin = borderedPeriodsOf(sampleSurface("annulus", {{"R", 2}, {"resolution", 6}}));
  ASSERT_OK(wide);
  ASSERT_OK(thin);
  // log(8) / (2 pi) = 0.33 and log(2) / (2 pi) = 0.11: both doubles are reduced the other way up.
  EXPECT_NEAR(wide->periods.period(0, 0).imag(), 1 / (2 * wide->modulus->value), 1e-12);
  EXPECT_NEAR(thin->periods.period(0, 0).imag(), 1 / (2 * thin->modulus->value), 1e-12);
  EXPECT_NEAR(wide->periods.period(0, 0).real(), 0, 1e-12);
}

TEST(BorderedPeriods, RefuseSurfacesWithoutAny) {
  const auto disk = borderedPeriodsOf(plate(3, 2, {}));
  EXPECT_THAT(disk, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(disk.status().message(), testing::HasSubstr("a disk has no moduli"));
  EXPECT_THAT(borderedPeriodsOf(gluedPolygon(8)), FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
