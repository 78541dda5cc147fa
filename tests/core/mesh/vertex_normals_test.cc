#include "core/mesh/vertex_normals.h"

#include <cmath>
#include <cstdio>

#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> normalsOf(const TriangleSoup& soup) {
  const TriangleMesh mesh = *TriangleMesh::fromSoup(soup);
  return vertexNormals(mesh.connectivity(), mesh.positions());
}

// Three right angles meet there, whichever diagonals cut the squares: one or two faces a square.
TEST(VertexNormals, OfACubeGoAlongItsDiagonals) {
  TriangleSoup cube;
  for (int i = 0; i < 8; ++i) cube.vertices.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  cube.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const std::vector<Vector3d> normals = normalsOf(cube);
  for (int i = 0; i < 8; ++i) {
    const Vector3d out = (cube.vertices[i] - Vector3d::Constant(0.5)).normalized();
    EXPECT_LT((normals[i] - out).norm(), 1e-15) << i;
  }
}

// The normals of faces of an irregular mesh are off by half an edge, in all directions: of halves
// as long, their means are off by half as much.
TEST(VertexNormals, OfASphereConverge) {
  double before = 0;
  for (const int resolution : {8, 16, 32}) {
    const TriangleSoup sphere = *makeSample("sphere", {{"resolution", resolution}, {"seed", 3}});
    const std::vector<Vector3d> normals = normalsOf(sphere);
    double sum = 0;
    for (std::size_t v = 0; v < normals.size(); ++v) {
      sum += (normals[v] - sphere.vertices[v].normalized()).squaredNorm();
    }
    const double error = std::sqrt(sum / static_cast<double>(normals.size()));
    std::printf("resolution %d: %.5f\n", resolution, error);
    if (before > 0) {
      EXPECT_LT(error, before / 1.8);
    }
    before = error;
  }
}

TEST(VertexNormals, TurnWithTheSurface) {
  const TriangleSoup torus = *makeSample("torus", {{"resolution", 8}, {"seed", 5}});
  TriangleSoup turned = torus;
  // A quarter turn about the axis of z, another size and place.
  for (Vector3d& p : turned.vertices) p = Vector3d(-3 * p.y(), 3 * p.x(), 3 * p.z() + 10);
  const std::vector<Vector3d> before = normalsOf(torus), after = normalsOf(turned);
  for (std::size_t v = 0; v < before.size(); ++v) {
    const Vector3d wanted(-before[v].y(), before[v].x(), before[v].z());
    EXPECT_LT((after[v] - wanted).norm(), 1e-12);
  }
}

TEST(VertexNormals, AreZeroWhereNothingHasAnArea) {
  TriangleSoup flat;
  flat.vertices.assign(3, Vector3d(1, 2, 3));
  flat.faces = {{0, 1, 2}};
  for (const Vector3d& normal : normalsOf(flat)) EXPECT_EQ(normal, Vector3d::Zero());
}

}  // namespace
}  // namespace moduli
