#include <algorithm>
#include <random>

#include "core/mesh/inspect.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/repair.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

/// Truths about any soup at all, tried on damaged surfaces and on random triangles.
namespace moduli {
namespace {

Inspection inspect(const TriangleSoup& soup) {
  Context context;
  auto inspection = inspectSoup(context, soup);
  EXPECT_OK(inspection);
  return *std::move(inspection);
}

bool has(const Inspection& inspection, DefectKind kind) {
  return std::any_of(inspection.defects.begin(), inspection.defects.end(),
                     [&](const Defect& defect) { return defect.kind == kind; });
}

TriangleSoup withoutIsolated(const TriangleSoup& soup) {
  TriangleSoup kept;
  std::vector<Index> number(soup.vertices.size(), kNone);
  for (Triangle face : soup.faces) {
    for (Index& v : face) {
      if (number[v] == kNone) {
        number[v] = static_cast<Index>(kept.vertices.size());
        kept.vertices.push_back(soup.vertices[v]);
      }
      v = number[v];
    }
    kept.faces.push_back(face);
  }
  return kept;
}

// Two faces back to back are a closed surface, but a duplicate all the same.
void expectVerdictAgreesWithMesh(const TriangleSoup& soup) {
  const Inspection inspection = inspect(soup);
  const bool is_mesh = TriangleMesh::fromSoup(withoutIsolated(soup)).ok();
  EXPECT_EQ(inspection.valid, is_mesh && !has(inspection, DefectKind::kDuplicateFace));
}

void expectRepairKeepsItsWord(const TriangleSoup& soup) {
  Context context;
  const auto once = repairSoup(context, soup, {true, {}});
  ASSERT_OK(once);
  const Inspection before = inspect(soup);
  const Inspection after = inspect(once->soup);
  expectVerdictAgreesWithMesh(once->soup);
  // Only what has no repair is left.
  for (const Defect& defect : after.defects) {
    if (!isBlocking(defect.kind) || defect.kind == DefectKind::kEmpty) continue;
    EXPECT_TRUE(has(after, DefectKind::kNonManifoldEdge) || has(after, DefectKind::kNonOrientable));
  }
  EXPECT_FALSE(has(after, DefectKind::kDegenerateFace));
  EXPECT_FALSE(has(after, DefectKind::kDuplicateFace));
  EXPECT_FALSE(has(after, DefectKind::kNonManifoldVertex));
  EXPECT_FALSE(has(after, DefectKind::kIsolatedVertex));
  // Welding makes nothing worse.
  if (has(after, DefectKind::kNonManifoldEdge)) {
    EXPECT_TRUE(has(before, DefectKind::kNonManifoldEdge));
  }
  ASSERT_EQ(once->input_vertex.size(), once->soup.vertices.size());
  ASSERT_EQ(once->input_face.size(), once->soup.faces.size());
  for (std::size_t v = 0; v < once->input_vertex.size(); ++v) {
    EXPECT_EQ(once->soup.vertices[v], soup.vertices[once->input_vertex[v]]);
  }
  for (std::size_t f = 0; f < once->input_face.size(); ++f) {
    for (const Index v : once->soup.faces[f]) {
      const Triangle& original = soup.faces[once->input_face[f]];
      EXPECT_TRUE(std::any_of(original.begin(), original.end(),
                              [&](Index w) { return soup.vertices[w] == once->soup.vertices[v]; }));
    }
  }
  const auto filled = repairSoup(context, soup, {true, 1e6});
  ASSERT_OK(filled);
  EXPECT_EQ(inspect(filled->soup).valid, after.valid);
  if (after.valid) {
    // No loop is short against a component without area.
    if (!has(after, DefectKind::kZeroAreaFace)) {
      EXPECT_EQ(inspect(filled->soup).counts.boundary_loops, 0);
    }
    EXPECT_EQ(inspect(filled->soup).counts.genus, after.counts.genus);
  }
  const auto prepared = prepareMesh(context, soup, {{true, {}}, "largest"});
  EXPECT_EQ(prepared.ok(), after.valid);
}

TEST(AnySoup, DamagedSurfacesAreJudgedAsTheyAre) {
  std::mt19937 random(2024);
  const std::vector<TriangleSoup> sources = {shapes::icosahedron(), shapes::torusGrid(5, 4),
                                             shapes::chainOfTori(2)};
  for (int trial = 0; trial < 600; ++trial) {
    TriangleSoup soup = sources[random() % sources.size()];
    std::shuffle(soup.faces.begin(), soup.faces.end(), random);
    soup.faces.resize(1 + random() % soup.faces.size());
    for (Triangle& face : soup.faces) {
      const auto fate = random() % 40;
      if (fate == 0) std::swap(face[0], face[1]);
      if (fate == 1 && trial % 3 == 0) face[2] = face[1];
      if (fate == 2 && trial % 3 == 1)
        face[0] = static_cast<Index>(random() % soup.vertices.size());
      if (fate == 3 && trial % 3 == 2) face = soup.faces[random() % soup.faces.size()];
    }
    for (int k = static_cast<int>(random() % 4); k > 0; --k) {
      soup.vertices[random() % soup.vertices.size()] =
          Eigen::Vector3d(soup.vertices[random() % soup.vertices.size()]);
    }
    SCOPED_TRACE(trial);
    expectVerdictAgreesWithMesh(soup);
    expectRepairKeepsItsWord(soup);
  }
}

TEST(AnySoup, RandomTrianglesOnFewPoints) {
  std::mt19937 random(77);
  for (int trial = 0; trial < 3000; ++trial) {
    TriangleSoup soup;
    const int points = 3 + static_cast<int>(random() % 8);
    for (int v = 0; v < points; ++v) {
      soup.vertices.emplace_back(random() % 3, random() % 3, random() % 2);
    }
    const int faces = static_cast<int>(random() % 12);
    for (int f = 0; f < faces; ++f) {
      Triangle face;
      for (Index& v : face) v = static_cast<Index>(random() % points);
      soup.faces.push_back(face);
    }
    SCOPED_TRACE(trial);
    expectVerdictAgreesWithMesh(soup);
    expectRepairKeepsItsWord(soup);
  }
}

TEST(AnySoup, PathologicalShapes) {
  TriangleSoup flat = shapes::icosahedron();
  for (auto& p : flat.vertices) p.setZero();
  const TriangleSoup mixed = shapes::together(shapes::icosahedron(), shapes::moebiusStrip(5));
  const TriangleSoup pillow = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 1, 0}}};
  const TriangleSoup line = {{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}, {0, 0, 0}}};
  for (const TriangleSoup& soup :
       {TriangleSoup{}, TriangleSoup{{{1, 2, 3}}, {}}, flat, mixed, pillow, line, shapes::bowTie(),
        shapes::threeAtAnEdge(), shapes::moebiusStrip(3),
        shapes::together(shapes::bowTie(), shapes::threeAtAnEdge())}) {
    expectVerdictAgreesWithMesh(soup);
    expectRepairKeepsItsWord(soup);
  }
}

