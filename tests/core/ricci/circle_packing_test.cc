#include "core/ricci/circle_packing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/intrinsic/angles.h"
#include "tests/core/forms/glued_surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr std::array<Geometry, 3> kGeometries{Geometry::kEuclidean, Geometry::kHyperbolic,
                                              Geometry::kSpherical};
constexpr std::array<Scheme, 3> kSchemes{Scheme::kThurston, Scheme::kTangential,
                                         Scheme::kInversiveDistance};

/// A closed surface, one with boundary, and two on which edges are loops or doubled.
std::vector<MetricSurface> someSurfaces() {
  std::vector<MetricSurface> surfaces{flatTorus({0.2, 1.1}, 4, 4, 0.2, 7), plate(3, 3, {{1, 1}}),
                                      gluedPolygon(8), squareTiledL()};
  for (MetricSurface& surface : surfaces) {
    // Lengths of at most 0.4: triangles that fit on the sphere, also after the steps of the tests.
    const double longest = *std::max_element(surface.lengths.begin(), surface.lengths.end());
    surface = scale(std::move(surface), 0.4 / longest);
  }
  return surfaces;
}

CirclePackingModel makeModel(const MetricSurface& metric, Geometry geometry, Scheme scheme) {
  auto model = CirclePackingModel::make(metric.surface, geometry, scheme, metric.lengths);
  EXPECT_OK(model);
  return *std::move(model);
}

Eigen::VectorXd somewhere(const CirclePackingModel& model, double far, std::mt19937& random) {
  Eigen::VectorXd u = model.initial();
  for (double& value : u) value += far * (2 * uniform(random) - 1);
  return u;
}

Eigen::VectorXd curvatureAt(CirclePackingModel& model, const Eigen::VectorXd& u) {
  Context context;
  EXPECT_OK(model.moveTo(context, u));
  return model.curvature();
}

/// Both triangles of the matrix at u.
Eigen::MatrixXd matrixAt(CirclePackingModel& model, const Eigen::VectorXd& u) {
  curvatureAt(model, u);
  const Eigen::MatrixXd lower = model.hessian();
  EXPECT_TRUE(lower.isLowerTriangular());
  return lower.selfadjointView<Eigen::Lower>();
}

/// By differences whose error is h^4 / 30 times a fifth derivative.
Eigen::MatrixXd differences(CirclePackingModel& model, const Eigen::VectorXd& u) {
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

TEST(CirclePackingHessian, IsTheSymmetricDerivativeOfTheCurvature) {
  // CHECKS F1. Fifth derivatives are below 1e4 unless a triangle is nearly broken; the rounding is
  // 1e-15 / h.
  std::mt19937 random(1);
  for (const MetricSurface& metric : someSurfaces()) {
    for (const Geometry geometry : kGeometries) {
      for (const Scheme scheme : kSchemes) {
        CirclePackingModel model = makeModel(metric, geometry, scheme);
        const Eigen::VectorXd u = somewhere(model, 0.1, random);
        const Eigen::MatrixXd numeric = differences(model, u);
        const Eigen::MatrixXd exact = matrixAt(model, u);
        ASSERT_EQ(model.brokenFaces(), 0);
        EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-8);
        EXPECT_LT((numeric - numeric.transpose()).cwiseAbs().maxCoeff(), 1e-8);
      }
    }
  }
}

/// One triangle with random radii and inversive distances around 1.
MetricSurface someTriangle(std::mt19937& random) {
  while (true) {
    MetricSurface triangle{*Connectivity::fromFaces(3, {{0, 1, 2}}), {}};
    for (int e = 0; e < 3; ++e) triangle.lengths.push_back(0.3 + 0.7 * uniform(random));
    const double perimeter = triangle.lengths[0] + triangle.lengths[1] + triangle.lengths[2];
    if (*std::max_element(triangle.lengths.begin(), triangle.lengths.end()) < 0.42 * perimeter) {
      return triangle;
    }
  }
}

double radiusOf(Geometry geometry, double u) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return std::exp(u);
    case Geometry::kHyperbolic:
      return 2 * std::atanh(std::exp(u));
    case Geometry::kSpherical:
      return 2 * std::atan(std::exp(u));
  }
  return 0;
}

