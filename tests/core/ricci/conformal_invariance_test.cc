// What the discrete conformal class keeps: inversion of space, the choice of a scheme, refinement.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/forms/torus_period.h"
#include "core/intrinsic/delaunay.h"
#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "core/ricci/circle_packing.h"
#include "core/ricci/newton.h"
#include "core/ricci/uniformize.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Positions = std::vector<Eigen::Vector3d>;

struct Embedded {
  Positions positions;
  std::vector<Triangle> faces;
};

Embedded sample(const std::string& kind, const std::map<std::string, double>& parameters) {
  const Result<TriangleSoup> soup = makeSample(kind, parameters);
  return {soup->vertices, soup->faces};
}

/// p / |p|^2 about a point well outside.
Embedded inverted(Embedded surface, const Eigen::Vector3d& center) {
  for (Eigen::Vector3d& p : surface.positions) p = (p - center) / (p - center).squaredNorm();
  return surface;
}

Result<Uniformization> uniformized(const Embedded& embedded, bool initial_delaunay) {
  const MetricSurface surface = fromPositions(embedded.positions, embedded.faces);
  Context context;
  UniformizeOptions options;
  options.initial_delaunay = initial_delaunay;
  return uniformize(context, surface.surface, surface.lengths, options);
}

/// Final half chords by vertex pair.
using Edges = std::map<std::pair<Index, Index>, std::vector<Index>>;

Edges edgesOf(const IntrinsicTriangulation& triangulation) {
  Edges edges;
  for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
    if (triangulation.twin(h) < h) continue;
    edges[std::minmax(triangulation.tail(h), triangulation.head(h))].push_back(h);
  }
  return edges;
}

double slackOf(const DiscreteMetric& metric, Index h) {
  const Index t = metric.triangulation.twin(h);
  const auto half = [&](Index g) { return metric.half_chords[g]; };
  return delaunaySlack(half(h), half(Connectivity::next(h)), half(Connectivity::previous(h)),
                       half(Connectivity::next(t)), half(Connectivity::previous(t)));
}

/// Lengths of common edges agree up to one scale (`scale`: of b over a), others are cocircular.
void expectSameMetric(const DiscreteMetric& a, const DiscreteMetric& b, double scale,
                      double tolerance) {
  const Edges edges_a = edgesOf(a.triangulation), edges_b = edgesOf(b.triangulation);
  int common = 0;
  double worst = 0, worst_slack = 0;
  for (const auto& [pair, own] : edges_a) {
    const auto other = edges_b.find(pair);
    if (other == edges_b.end() || other->second.size() != own.size()) {
      for (const Index h : own) worst_slack = std::max(worst_slack, slackOf(a, h));
      continue;
    }
    std::vector<double> la, lb;
    for (const Index h : own) la.push_back(lengthOfHalfChord(a.geometry, a.half_chords[h]));
    for (const Index h : other->second) {
      lb.push_back(lengthOfHalfChord(b.geometry, b.half_chords[h]) / scale);
    }
    std::sort(la.begin(), la.end());
    std::sort(lb.begin(), lb.end());
    for (std::size_t n = 0; n < la.size(); ++n) {
      worst = std::max(worst, std::abs(la[n] - lb[n]));
      ++common;
    }
  }
  EXPECT_LE(worst, tolerance);
  EXPECT_LE(worst_slack, tolerance);
  EXPECT_GT(common, a.triangulation.faceCount());  // Of 3 / 2 as many edges.
}

double meanHalfChord(const DiscreteMetric& metric) {
  double sum = 0;
  for (const double half : metric.half_chords) sum += half;
  return sum / static_cast<double>(metric.half_chords.size());
}

// Cross ratios of lengths are what inversion keeps, so that both meshes are of one class to
// rounding. 1e-7 is what is promised; the conditioning of these surfaces leaves some 1e-11.
TEST(ConformalInvariance, InversionOfSpaceKeepsTheHyperbolicMetric) {
  const Embedded surface = sample("genus", {{"genus", 2}, {"resolution", 8}, {"seed", 3}});
  const auto a = uniformized(surface, false);
  const auto b = uniformized(inverted(surface, {3, 4, 2.5}), false);
  ASSERT_OK(a);
  ASSERT_OK(b);
  expectSameMetric(a->metric, b->metric, 1, 1e-9);
}

TEST(ConformalInvariance, InversionOfSpaceKeepsTheFlatMetricUpToScale) {
  const Embedded surface = sample("torus", {{"R", 2}, {"r", 1}, {"resolution", 24}, {"seed", 5}});
  const auto a = uniformized(surface, false);
  const auto b = uniformized(inverted(surface, {3, 4, 2.5}), false);
  ASSERT_OK(a);
  ASSERT_OK(b);
  // The mean length of edges that have no tie would do as well; ties do not change it here.
  expectSameMetric(a->metric, b->metric, meanHalfChord(b->metric) / meanHalfChord(a->metric), 1e-9);
}

