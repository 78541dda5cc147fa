#include "tests/bench/retrieval/deform.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace moduli {
namespace {

using Eigen::Vector3d;

// Box and Muller.
double gaussian(SampleRandom& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
  return radius * std::cos(2 * std::numbers::pi * random.uniform());
}

Vector3d randomDirection(SampleRandom& random) {
  for (;;) {
    const Vector3d p = random.inBall();
    if (p.norm() > 0.1) return p.normalized();
  }
}

std::vector<Index> shuffledNumbers(std::size_t count, SampleRandom& random) {
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.next() % i]);
  return order;
}

Vector3d meanOf(const std::vector<Vector3d>& points) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

double boundingDiagonal(const TriangleSoup& soup) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : soup.vertices) box.extend(p);
  return box.diagonal().norm();
}

TriangleSoup movedAndRenumbered(const TriangleSoup& soup, SampleRandom& random) {
  const Vector3d axis = randomDirection(random);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2 * std::numbers::pi * random.uniform(), axis).toRotationMatrix();
  const double scale = std::pow(4.0, 2 * random.uniform() - 1);
  const Vector3d shift = boundingDiagonal(soup) * random.inBall();
  const std::vector<Index> number = shuffledNumbers(soup.vertices.size(), random);
  const std::vector<Index> order = shuffledNumbers(soup.faces.size(), random);
  TriangleSoup result;
  result.vertices.resize(soup.vertices.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    result.vertices[number[v]] = scale * (turn * soup.vertices[v] + shift);
  }
  for (const Index f : order) {
    Triangle t = soup.faces[f];
    for (Index& v : t) v = number[v];
    std::rotate(t.begin(), t.begin() + random.next() % 3, t.end());
    result.faces.push_back(t);
  }
  return result;
}

TriangleSoup withNoise(const TriangleSoup& soup, double deviation, SampleRandom& random) {
  TriangleSoup result = soup;
  for (Vector3d& p : result.vertices) {
    for (int i = 0; i < 3; ++i) p[i] += deviation * gaussian(random);
  }
  return result;
}

TriangleSoup bent(const TriangleSoup& soup, double angle, double strain, SampleRandom& random) {
  const Vector3d centre = meanOf(soup.vertices);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : soup.vertices) moments += (p - centre) * (p - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  const Vector3d along = solver.eigenvectors().col(2);
  const Vector3d side = along.cross(randomDirection(random)).normalized();
  const Vector3d axis = along.cross(side);
  double length = 0, thickness = 0;
  for (const Vector3d& p : soup.vertices) {
    length = std::max(length, 2 * std::abs(along.dot(p - centre)));
    thickness = std::max(thickness, std::abs(side.dot(p - centre)));
  }
  // A fibre at height y over the neutral one gets longer by the share curvature * y.
  const double curvature = std::min(angle / length, strain / thickness);
  TriangleSoup result = soup;
  for (Vector3d& p : result.vertices) {
    const Vector3d q = p - centre;
    const double turn = curvature * along.dot(q), radius = 1 / curvature - side.dot(q);
    p = centre + radius * std::sin(turn) * along +
        (1 / curvature - radius * std::cos(turn)) * side + axis.dot(q) * axis;
  }
  return result;
}

TriangleSoup bulged(const TriangleSoup& soup, double height, double deviation,
                    SampleRandom& random) {
  const auto top = static_cast<Index>(random.next() % soup.vertices.size());
  Vector3d normal = Vector3d::Zero();
  for (const Triangle& t : soup.faces) {
    if (t[0] != top && t[1] != top && t[2] != top) continue;
    normal += (soup.vertices[t[1]] - soup.vertices[t[0]])
                  .cross(soup.vertices[t[2]] - soup.vertices[t[0]]);
  }
  const Vector3d centre = soup.vertices[top];
  TriangleSoup result = soup;
  for (Vector3d& p : result.vertices) {
    const double r = (p - centre).norm() / deviation;
    p += height * std::exp(-r * r / 2) * normal.normalized();
  }
  return result;
}

TriangleSoup inverted(const TriangleSoup& soup, double gap, SampleRandom& random) {
  const Vector3d middle = meanOf(soup.vertices);
  double radius = 0;
  for (const Vector3d& p : soup.vertices) radius = std::max(radius, (p - middle).norm());
  const Vector3d direction = randomDirection(random);
  const Vector3d centre = middle + (1 + gap) * radius * direction;
  TriangleSoup result = soup;
  for (Vector3d& p : result.vertices) {
    const Vector3d q = (p - centre) / radius;
    p = q / q.squaredNorm();
    p -= 2 * direction.dot(p) * direction;
  }
  return result;
}

}  // namespace moduli
