#include "core/mesh/double_cover.h"

#include <utility>
#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Connectivity connect(const TriangleSoup& soup) {
  auto surface = Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), soup.faces);
  EXPECT_OK(surface);
  return *std::move(surface);
}

void expectMirror(const Connectivity& surface, const DoubleCover& cover) {
  const Connectivity& doubled = cover.connectivity;
  ASSERT_EQ(doubled.faceCount(), 2 * surface.faceCount());
  ASSERT_EQ(cover.face_count, surface.faceCount());
  const auto sigma = [&](Index v) { return cover.involution[v]; };
  for (Index v = 0; v < doubled.vertexCount(); ++v) {
    EXPECT_EQ(sigma(sigma(v)), v);
    EXPECT_FALSE(doubled.isBoundaryVertex(v));
    const bool on_seam = v < surface.vertexCount() && surface.isBoundaryVertex(v);
    EXPECT_EQ(sigma(v) == v, on_seam);
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    EXPECT_EQ(doubled.face(f), surface.face(f));
    const Triangle& face = surface.face(f);
    const Triangle reversed = {sigma(face[0]), sigma(face[2]), sigma(face[1])};
    EXPECT_EQ(doubled.face(f + cover.face_count), reversed);
  }
  for (Index e = 0; e < doubled.edgeCount(); ++e) {
    const Index original = surface.halfedge(cover.edge[e]);
    const Index h = doubled.halfedge(e);
    const auto down = [&](Index v) { return v < surface.vertexCount() ? v : sigma(v); };
    const std::pair ends(down(doubled.tail(h)), down(doubled.head(h)));
    const std::pair forward(surface.tail(original), surface.head(original));
    const std::pair backward(forward.second, forward.first);
    EXPECT_TRUE(ends == forward || ends == backward);
  }
}

TEST(DoubleCover, DiskAnnulusAndPantsBecomeGenusZeroOneTwo) {
  const std::vector<TriangleSoup> bordered = {shapes::disk(), shapes::annulus(), shapes::pants()};
  for (std::size_t genus = 0; genus < bordered.size(); ++genus) {
    const Connectivity surface = connect(bordered[genus]);
    const auto cover = doubleCover(surface);
    ASSERT_OK(cover);
    EXPECT_EQ(cover->connectivity.eulerCharacteristic(), 2 - 2 * static_cast<Index>(genus));
    expectMirror(surface, *cover);
  }
}

TEST(DoubleCover, PuncturedTorusBecomesGenusTwo) {
  TriangleSoup soup = shapes::torusGrid(5, 5);
  soup.faces.pop_back();
  const Connectivity surface = connect(soup);
  const auto cover = doubleCover(surface);
  ASSERT_OK(cover);
  EXPECT_EQ(cover->connectivity.eulerCharacteristic(), -2);
  expectMirror(surface, *cover);
}

TEST(DoubleCover, ChordBetweenBoundaryVerticesIsDoubled) {
  // A square cut by a diagonal: five edges, of which the diagonal alone has two images.
  const Connectivity surface =
      connect({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  const auto cover = doubleCover(surface);
  ASSERT_OK(cover);
  EXPECT_EQ(cover->connectivity.vertexCount(), 4);
  EXPECT_EQ(cover->connectivity.edgeCount(), 6);
  expectMirror(surface, *cover);
}

TEST(DoubleCover, SingleTriangleBecomesAPillow) {
  const Connectivity surface = connect({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  const auto cover = doubleCover(surface);
  ASSERT_OK(cover);
  EXPECT_EQ(cover->connectivity.eulerCharacteristic(), 2);
  EXPECT_EQ(cover->connectivity.edgeCount(), 3);
  expectMirror(surface, *cover);
}

TEST(DoubleCover, ClosedSurfaceHasNone) {
  EXPECT_THAT(doubleCover(connect(shapes::tetrahedron())), FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
