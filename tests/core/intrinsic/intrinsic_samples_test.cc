#include "core/intrinsic/intrinsic_samples.h"

#include <cmath>
#include <numbers>

#include "tests/core/testing.h"

namespace moduli {
namespace {

struct Expectation {
  const char* kind;
  Index vertices, faces, genus;
  int around_vertex;
};

TEST(IntrinsicSamples, AreSmoothHyperbolicSurfacesOfTheirGenus) {
  for (const auto& [kind, vertices, faces, genus, around] :
       {Expectation{"bolza", 6, 16, 2, 8}, Expectation{"klein", 24, 56, 3, 7}}) {
    SCOPED_TRACE(kind);
    const auto surface = makeIntrinsicSample(kind);
    ASSERT_OK(surface);
    const Connectivity& c = surface->connectivity;
    EXPECT_EQ(c.vertexCount(), vertices);
    EXPECT_EQ(c.faceCount(), faces);
    EXPECT_EQ(c.eulerCharacteristic(), 2 - 2 * genus);
    std::vector<int> degree(vertices, 0);
    std::vector<double> turn(vertices, 0.0);
    for (Index f = 0; f < faces; ++f) {
      const TriangleValues angles = triangleAngles(surface->geometry, surface->sides(f));
      for (Index i = 0; i < 3; ++i) {
        ++degree[c.face(f)[i]];
        turn[c.face(f)[i]] += angles[i];
      }
    }
    for (Index v = 0; v < vertices; ++v) {
      EXPECT_EQ(degree[v], around);
      EXPECT_NEAR(turn[v], 2 * std::numbers::pi, 1e-13);
    }
    EXPECT_NEAR(surfaceArea(*surface), 4 * std::numbers::pi * (genus - 1), 1e-12);
  }
}

TEST(IntrinsicSamples, KleinsTriangulationHasNoDoubleEdges) {
  const auto surface = makeIntrinsicSample("klein");
  ASSERT_OK(surface);
  EXPECT_OK(Connectivity::fromFaces(24, surface->connectivity.faces()));
}

TEST(IntrinsicSamples, OtherKindsAreRefused) {
  EXPECT_THAT(makeIntrinsicSample("torus"), FailsWith(Reason::kInvalidOption));
}

TEST(IntrinsicSamples, InspectionOfOneIsClean) {
  const auto surface = makeIntrinsicSample("bolza");
  ASSERT_OK(surface);
  const Inspection inspection = inspectSurface(*surface);
  EXPECT_TRUE(inspection.valid);
  EXPECT_TRUE(inspection.defects.empty());
  EXPECT_EQ(inspection.counts.genus, 2);
  EXPECT_EQ(inspection.counts.components, 1);
  EXPECT_NEAR(inspection.counts.area, 4 * std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace moduli