/// The factor t(h) / F(l) c(r_0) / c(d_0) of MATH 6.3 for the edge from corner 0 to corner 1 of a
/// triangle, by solving for its power centre in the plane or in the space of the model.
double powerCentreFactor(Geometry geometry, const Eigen::Vector3d& radius, double l01, double l02,
                         double angle) {
  if (geometry == Geometry::kEuclidean) {
    const Eigen::Vector2d p(l01, 0);
    const Eigen::Vector2d q(l02 * std::cos(angle), l02 * std::sin(angle));
    Eigen::Matrix2d matrix;
    matrix << 2 * p.transpose(), 2 * q.transpose();
    const Eigen::Vector2d right(p.squaredNorm() - radius[1] * radius[1] + radius[0] * radius[0],
                                q.squaredNorm() - radius[2] * radius[2] + radius[0] * radius[0]);
    return matrix.inverse().row(1).dot(right) / l01;
  }
  const bool curved = geometry == Geometry::kSpherical;
  const auto sine = [curved](double x) { return curved ? std::sin(x) : std::sinh(x); };
  const auto cosine = [curved](double x) { return curved ? std::cos(x) : std::cosh(x); };
  Eigen::Matrix3d corner;
  corner << 1, 0, 0, cosine(l01), sine(l01), 0, cosine(l02), sine(l02) * std::cos(angle),
      sine(l02) * std::sin(angle);
  const double sign = curved ? 1 : -1;
  const Eigen::DiagonalMatrix<double, 3> form(sign, 1, 1);
  Eigen::Vector3d centre = (corner * form).inverse() * (sign * radius.unaryExpr(cosine));
  centre /= std::sqrt(std::abs(sign * centre[0] * centre[0] + centre.tail<2>().squaredNorm()));
  const double height = curved ? std::asin(centre[2]) : std::asinh(centre[2]);
  const double foot = curved ? std::atan2(centre[1], centre[0]) : std::atanh(centre[1] / centre[0]);
  const double tangent = curved ? std::tan(height) : std::tanh(height);
  return tangent / sine(l01) * cosine(radius[0]) / cosine(foot);
}

TEST(CirclePackingHessian, IsGivenByThePowerCentreOfTheThreeCircles) {
  // CHECKS F2; both sides are exact formulas. The curvatures are those of a single triangle, so the
  // matrix is less the derivative of its angles.
  std::mt19937 random(2);
  for (const Geometry geometry : kGeometries) {
    for (const Scheme scheme : kSchemes) {
      for (int trial = 0; trial < 50; ++trial) {
        CirclePackingModel model = makeModel(someTriangle(random), geometry, scheme);
        const Eigen::VectorXd u = somewhere(model, 0.1, random);
        const Eigen::MatrixXd matrix = matrixAt(model, u);
        const Eigen::Vector3d radius =
            u.unaryExpr([geometry](double x) { return radiusOf(geometry, x); });
        const Connectivity& surface = model.surface();
        const double factor =
            powerCentreFactor(geometry, radius, model.lengths()[surface.edge(0)],
                              model.lengths()[surface.edge(2)], model.angles()[0]);
        EXPECT_NEAR(-matrix(0, 1), factor, 1e-8);
      }
    }
  }
}

TEST(CirclePackingHessian, IsSemidefiniteEuclideanAndDefiniteHyperbolic) {
  // Entries are of order 1, eigenvalues good to some 1e-14. Far from the start faces of separate
  // circles break, and their part vanishes.
  std::mt19937 random(3);
  for (const MetricSurface& metric : someSurfaces()) {
    for (const Scheme scheme : kSchemes) {
      for (const double far : {0.2, 1.0}) {
        CirclePackingModel flat = makeModel(metric, Geometry::kEuclidean, scheme);
        const Eigen::MatrixXd matrix = matrixAt(flat, somewhere(flat, far, random));
        const Eigen::VectorXd ones = Eigen::VectorXd::Ones(matrix.rows());
        EXPECT_LT((matrix * ones).cwiseAbs().maxCoeff(), 1e-12);
        EXPECT_GT(matrix.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-12);

        CirclePackingModel curved = makeModel(metric, Geometry::kHyperbolic, scheme);
        const double least = matrixAt(curved, somewhere(curved, far, random))
                                 .selfadjointView<Eigen::Lower>()
                                 .eigenvalues()
                                 .minCoeff();
        EXPECT_GT(least, curved.brokenFaces() == 0 ? 1e-4 : -1e-12);
      }
    }
  }
}

TEST(CirclePackingCurvature, ObeysGaussAndBonnet) {
  // MATH 6.2.
  std::mt19937 random(4);
  for (const MetricSurface& metric : someSurfaces()) {
    for (const Geometry geometry : kGeometries) {
      for (const Scheme scheme : kSchemes) {
        CirclePackingModel model = makeModel(metric, geometry, scheme);
        const double sum = curvatureAt(model, somewhere(model, 0.2, random)).sum();
        const Connectivity& surface = model.surface();
        double area = 0;
        for (Index f = 0; f < surface.faceCount(); ++f) {
          const auto length = [&](Index h) { return model.lengths()[surface.edge(h)]; };
          area += triangleArea(geometry, {length(3 * f), length(3 * f + 1), length(3 * f + 2)});
        }
        EXPECT_NEAR(sum + planeCurvature(geometry) * area, 2 * kPi * surface.eulerCharacteristic(),
                    1e-12 * surface.faceCount());
      }
    }
  }
}