/// A torus of revolution in isothermal coordinates, on a lattice of nearly equilateral triangles:
/// tau = i sqrt(3) / 2 for the radii below, with n x n vertices. Rows run around the axis.
MetricSurface isothermalTorus(int n) {
  const double R = std::sqrt(1 + 4.0 / 3);
  Positions positions;
  for (int row = 0; row < n; ++row) {
    const double v = 2 * std::numbers::pi * (row + 0.25) / n;  // of the tube, conformal
    const double theta =
        2 * std::atan2(std::sqrt((R + 1) / (R - 1)) * std::sin(v / 2), std::cos(v / 2));
    for (int column = 0; column < n; ++column) {
      const double phi = 2 * std::numbers::pi * (column + 0.5 * (row % 2)) / n;
      const double radius = R + std::cos(theta);
      positions.emplace_back(radius * std::cos(phi), radius * std::sin(phi), std::sin(theta));
    }
  }
  std::vector<Triangle> faces;
  const auto at = [n](int row, int column) { return (row % n) * n + (column + n) % n; };
  for (int row = 0; row < n; ++row) {
    const int shift = row % 2;
    for (int column = 0; column < n; ++column) {
      const Index a = at(row, column), b = at(row, column + 1);
      const Index above = at(row + 1, column + shift), left = at(row + 1, column + shift - 1);
      faces.push_back({a, b, above});
      faces.push_back({a, above, left});
    }
  }
  return fromPositions(positions, std::move(faces));
}

/// The shape of the flat metric that a scheme gives: exact for flat triangles.
Complex shapeBy(Scheme scheme, const MetricSurface& torus) {
  Context context;
  std::vector<double> lengths;
  Connectivity surface = torus.surface;
  if (scheme == Scheme::kVertexScaling) {
    const auto found = uniformize(context, torus.surface, torus.lengths);
    EXPECT_OK(found);
    surface = found->metric.triangulation.connectivity();
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      lengths.push_back(found->metric.half_chords[surface.halfedge(e)]);
    }
  } else {
    auto model =
        CirclePackingModel::make(torus.surface, Geometry::kEuclidean, scheme, torus.lengths);
    EXPECT_OK(model);
    EXPECT_EQ(model->clampedFraction().value_or(0), 0);
    const Eigen::VectorXd target = Eigen::VectorXd::Zero(model->size());
    const auto found = solveCurvature(context, *model, target, model->initial());
    EXPECT_OK(found);
    lengths = model->lengths();
  }
  const auto period = computeTorusPeriod(context, surface, lengths);
  EXPECT_OK(period);
  return period->tau;
}

// Errors of three discretizations of one smooth torus fall at least at first order: halving h
// halves them, up to the next order (10%); and so do their differences.
TEST(ConformalInvariance, AllSchemesFindTheClassOfASmoothTorusAtFirstOrderOrBetter) {
  const Complex exact(0, 2 / std::sqrt(3.0));
  for (const Scheme scheme :
       {Scheme::kVertexScaling, Scheme::kThurston, Scheme::kInversiveDistance}) {
    std::vector<double> errors, differences;
    for (const int n : {12, 24, 48}) {
      const MetricSurface torus = isothermalTorus(n);
      const Complex tau = shapeBy(scheme, torus);
      errors.push_back(std::abs(tau - exact));
      differences.push_back(std::abs(tau - shapeBy(Scheme::kVertexScaling, torus)));
    }
    for (std::size_t k = 1; k < errors.size(); ++k) {
      EXPECT_LT(errors[k], 0.55 * errors[k - 1]) << static_cast<int>(scheme);
      EXPECT_LE(differences[k], 0.55 * differences[k - 1]) << static_cast<int>(scheme);
    }
    EXPECT_LT(errors.back(), 0.01);
  }
}

// From the intrinsic Delaunay triangulation a mesh and its inverted image are of different classes
// that meet as both are refined, at first order or better.
TEST(ConformalInvariance, WithInitialDelaunayInversionIsFeltLessAndLess) {
  std::vector<double> differences;
  for (const int n : {12, 24, 48}) {
    const Embedded embedded = sample("torus", {{"R", 2}, {"r", 1}, {"resolution", 1.0 * n}});
    const auto shape = [](const Embedded& surface) {
      const MetricSurface metric = fromPositions(surface.positions, surface.faces);
      return shapeBy(Scheme::kVertexScaling, metric);
    };
    differences.push_back(std::abs(shape(embedded) - shape(inverted(embedded, {3, 4, 2.5}))));
  }
  EXPECT_LT(differences[1], 0.55 * differences[0]);
  EXPECT_LT(differences[2], 0.55 * differences[1]);
}

}  // namespace
}  // namespace moduli
