#include "core/ricci/vertex_scaling.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/intrinsic/delaunay.h"
#include "core/mesh/double_cover.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Flips = VertexScalingModel::Flips;
constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr std::array<Geometry, 3> kGeometries{Geometry::kEuclidean, Geometry::kHyperbolic,
                                              Geometry::kSpherical};
constexpr std::array<Geometry, 2> kPlanes{Geometry::kEuclidean, Geometry::kHyperbolic};

/// Longest length 0.4: triangles that fit on the sphere, also after small steps.
MetricSurface small(MetricSurface metric) {
  const double longest = *std::max_element(metric.lengths.begin(), metric.lengths.end());
  return scale(std::move(metric), 0.4 / longest);
}

/// Closed ones of genus 1 and 2, of them some with double edges and loops, one of a single vertex.
std::vector<MetricSurface> closedSurfaces() {
  return {small(flatTorus({0.2, 1.1}, 4, 4, 0.2, 7)),
          small(gluedPolygon(8)),
          small(squareTiledL()),
          small(octahedronCover()),
          small(disphenoidCover(3, 4, 4.5)),
          small(subdivide(octahedronCover(), 2))};
}

std::vector<MetricSurface> allSurfaces() {
  std::vector<MetricSurface> surfaces = closedSurfaces();
  surfaces.push_back(small(plate(3, 3, {{1, 1}})));
  return surfaces;
}

IntrinsicTriangulation triangulate(Geometry geometry, const MetricSurface& metric) {
  std::vector<double> half_chords;
  for (const double length : metric.lengths) half_chords.push_back(halfChord(geometry, length));
  return {metric.surface, half_chords};
}

VertexScalingModel makeModel(Geometry geometry, const MetricSurface& metric, Flips flips) {
  return {geometry, triangulate(geometry, metric), Unknowns::all(metric.surface.vertexCount()),
          flips};
}

Eigen::VectorXd somewhere(Eigen::Index size, double far, std::mt19937& random) {
  Eigen::VectorXd u(size);
  for (double& value : u) value = far * (2 * uniform(random) - 1);
  return u;
}

Eigen::VectorXd curvatureAt(VertexScalingModel& model, const Eigen::VectorXd& u) {
  Context context;
  EXPECT_OK(model.moveTo(context, u));
  return model.curvature();
}

/// Both triangles of the matrix at u.
Eigen::MatrixXd matrixAt(VertexScalingModel& model, const Eigen::VectorXd& u) {
  curvatureAt(model, u);
  const Eigen::MatrixXd lower = model.hessian();
  EXPECT_TRUE(lower.isLowerTriangular());
  return lower.selfadjointView<Eigen::Lower>();
}

/// By differences whose error is h^4 / 30 times a fifth derivative.
Eigen::MatrixXd differences(VertexScalingModel& model, const Eigen::VectorXd& u) {
  const double h = 1e-3;
  Eigen::MatrixXd result(u.size(), u.size());
  for (Eigen::Index j = 0; j < u.size(); ++j) {
    const auto at = [&](double step) {
      Eigen::VectorXd moved = u;
      moved[j] += step;
      return curvatureAt(model, moved);
    };
    result.col(j) = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
  }
  return result;
}

double smallestSlack(const VertexScalingModel& model) {
  const IntrinsicTriangulation& t = model.triangulation();
  const std::vector<double>& x = model.scaledHalfChords();
  double smallest = 2;
  for (Index h = 0; h < t.halfedgeCount(); ++h) {
    if (!t.canFlip(h)) continue;
    const Index g = t.twin(h);
    smallest = std::min(smallest,
                        delaunaySlack(x[h], x[Connectivity::next(h)], x[Connectivity::previous(h)],
                                      x[Connectivity::next(g)], x[Connectivity::previous(g)]));
  }
  return smallest;
}

double smallestAngle(const VertexScalingModel& model) {
  return *std::min_element(model.angles().begin(), model.angles().end());
}

TEST(VertexScalingHessian, IsTheDerivativeOfTheCurvatureOnFixedTriangles) {
  // CHECKS F1. A fifth derivative of a sum of some ten angles of at least 0.2: below 1e5.
  std::mt19937 random(1);
  for (const MetricSurface& metric : allSurfaces()) {
    for (const Geometry geometry : kGeometries) {
      VertexScalingModel model = makeModel(geometry, metric, Flips::kOff);
      const Eigen::VectorXd u = somewhere(model.size(), 0.1, random);
      const Eigen::MatrixXd numeric = differences(model, u);
      const Eigen::MatrixXd exact = matrixAt(model, u);
      ASSERT_TRUE(model.proper());
      ASSERT_GT(smallestAngle(model), 0.1);
      EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-8);
      EXPECT_LT((numeric - numeric.transpose()).cwiseAbs().maxCoeff(), 1e-8);
    }
  }
}