TEST(AnySoup, PathologicalFiles) {
  if (sharedMeshes("bad").empty()) {
    GTEST_SKIP() << "needs the shared meshes; set MODULI_SHARED to the folder with meshes/";
  }
  for (const std::string& path : sharedMeshes("bad")) {
    SCOPED_TRACE(path);
    Context context;
    const auto soup = readMeshFile(context, path);
    if (!soup.ok()) continue;
    expectVerdictAgreesWithMesh(*soup);
    expectRepairKeepsItsWord(*soup);
  }
}

TEST(AnySoup, UnweldedSurfacesComeTogether) {
  std::mt19937 random(13);
  for (int trial = 0; trial < 100; ++trial) {
    const TriangleSoup whole = shapes::torusGrid(4, 5);
    TriangleSoup soup;
    for (const Triangle& face : whole.faces) {
      Triangle own;
      for (int c = 0; c < 3; ++c) {
        own[c] = static_cast<Index>(soup.vertices.size());
        soup.vertices.push_back(whole.vertices[face[c]]);
      }
      if (random() % 2 == 0) std::swap(own[0], own[1]);
      soup.faces.push_back(own);
    }
    Context context;
    const auto repaired = repairSoup(context, soup, {true, {}});
    ASSERT_OK(repaired);
    const Inspection inspection = inspect(repaired->soup);
    EXPECT_TRUE(inspection.valid);
    EXPECT_EQ(inspection.counts.genus, 1);
    EXPECT_EQ(inspection.counts.vertices, 20);
  }
}

}  // namespace
}  // namespace moduli
