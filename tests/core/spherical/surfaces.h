#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/core/testing.h"

/// Surfaces for the tests of the sphere map and of signatures, and what should change nothing.
namespace moduli::surfaces {

inline TriangleSoup sample(const std::string& kind,
                           const std::map<std::string, double>& parameters) {
  auto soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  return *std::move(soup);
}

inline TriangleMesh mesh(TriangleSoup soup) {
  auto result = TriangleMesh::fromSoup(std::move(soup));
  EXPECT_OK(result);
  return *std::move(result);
}

inline TriangleSoup read(const std::string& path) {
  Context context;
  auto soup = readMeshFile(context, path);
  EXPECT_OK(soup);
  return *std::move(soup);
}

/// Any rotation, the same for the same seed.
inline Eigen::Matrix3d rotation(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

/// The same surface, turned, scaled and moved.
inline TriangleSoup moved(TriangleSoup soup, double scale) {
  const Eigen::Matrix3d turn = rotation(5);
  for (Eigen::Vector3d& p : soup.vertices) {
    p = scale * (turn * p + Eigen::Vector3d(0.3, -1.1, 0.7));
  }
  return soup;
}

/// The same surface with vertices and faces in another order and faces starting at other corners.
inline TriangleSoup renumbered(const TriangleSoup& soup, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Index> number(soup.vertices.size());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  TriangleSoup result;
  result.vertices.resize(soup.vertices.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    result.vertices[number[v]] = soup.vertices[v];
  }
  for (Triangle face : soup.faces) {
    std::rotate(face.begin(), face.begin() + static_cast<int>(random() % 3), face.end());
    result.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
  }
  std::shuffle(result.faces.begin(), result.faces.end(), random);
  return result;
}

/// The same point set inside out.
inline TriangleSoup reversed(TriangleSoup soup) {
  for (Triangle& face : soup.faces) std::swap(face[1], face[2]);
  return soup;
}

/// The rotation that brings `points` closest to `target`, and what is left, in the weighted mean
/// square.
inline double distanceUpToRotation(const std::vector<Eigen::Vector3d>& points,
                                   const std::vector<Eigen::Vector3d>& target,
                                   const std::vector<double>& weights) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    correlation += weights[i] * target[i] * points[i].transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double turn = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Eigen::Matrix3d best =
      svd.matrixU() * Eigen::Vector3d(1, 1, turn).asDiagonal() * svd.matrixV().transpose();
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum += weights[i] * (best * points[i] - target[i]).squaredNorm();
    total += weights[i];
  }
  return std::sqrt(sum / total);
}

/// Conformal image on the unit sphere of a point of the spheroid (1, 1, c), and the log of the
/// conformal factor there (metric of the spheroid over that of the sphere). Source: MATH 12.9.
struct SpheroidPoint {
  Eigen::Vector3d image;
  double log_factor;
};

inline SpheroidPoint spheroidImage(const Eigen::Vector3d& point, double c) {
  const double beta = std::atan2(point.z() / c, std::hypot(point.x(), point.y()));
  const double sine = std::sin(std::atan2(std::sin(beta) / c, std::cos(beta)));
  // Near the poles 1 - sine cancels: cos(phi) in closed form keeps atanh exact.
  const double cosine = std::cos(std::atan2(std::sin(beta) / c, std::cos(beta)));
  double psi = std::copysign(std::log((1 + std::abs(sine)) / cosine), sine);
  if (c < 1) {
    const double e = std::sqrt(1 - c * c);
    psi -= e * std::atanh(e * sine);
  } else {
    const double e = std::sqrt(c * c - 1);
    psi += e * std::atan(e * sine);
  }
  const double longitude = std::atan2(point.y(), point.x());
  const double across = 1 / std::cosh(psi);
  return {{across * std::cos(longitude), across * std::sin(longitude), std::tanh(psi)},
          std::log(std::cos(beta) * std::cosh(psi))};
}

}  // namespace moduli::surfaces