TEST(VertexScalingHessian, IsTheDerivativeOfTheCurvatureAmongFlips) {
  // Away from ties, which the steps of at most 0.002 do not reach, the triangulation is constant.
  std::mt19937 random(2);
  int flipped = 0, tried = 0;
  for (const MetricSurface& metric : closedSurfaces()) {
    for (const Geometry geometry : kPlanes) {
      VertexScalingModel model = makeModel(geometry, metric, Flips::kOn);
      for (int trial = 0; trial < 10; ++trial) {
        const Eigen::VectorXd u = somewhere(model.size(), 0.7, random);
        curvatureAt(model, u);
        if (smallestSlack(model) < 0.02 || smallestAngle(model) < 0.2) continue;
        ++tried;
        if (!model.triangulation().history().empty()) ++flipped;
        const Eigen::MatrixXd numeric = differences(model, u);
        EXPECT_LT((matrixAt(model, u) - numeric).cwiseAbs().maxCoeff(), 1e-8);
      }
    }
  }
  EXPECT_GT(flipped, 10);
  EXPECT_GT(tried, flipped);
}

TEST(VertexScalingCurvature, IsContinuouslyDifferentiableWhereEdgesFlip) {
  // Along a line with flips, trapezoidal steps of the Hessian add up to the curvature: its kinks
  // make an error of h^2 for each step.
  std::mt19937 random(3);
  const MetricSurface torus = small(flatTorus({0.2, 1.1}, 4, 4, 0.2, 7));
  for (const Geometry geometry : kPlanes) {
    VertexScalingModel model = makeModel(geometry, torus, Flips::kOn);
    const Eigen::VectorXd direction = somewhere(model.size(), 1, random);
    const Eigen::VectorXd start = curvatureAt(model, 0 * direction);
    const std::size_t flips = model.triangulation().history().size();
    const auto error = [&](int steps) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(model.size());
      Eigen::VectorXd before = matrixAt(model, 0 * direction) * direction;
      for (int n = 1; n <= steps; ++n) {
        const Eigen::VectorXd slope = matrixAt(model, direction * n / steps) * direction;
        sum += (before + slope) / (2 * steps);
        before = slope;
      }
      return (start + sum - curvatureAt(model, direction)).cwiseAbs().maxCoeff();
    };
    const double coarse = error(100), fine = error(800);
    EXPECT_GT(model.triangulation().history().size(), flips);
    EXPECT_LT(fine, 1e-4);
    EXPECT_LT(fine, coarse / 16);  // Between order 1 (a factor 8) and order 2 (64).
  }
}

TEST(VertexScalingHessian, IsPositiveSemidefinite) {
  // Among flips, and on fixed triangles that may be broken: the energy is convex.
  std::mt19937 random(4);
  for (const MetricSurface& metric : closedSurfaces()) {
    for (const Geometry geometry : kPlanes) {
      for (const Flips flips : {Flips::kOn, Flips::kOff}) {
        VertexScalingModel model = makeModel(geometry, metric, flips);
        for (const double far : {0.5, 2.0}) {
          const Eigen::MatrixXd matrix = matrixAt(model, somewhere(model.size(), far, random));
          const double size = matrix.cwiseAbs().maxCoeff();
          ASSERT_TRUE(std::isfinite(size));
          EXPECT_GE(matrix.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(),
                    -1e-12 * (1 + size));
          if (geometry == Geometry::kEuclidean) {
            const Eigen::VectorXd constants = matrix.rowwise().sum();
            EXPECT_LE(constants.cwiseAbs().maxCoeff(), 1e-13 * (1 + size));
          }
        }
      }
    }
  }
}

