#include "core/intrinsic/angles.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Connectivity oneTriangle() {
  return *Connectivity::fromFaces(3, {{0, 1, 2}});
}

TEST(CornerAngles, OfARightTriangle) {
  const Connectivity surface = oneTriangle();
  std::vector<double> lengths(3);
  lengths[surface.edge(0)] = 3;
  lengths[surface.edge(1)] = 4;
  lengths[surface.edge(2)] = 5;
  const auto angles = cornerAngles(surface, lengths);
  EXPECT_NEAR(angles[0], std::atan2(4, 3), 1e-15);
  EXPECT_NEAR(angles[1], std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(angles[2], std::atan2(3, 4), 1e-15);
}

TEST(CornerAngles, KeepTheirRelativePrecisionInNeedles) {
  // Isosceles with sides 1 and base b: the angle at the tip is 2 asin(b / 2).
  const Connectivity surface = oneTriangle();
  for (const double base : {1e-3, 1e-6, 1e-9}) {
    std::vector<double> lengths(3, 1.0);
    lengths[surface.edge(1)] = base;
    const double angle = cornerAngles(surface, lengths)[0];
    EXPECT_NEAR(angle / (2 * std::asin(base / 2)), 1, 1e-14);
  }
}

// CHECKS A7. An angle carries an error of some units of 2^-53 times pi, and three of them meet in a
// face, so 1e-12 a vertex leaves a factor of more than a hundred.
void expectGaussBonnet(const TriangleMesh& mesh, const std::string& name) {
  const auto metric = mollify(mesh.connectivity(), mesh.edgeLengths());
  ASSERT_OK(metric);
  const auto curvatures = vertexCurvatures(mesh.connectivity(), metric->lengths);
  const double sum = std::accumulate(curvatures.begin(), curvatures.end(), 0.0);
  EXPECT_NEAR(sum, 2 * std::numbers::pi * mesh.connectivity().eulerCharacteristic(),
              1e-12 * mesh.vertexCount())
      << name;
}

TEST(VertexCurvatures, AddUpToTwoPiTimesTheEulerCharacteristicOnSamples) {
  for (const SampleKind& kind : sampleKinds()) {
    const auto soup = makeSample(kind.name, {});
    ASSERT_OK(soup);
    const auto mesh = TriangleMesh::fromSoup(*soup);
    ASSERT_OK(mesh);
    expectGaussBonnet(*mesh, kind.name);
  }
}

TEST(VertexCurvatures, AddUpToTwoPiTimesTheEulerCharacteristicOnRealMeshes) {
  int meshes = 0;
  for (const std::string folder :
       {"closed_g0", "genus1", "genus2", "genus3plus", "disk", "multi_boundary", "brain"}) {
    for (const std::string& path : sharedMeshes(folder)) {
      Context context;
      const auto soup = readMeshFile(context, path);
      ASSERT_OK(soup);
      const auto prepared = prepareMesh(context, *soup, {});
      ASSERT_OK(prepared);
      expectGaussBonnet(prepared->mesh, path);
      ++meshes;
    }
  }
  if (meshes == 0) GTEST_SKIP() << "needs the shared meshes; set MODULI_SHARED to their folder";
}

TEST(VertexCurvatures, OfAFlatPolyhedralTorusAreZero) {
  const auto mesh = TriangleMesh::fromSoup(*makeSample("diplotorus", {{"resolution", 3}}));
  ASSERT_OK(mesh);
  for (const double k : vertexCurvatures(mesh->connectivity(), mesh->edgeLengths())) {
    EXPECT_NEAR(k, 0, 1e-13);
  }
}

}  // namespace
}  // namespace moduli
