#include "core/signature/surface_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/mesh/triangle_geometry.h"

namespace moduli {
namespace {

/// Faces are cut at most into this many squared.
constexpr int kMostCuts = 64;

/// Cuts a triangle into cuts^2 equal ones and hands out their centroids.
template <typename Visit>
void visitCentroids(const std::array<Eigen::Vector3d, 3>& corner, int cuts, const Visit& visit) {
  const Eigen::Vector3d u = (corner[1] - corner[0]) / cuts;
  const Eigen::Vector3d v = (corner[2] - corner[0]) / cuts;
  for (int i = 0; i < cuts; ++i) {
    for (int j = 0; i + j < cuts; ++j) {
      const Eigen::Vector3d origin = corner[0] + i * u + j * v;
      visit(origin + (u + v) / 3);
      if (i + j + 1 < cuts) visit(origin + (u + v) * (2.0 / 3));
    }
  }
}

}  // namespace

SurfacePoints surfacePoints(const TriangleMesh& mesh) {
  // The first vertex and the longest coordinate difference keep the arithmetic in range.
  const Eigen::Vector3d origin = mesh.positions().front();
  double extent = 0;
  for (const Eigen::Vector3d& p : mesh.positions()) {
    extent = std::max(extent, (p - origin).lpNorm<Eigen::Infinity>());
  }
  const auto corners = [&](Index f) {
    std::array<Eigen::Vector3d, 3> corner;
    for (Index c = 0; c < 3; ++c) {
      corner[c] = (mesh.positions()[mesh.connectivity().face(f)[c]] - origin) / extent;
    }
    return corner;
  };
  std::vector<double> face_areas(mesh.faceCount(), 0.0);
  double total = 0;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const auto corner = corners(f);
    const TriangleShape shape = triangleShape(corner[0], corner[1], corner[2]);
    if (shape.relative_area > kZeroRelativeArea) face_areas[f] = shape.area;
    total += face_areas[f];
  }
  const double unit = std::sqrt(total);
  std::vector<Eigen::Vector3d> points, normals;
  SurfacePoints result;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (!(face_areas[f] > 0)) continue;
    const auto corner = corners(f);
    const double longest = std::sqrt(
        std::max({(corner[1] - corner[0]).squaredNorm(), (corner[2] - corner[1]).squaredNorm(),
                  (corner[0] - corner[2]).squaredNorm()}));
    const int cuts =
        std::clamp(static_cast<int>(std::ceil(longest / (kPointSpacing * unit))), 1, kMostCuts);
    const Eigen::Vector3d normal =
        (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    visitCentroids(corner, cuts, [&](const Eigen::Vector3d& p) {
      points.push_back(p / unit);
      normals.push_back(normal);
      result.areas.push_back(face_areas[f] / total / (static_cast<double>(cuts) * cuts));
    });
  }
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < count; ++i) centroid += result.areas[i] * points[i];
  result.points.resize(3, count);
  result.normals.resize(3, count);
  double spread = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    result.points.col(i) = points[i] - centroid;
    result.normals.col(i) = normals[i];
    spread += result.areas[i] * result.points.col(i).squaredNorm();
  }
  result.radius = std::sqrt(spread);
  result.unit = unit * extent;
  return result;
}

}  // namespace moduli