TEST(VertexScalingModel, SumsTheUnknownsOfOrbits) {
  // Of a double: the entries of both halves together, P^T K and P^T H P.
  std::mt19937 random(5);
  for (const MetricSurface& half : {plate(3, 2, {}), plate(3, 3, {{1, 1}})}) {
    const auto cover = doubleCover(half.surface);
    ASSERT_OK(cover);
    MetricSurface metric{cover->connectivity, {}};
    for (const Index e : cover->edge) metric.lengths.push_back(half.lengths[e]);
    metric = small(metric);
    Unknowns orbits;
    orbits.count = half.surface.vertexCount();
    for (std::size_t v = 0; v < cover->involution.size(); ++v) {
      orbits.of_vertex.push_back(std::min(static_cast<Index>(v), cover->involution[v]));
    }
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(metric.surface.vertexCount(), orbits.count);
    for (Index v = 0; v < metric.surface.vertexCount(); ++v) P(v, orbits.of_vertex[v]) = 1;
    for (const Geometry geometry : kPlanes) {
      for (const Flips flips : {Flips::kOn, Flips::kOff}) {
        VertexScalingModel all = makeModel(geometry, metric, flips);
        VertexScalingModel few(geometry, triangulate(geometry, metric), orbits, flips);
        ASSERT_EQ(few.size(), orbits.count);
        for (int trial = 0; trial < 5; ++trial) {
          const Eigen::VectorXd u = somewhere(few.size(), 0.5, random);
          const Eigen::MatrixXd H = matrixAt(all, P * u);
          const Eigen::MatrixXd reduced = matrixAt(few, u);
          // Sums of the same numbers in another order.
          const double size = H.cwiseAbs().maxCoeff();
          EXPECT_LT((reduced - P.transpose() * H * P).cwiseAbs().maxCoeff(), 1e-14 * (1 + size));
          EXPECT_LT((few.curvature() - P.transpose() * all.curvature()).cwiseAbs().maxCoeff(),
                    1e-13);
        }
      }
    }
  }
}

TEST(VertexScalingModel, ObeysGaussAndBonnet) {
  // CHECKS F11.
  std::mt19937 random(6);
  for (const MetricSurface& metric : allSurfaces()) {
    bool closed = true;
    for (Index e = 0; e < metric.surface.edgeCount(); ++e) {
      closed = closed && !metric.surface.isBoundaryEdge(e);
    }
    for (const Geometry geometry : kGeometries) {
      const bool flips = closed && geometry != Geometry::kSpherical;
      VertexScalingModel model = makeModel(geometry, metric, flips ? Flips::kOn : Flips::kOff);
      for (int trial = 0; trial < 10; ++trial) {
        const double total =
            curvatureAt(model, somewhere(model.size(), flips ? 2 : 0.1, random)).sum();
        ASSERT_TRUE(model.proper());
        EXPECT_NEAR(total + planeCurvature(geometry) * model.area(),
                    2 * kPi * metric.surface.eulerCharacteristic(), 1e-11);
        double sum = 0;
        for (const double curvature : model.vertexCurvatures()) sum += curvature;
        EXPECT_NEAR(sum, total, 1e-12);
      }
    }
  }
}

TEST(VertexScalingModel, GoesOnContinuouslyWhereTrianglesBreak) {
  // One vertex of a torus shrinks until a face breaks. Angles run like the square root of the
  // distance from there.
  const MetricSurface torus = small(flatTorus({0.2, 1.1}, 4, 4, 0.2, 7));
  for (const Geometry geometry : kGeometries) {
    VertexScalingModel model = makeModel(geometry, torus, Flips::kOff);
    const auto at = [&](double t) -> Eigen::VectorXd {
      Eigen::VectorXd u = Eigen::VectorXd::Zero(model.size());
      u[0] = -t;
      return u;
    };
    double whole = 0, broken = 8;
    for (int n = 0; n < 60; ++n) {
      const double t = (whole + broken) / 2;
      curvatureAt(model, at(t));
      (model.proper() ? whole : broken) = t;
    }
    for (const double step : {1e-6, 1e-10}) {
      const Eigen::VectorXd inside = curvatureAt(model, at(whole - step));
      ASSERT_TRUE(model.proper());
      const Eigen::VectorXd outside = curvatureAt(model, at(broken + step));
      ASSERT_FALSE(model.proper());
      EXPECT_LT((inside - outside).cwiseAbs().maxCoeff(), 20 * std::sqrt(step));
      EXPECT_TRUE(Eigen::MatrixXd(model.hessian()).allFinite());
    }
    // All angles are pi or 0 there in the end; half of them count for nothing.
    EXPECT_TRUE(matrixAt(model, at(300)).allFinite());
    EXPECT_TRUE(curvatureAt(model, at(300)).allFinite());
  }
}