TEST(CirclePackingCurvature, OfManyFacesIsThatOfTheLengths) {
  // Enough faces for several threads.
  const MetricSurface metric = flatTorus({0, 1}, 120, 110, 0.2, 3);
  CirclePackingModel model = makeModel(metric, Geometry::kEuclidean, Scheme::kTangential);
  std::mt19937 random(5);
  const Eigen::VectorXd u = somewhere(model, 0.5, random);
  const Eigen::VectorXd first = curvatureAt(model, u);
  const std::vector<double> expected = vertexCurvatures(metric.surface, model.lengths());
  for (Eigen::Index v = 0; v < u.size(); ++v) EXPECT_NEAR(first[v], expected[v], 1e-13);
  const SparseMatrix matrix = model.hessian();
  EXPECT_EQ(curvatureAt(model, u), first);
  EXPECT_EQ((SparseMatrix(model.hessian() - matrix)).norm(), 0);
}

TEST(CirclePackingLengths, AtFixedInversiveDistanceStartAsGiven) {
  // The law is solved for I and back: some units.
  for (const MetricSurface& metric : someSurfaces()) {
    for (const Geometry geometry : kGeometries) {
      CirclePackingModel model = makeModel(metric, geometry, Scheme::kInversiveDistance);
      curvatureAt(model, model.initial());
      for (Index e = 0; e < metric.surface.edgeCount(); ++e) {
        EXPECT_NEAR(model.lengths()[e] / metric.lengths[e], 1, 20 * kEpsilon);
        EXPECT_GE(model.inversiveDistances()[e], 1 - 10 * kEpsilon);
      }
      EXPECT_EQ(model.clampedFraction(), std::nullopt);
    }
  }
}

TEST(CirclePackingLengths, OfThurstonsCirclesAreKeptOnWellShapedMeshes) {
  // Of a right-angled grid: radii 1 / sqrt 2 of the cell, orthogonal along its sides and touching
  // across its diagonals.
  const MetricSurface grid = flatTorus({0, 1}, 6, 6, 0, 1);
  CirclePackingModel model = makeModel(grid, Geometry::kEuclidean, Scheme::kThurston);
  curvatureAt(model, model.initial());
  EXPECT_EQ(model.clampedFraction(), 0);
  for (Index e = 0; e < grid.surface.edgeCount(); ++e) {
    EXPECT_NEAR(model.lengths()[e] / grid.lengths[e], 1, 20 * kEpsilon);
  }
  // Of any other mesh some are changed, and all I are in [0, 1].
  CirclePackingModel clamped =
      makeModel(flatTorus({0.2, 1.1}, 6, 6, 0.2, 2), Geometry::kEuclidean, Scheme::kThurston);
  EXPECT_GT(clamped.clampedFraction(), 0.01);
  EXPECT_LT(clamped.clampedFraction(), 0.9);
  for (const double distance : clamped.inversiveDistances()) {
    EXPECT_GE(distance, 0);
    EXPECT_LE(distance, 1);
  }
}

TEST(CirclePackingLengths, OfTouchingCirclesAreSumsOfRadii) {
  std::mt19937 random(6);
  for (const Geometry geometry : kGeometries) {
    CirclePackingModel model = makeModel(plate(3, 2, {}), geometry, Scheme::kTangential);
    const Eigen::VectorXd u =
        Eigen::VectorXd::Constant(model.size(), -2.0).unaryExpr([&](double x) {
          return x + uniform(random);
        });
    curvatureAt(model, u);
    const Connectivity& surface = model.surface();
    for (Index e = 0; e < surface.edgeCount(); ++e) {
      const Index h = surface.halfedge(e);
      const double sum =
          radiusOf(geometry, u[surface.tail(h)]) + radiusOf(geometry, u[surface.head(h)]);
      EXPECT_NEAR(model.lengths()[e] / sum, 1, 10 * kEpsilon);
    }
  }
}

