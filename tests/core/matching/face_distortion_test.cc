#include "core/matching/face_distortion.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace moduli {
namespace {

Eigen::Vector3d anyPoint(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

TEST(FaceDistortion, IsFourTimesTheAreaForIsometriesAndMoreForOthers) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const SpaceTriangle before = {anyPoint(random), anyPoint(random), anyPoint(random)};
    const FaceDistortion face(before);
    const double area = (before[1] - before[0]).cross(before[2] - before[0]).norm() / 2;
    EXPECT_NEAR(face.area(), area, 1e-14 * (1 + area));
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(anyPoint(random)[0], 1, anyPoint(random)[1], 0.3).normalized();
    const SpaceTriangle turned = {turn * before[0], turn * before[1], turn * before[2]};
    EXPECT_NEAR(face.energy(turned), 4 * area, 1e-10 * area);
    const SpaceTriangle other = {anyPoint(random), anyPoint(random), anyPoint(random)};
    EXPECT_GT(face.energy(other), 4 * area);
  }
}

TEST(FaceDistortion, AddsTheSquaresOfTheSingularValuesAndOfTheirInverses) {
  const SpaceTriangle before = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1.3, 0.2, 0),
                                Eigen::Vector3d(0.1, 0.9, 0)};
  const FaceDistortion face(before);
  for (const double s : {0.1, 0.7, 1.0, 3.0}) {
    const double t = 0.6;
    SpaceTriangle after;
    for (int c = 0; c < 3; ++c) after[c] = {s * before[c].x(), 0, t * before[c].y()};
    const double expected = face.area() * (s * s + t * t + 1 / (s * s) + 1 / (t * t));
    EXPECT_NEAR(face.energy(after), expected, 1e-13 * expected);
  }
}

TEST(FaceDistortion, DerivativesAreThoseOfTheEnergy) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const SpaceTriangle before = {anyPoint(random), anyPoint(random), anyPoint(random)};
    SpaceTriangle after = {anyPoint(random), anyPoint(random), anyPoint(random)};
    const FaceDistortion face(before);
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    face.differentiate(after, gradient, hessian);
    const Eigen::Vector3d at = after[0];
    for (int k = 0; k < 3; ++k) {
      // Central differences of step h: h^2 of truncation and 1e-16 / h of rounding, both relative
      // to an energy whose scale of change is the triangle's height.
      const double h = 1e-5 * std::sqrt((after[1] - at).cross(after[2] - at).norm());
      after[0][k] = at[k] + h;
      const double above = face.energy(after);
      after[0][k] = at[k] - h;
      const double below = face.energy(after);
      after[0][k] = at[k];
      const double scale = gradient.norm() + face.energy(after);
      EXPECT_NEAR(gradient[k], (above - below) / (2 * h), 1e-4 * scale);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(hessian);
    EXPECT_GE(eigen.eigenvalues()[0], -1e-12 * eigen.eigenvalues()[2]);
  }
}

TEST(FaceDistortion, IsFiniteForTrianglesWithoutArea) {
  const Eigen::Vector3d o(0, 0, 0), x(1, 0, 0), y(0, 1, 0);
  EXPECT_TRUE(std::isfinite(FaceDistortion({o, x, y}).energy({o, x, 2 * x})));
  EXPECT_GT(FaceDistortion({o, x, y}).energy({o, x, 2 * x}), 1e6);
  EXPECT_TRUE(std::isfinite(FaceDistortion({o, x, 2 * x}).energy({o, x, y})));
  EXPECT_EQ(FaceDistortion({o, o, o}).energy({o, x, y}), 0);
}

}  // namespace
}  // namespace moduli