TEST(VertexScalingModel, ForgetsTheWay) {
  // The Delaunay triangulation at u depends on u alone: after many moves, some accepted, the
  // curvature there is that of a model that went directly.
  std::mt19937 random(7);
  for (const MetricSurface& metric : closedSurfaces()) {
    for (const Geometry geometry : kPlanes) {
      VertexScalingModel direct = makeModel(geometry, metric, Flips::kOn);
      VertexScalingModel walker = makeModel(geometry, metric, Flips::kOn);
      std::size_t accepted = 0;
      for (int n = 0; n < 20; ++n) {
        curvatureAt(walker, somewhere(walker.size(), 2, random));
        if (n % 2 == 0) {
          walker.accept();
          accepted = walker.triangulation().history().size();
        }
        const Eigen::VectorXd u = somewhere(walker.size(), 2, random);
        const Eigen::VectorXd there = curvatureAt(walker, u);
        EXPECT_LT((there - curvatureAt(direct, u)).cwiseAbs().maxCoeff(), 1e-10);
        EXPECT_GE(walker.triangulation().history().size(), accepted);
      }
    }
  }
}

TEST(VertexScalingModel, CountsChangesOfThePattern) {
  std::mt19937 random(8);
  VertexScalingModel model =
      makeModel(Geometry::kEuclidean, small(flatTorus({0.2, 1.1}, 4, 4, 0.2, 7)), Flips::kOn);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.size());
  matrixAt(model, zero);
  model.accept();
  matrixAt(model, zero);
  const int version = model.patternVersion();
  matrixAt(model, zero);
  EXPECT_EQ(model.patternVersion(), version);
  const Eigen::VectorXd u = somewhere(model.size(), 1, random);
  matrixAt(model, u);
  ASSERT_FALSE(model.triangulation().history().empty());
  EXPECT_NE(model.patternVersion(), version);
}

TEST(VertexScalingModel, RefusesFactorsOutOfRange) {
  for (const Geometry geometry : kPlanes) {
    for (const Flips flips : {Flips::kOff, Flips::kOn}) {
      VertexScalingModel model = makeModel(geometry, small(squareTiledL()), flips);
      Context context;
      for (const double value : {601.0, -601.0, std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THAT(model.moveTo(context, Eigen::VectorXd::Constant(model.size(), value)),
                    FailsWith(Reason::kNoConvergence));
      }
      // And answers again after a good one.
      EXPECT_TRUE(curvatureAt(model, Eigen::VectorXd::Zero(model.size())).allFinite());
    }
  }
}

TEST(VertexScalingModel, IsFreeOfScaleUpToTheLimit) {
  // The vertex of squareTiledL has the angle 6 pi.
  for (const Flips flips : {Flips::kOff, Flips::kOn}) {
    for (const double u : {-599.0, -400.0, 400.0, 599.0}) {
      VertexScalingModel L = makeModel(Geometry::kEuclidean, small(squareTiledL()), flips);
      EXPECT_NEAR(curvatureAt(L, Eigen::VectorXd::Constant(1, u))[0], -4 * kPi, 100 * kEpsilon);
      VertexScalingModel torus =
          makeModel(Geometry::kEuclidean, small(flatTorus({0.2, 1.1}, 4, 4, 0.2, 7)), flips);
      const Eigen::VectorXd at_one = curvatureAt(torus, Eigen::VectorXd::Zero(16));
      const Eigen::VectorXd here = curvatureAt(torus, Eigen::VectorXd::Constant(16, u));
      EXPECT_LT((here - at_one).cwiseAbs().maxCoeff(), 1e-13);
    }
  }
}

TEST(VertexScalingModel, HasNumbersOrFails) {
  // Huge hyperbolic triangles are ideal, with angles of 0, as far as there are numbers for them.
  VertexScalingModel model = makeModel(Geometry::kHyperbolic, small(squareTiledL()), Flips::kOn);
  Context context;
  EXPECT_NEAR(curvatureAt(model, Eigen::VectorXd::Constant(1, 100))[0], 2 * kPi, 100 * kEpsilon);
  for (const double u : {200.0, 300.0, 599.0}) {
    if (model.moveTo(context, Eigen::VectorXd::Constant(1, u)).ok()) {
      EXPECT_NEAR(model.curvature()[0], 2 * kPi, 100 * kEpsilon);
    }
  }
}

TEST(VertexScalingModel, StopsWhenCancelled) {
  VertexScalingModel model = makeModel(Geometry::kEuclidean, small(squareTiledL()), Flips::kOn);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(model.moveTo(context, Eigen::VectorXd::Zero(1)), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