TEST(CirclePackingExtension, IsContinuousWhereFacesBreak) {
  // A circle that shrinks between two separate ones ends with sides that are shorter than their
  // distance. Near there an angle runs like the square root.
  for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
    CirclePackingModel model =
        makeModel(flatTorus({0.2, 1.1}, 4, 4, 0.2, 7), geometry, Scheme::kInversiveDistance);
    const double h = 1e-3;
    Eigen::VectorXd u = model.initial();
    Eigen::VectorXd last = curvatureAt(model, u);
    ASSERT_EQ(model.brokenFaces(), 0);
    while (model.brokenFaces() < 3 && u[5] > -10) {
      u[5] -= h;
      const Eigen::VectorXd now = curvatureAt(model, u);
      EXPECT_LT((now - last).cwiseAbs().maxCoeff(), 10 * std::sqrt(h));
      last = now;
    }
    ASSERT_EQ(model.brokenFaces(), 3);
    const auto straight = [](double angle) { return angle == kPi; };
    EXPECT_EQ(std::count_if(model.angles().begin(), model.angles().end(), straight), 3);
    // Somewhat further no other face is near breaking, and the derivative is that of the angles.
    u[5] -= 0.05;
    const Eigen::MatrixXd numeric = differences(model, u);
    const Eigen::MatrixXd exact = matrixAt(model, u);
    ASSERT_EQ(model.brokenFaces(), 3);
    EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(CirclePackingExtension, LeavesNoAngleToATinyCircleBeyondPi) {
  // Thurston's condition for one vertex: in the limit the angles at a circle that shrinks between
  // touching ones are pi each, K = 2 pi - d pi, and never more.
  const MetricSurface klein = kleinQuartic();
  for (const Geometry geometry : {Geometry::kEuclidean, Geometry::kHyperbolic}) {
    CirclePackingModel model = makeModel(klein, geometry, Scheme::kTangential);
    for (const double small : {-5.0, -20.0, -60.0}) {
      Eigen::VectorXd u = Eigen::VectorXd::Constant(model.size(), -1.0);
      u[0] += small;
      const double curvature = curvatureAt(model, u)[0];
      EXPECT_GE(curvature, 2 * kPi - 7 * kPi - 1e-14);
      EXPECT_NEAR(curvature, 2 * kPi - 7 * kPi, 50 * std::exp(small / 2));
    }
  }
}

TEST(CirclePackingModel, RefusesStepsThatAreTooLong) {
  Context context;
  CirclePackingModel model = makeModel(kleinQuartic(), Geometry::kHyperbolic, Scheme::kTangential);
  Eigen::VectorXd u = model.initial();
  for (const double bad :
       {0.0, 1.0, -1e-310, std::nan(""), -std::numeric_limits<double>::infinity()}) {
    u[3] = bad;
    EXPECT_THAT(model.moveTo(context, u), FailsWith(Reason::kNoConvergence)) << bad;
  }
  EXPECT_OK(model.moveTo(context, model.initial()));
  EXPECT_THAT(model.moveTo(context, Eigen::VectorXd::Zero(3)), FailsWith(Reason::kInvalidOption));

  CirclePackingModel flat = makeModel(kleinQuartic(), Geometry::kEuclidean, Scheme::kTangential);
  for (const double bad : {2000.0, -2000.0}) {
    EXPECT_THAT(flat.moveTo(context, Eigen::VectorXd::Constant(flat.size(), bad)),
                FailsWith(Reason::kNoConvergence));
  }
  EXPECT_OK(flat.moveTo(context, Eigen::VectorXd::Constant(flat.size(), 300)));
  EXPECT_NEAR(flat.curvature()[0], 2 * kPi - 7 * kPi / 3, 1e-14);

  CirclePackingModel round =
      makeModel(scale(kleinQuartic(), 0.1), Geometry::kSpherical, Scheme::kTangential);
  EXPECT_THAT(round.moveTo(context, Eigen::VectorXd::Constant(round.size(), 0.5)),
              FailsWith(Reason::kNoConvergence));
  context.setDeadline(Context::Clock::now());
  EXPECT_THAT(round.moveTo(context, round.initial()), FailsWith(Reason::kDeadlineExceeded));
}

TEST(CirclePackingModel, RefusesWhatIsNoMetric) {
  MetricSurface metric = plate(2, 2, {});
  const auto make = [&](Scheme scheme) {
    return CirclePackingModel::make(metric.surface, Geometry::kEuclidean, scheme, metric.lengths);
  };
  EXPECT_THAT(make(Scheme::kVertexScaling), FailsWith(Reason::kInvalidOption));
  const double length = metric.lengths[0];
  for (const double bad : {0.0, 10.0, std::nan("")}) {
    metric.lengths[0] = bad;
    EXPECT_THAT(make(Scheme::kTangential), FailsWith(Reason::kInvalidOption)) << bad;
  }
  metric.lengths[0] = length;
  EXPECT_OK(make(Scheme::kTangential));
  metric.lengths.pop_back();
  EXPECT_THAT(make(Scheme::kTangential), FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
