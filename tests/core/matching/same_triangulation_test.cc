#include "core/matching/same_triangulation.h"

#include <algorithm>

#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Numberings = std::vector<std::vector<Index>>;

Numberings numberings(const TriangleSoup& a, const TriangleSoup& b, bool mirror = false) {
  Context context;
  const TriangleMesh x = *TriangleMesh::fromSoup(a), y = *TriangleMesh::fromSoup(b);
  auto result = sameTriangulations(context, x.connectivity(), y.connectivity(), mirror);
  EXPECT_OK(result);
  return *std::move(result);
}

// Irregular ones, closed and bordered.
const std::vector<std::pair<std::string, std::map<std::string, double>>> kIrregular = {
    {"torus", {{"R", 2}, {"r", 1}, {"resolution", 8}, {"seed", 2}}},
    {"genus", {{"resolution", 4}, {"seed", 3}}},
    {"annulus", {{"resolution", 6}, {"seed", 4}}}};

TEST(SameTriangulation, FindsTheRenumberingOfIrregularSurfaces) {
  for (const auto& [kind, parameters] : kIrregular) {
    const TriangleSoup soup = *makeSample(kind, parameters);
    const Renumbered other = renumbered(soup, 7);
    EXPECT_EQ(numberings(soup, other.soup), Numberings{other.image}) << kind;
  }
}

TEST(SameTriangulation, KnowsAMirrorImage) {
  for (const auto& [kind, parameters] : kIrregular) {
    const TriangleSoup soup = *makeSample(kind, parameters);
    const Renumbered other = renumbered(mirrored(soup), 8);
    EXPECT_EQ(numberings(soup, other.soup, true), Numberings{other.image}) << kind;
    EXPECT_EQ(numberings(soup, other.soup, false), Numberings()) << kind;
    EXPECT_EQ(numberings(soup, soup, true), Numberings()) << kind;
  }
}

TEST(SameTriangulation, SeesOneFlippedEdge) {
  const TriangleSoup soup =
      *makeSample("torus", {{"R", 2}, {"r", 1}, {"resolution", 6}, {"seed", 1}});
  const TriangleMesh mesh = *TriangleMesh::fromSoup(soup);
  const Connectivity& surface = mesh.connectivity();
  const Index h = surface.halfedge(40), t = surface.twin(h);
  const Index a = surface.tail(h), b = surface.head(h);
  const Index c = surface.tail(surface.previous(h)), d = surface.tail(surface.previous(t));
  TriangleSoup flipped = soup;
  flipped.faces[h / 3] = {c, a, d};
  flipped.faces[t / 3] = {d, b, c};
  ASSERT_OK(TriangleMesh::fromSoup(flipped));
  EXPECT_EQ(numberings(soup, flipped), Numberings());
}

TEST(SameTriangulation, ListsTheSymmetriesOfAnIcosahedron) {
  // 60 rotations; in a mirror 60 more.
  const TriangleSoup sphere = *makeSample("sphere", {{"resolution", 4}});
  const Renumbered other = renumbered(sphere, 2);
  const Numberings found = numberings(sphere, other.soup);
  EXPECT_EQ(found.size(), 60U);
  EXPECT_EQ(std::count(found.begin(), found.end(), other.image), 1);
  EXPECT_EQ(numberings(sphere, other.soup, true).size(), 60U);
}

TEST(SameTriangulation, GivesUpOnRegularGrids) {
  const TriangleSoup torus = *makeSample("torus", {{"R", 2}, {"r", 1}, {"resolution", 8}});
  EXPECT_EQ(numberings(torus, torus), Numberings());
}

TEST(SameTriangulation, TellsOtherSizesApart) {
  const TriangleSoup a = *makeSample("torus", {{"R", 2}, {"r", 1}, {"resolution", 8}, {"seed", 1}});
  const TriangleSoup b = *makeSample("torus", {{"R", 2}, {"r", 1}, {"resolution", 9}, {"seed", 1}});
  const TriangleSoup c = *makeSample("torus", {{"R", 2}, {"r", 1}, {"resolution", 8}, {"seed", 2}});
  EXPECT_EQ(numberings(a, b), Numberings());
  EXPECT_EQ(numberings(a, c), Numberings());
}

TEST(SameTriangulation, HoldsForAScanInTwoNumberings) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/alec__homer.obj");
  Context context;
  const TriangleSoup soup = *readMeshFile(context, path);
  const Renumbered other = renumbered(moved(soup), 3);
  EXPECT_EQ(numberings(soup, other.soup), Numberings{other.image});
}

TEST(SameTriangulation, HoldsForOneTemplateInTwoShapes) {
  MODULI_NEED_SHARED_MESH(pial, "brain/nilearn__pial_left.ply");
  MODULI_NEED_SHARED_MESH(inflated, "brain/nilearn__infl_left.ply");
  Context context;
  const Renumbered other = renumbered(*readMeshFile(context, inflated), 3);
  // A subdivided icosahedron.
  const Numberings found = numberings(*readMeshFile(context, pial), other.soup);
  EXPECT_EQ(found.size(), 60U);
  EXPECT_EQ(std::count(found.begin(), found.end(), other.image), 1);
}

TEST(SameTriangulation, StopsWhenCancelled) {
  const TriangleMesh mesh =
      *TriangleMesh::fromSoup(*makeSample("sphere", {{"resolution", 4}, {"seed", 1}}));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(sameTriangulations(context, mesh.connectivity(), mesh.connectivity()),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
