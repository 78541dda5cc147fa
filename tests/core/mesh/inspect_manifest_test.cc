#include <set>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/inspect.h"
#include "core/mesh/read.h"
#include "core/mesh/repair.h"
#include "tests/core/mesh/manifest.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using manifest::Row;

Index countOf(const Inspection& inspection, DefectKind kind) {
  for (const Defect& defect : inspection.defects) {
    if (defect.kind == kind) return defect.count;
  }
  return 0;
}

bool isStl(const Row& row) {
  return row.text("file").ends_with(".stl");
}

// The manifest counts components before pinched vertices are split: faces that share a vertex.
Index componentsThroughVertices(const TriangleSoup& soup) {
  DisjointSets joined(static_cast<Index>(soup.vertices.size()));
  std::set<Index> roots;
  for (const Triangle& face : soup.faces) {
    joined.join(face[0], face[1]);
    joined.join(face[1], face[2]);
  }
  for (const Triangle& face : soup.faces) roots.insert(joined.root(face[0]));
  return static_cast<Index>(roots.size());
}

void expectCounts(const Row& row, const TriangleSoup& soup, const Inspection& inspection) {
  const SurfaceCounts& counts = inspection.counts;
  // The reader welds STL, so its numbers are those of the column `welded`.
  const auto expected = [&](const std::string& column) {
    return isStl(row) && !row.text("welded").empty() ? row.welded(column) : row.number(column);
  };
  EXPECT_EQ(counts.faces, row.number("F"));
  EXPECT_EQ(counts.vertices, expected("V"));
  EXPECT_EQ(componentsThroughVertices(soup), expected("components"));
  EXPECT_EQ(countOf(inspection, DefectKind::kNonManifoldEdge) == 0, row.isTrue("edge_manifold"));
  EXPECT_EQ(countOf(inspection, DefectKind::kIsolatedVertex), row.number("unreferenced_vertices"));
  EXPECT_EQ(countOf(inspection, DefectKind::kDuplicateVertex),
            isStl(row) ? 0 : row.number("duplicate_coord_vertices"));
  EXPECT_EQ(countOf(inspection, DefectKind::kDegenerateFace) +
                countOf(inspection, DefectKind::kZeroAreaFace),
            row.number("degenerate_faces"));
  if (!row.isTrue("edge_manifold")) {
    EXPECT_FALSE(inspection.valid);
    EXPECT_EQ(counts.genus, std::nullopt);
    return;
  }
  const bool pinched = countOf(inspection, DefectKind::kNonManifoldVertex) > 0;
  EXPECT_EQ(!pinched, row.isTrue("vertex_manifold"));
  EXPECT_EQ(countOf(inspection, DefectKind::kInconsistentOrientation) == 0,
            row.isTrue("orientation_ok"));
  EXPECT_EQ(counts.orientable, row.isTrue("orientable"));
  EXPECT_EQ(countOf(inspection, DefectKind::kNonOrientable) == 0, row.isTrue("orientable"));
  EXPECT_EQ(counts.boundary_loops, expected("boundary_loops"));
  EXPECT_EQ(counts.genus, expected("genus"));
  EXPECT_EQ(inspection.valid, row.isTrue("vertex_manifold") && row.isTrue("orientation_ok"));
  if (!pinched) {
    EXPECT_EQ(counts.components, expected("components"));
  }
}

TEST(InspectManifest, EveryRealMeshIsWhatItsRowSays) {
  MODULI_NEED_SHARED_MESH(path, "MANIFEST.csv");
  int inspected = 0;
  for (const Row& row : manifest::read(path)) {
    SCOPED_TRACE(row.text("file"));
    const auto file = sharedMesh(row.text("file"));
    if (!file) continue;
    Context context;
    const auto soup = readMeshFile(context, *file);
    EXPECT_EQ(soup.ok(), row.number("V").has_value());
    if (!soup.ok()) continue;
    const auto inspection = inspectSoup(context, *soup);
    ASSERT_OK(inspection);
    expectCounts(row, *soup, *inspection);
    ++inspected;
  }
  EXPECT_GT(inspected, 0);
}

TEST(InspectManifest, RepairReachesTheWeldedSurface) {
  MODULI_NEED_SHARED_MESH(path, "MANIFEST.csv");
  for (const Row& row : manifest::read(path)) {
    const auto file = sharedMesh(row.text("file"));
    if (!file || row.text("welded").empty()) continue;
    SCOPED_TRACE(row.text("file"));
    Context context;
    const auto soup = readMeshFile(context, *file);
    ASSERT_OK(soup);
    const auto repaired = repairSoup(context, *soup, {true, {}});
    ASSERT_OK(repaired);
    const auto inspection = inspectSoup(context, repaired->soup);
    ASSERT_OK(inspection);
    const bool manifold = row.text("welded").find("\"edge_manifold\": true") != std::string::npos;
    EXPECT_EQ(inspection->valid, manifold);
    if (!manifold) continue;
    EXPECT_EQ(inspection->counts.boundary_loops, row.welded("boundary_loops"));
    EXPECT_EQ(inspection->counts.genus, row.welded("genus"));
    // A vertex that is pinched once welded stays apart, as a duplicate.
    EXPECT_EQ(inspection->counts.vertices - countOf(*inspection, DefectKind::kDuplicateVertex),
              row.welded("V"));
  }
}

struct Verdict {
  const char* file;
  std::vector<DefectKind> before;  // Blocking kinds.
  std::vector<DefectKind> after;   // Blocking kinds after repair.
};

std::vector<DefectKind> blockingKinds(const Inspection& inspection) {
  std::vector<DefectKind> kinds;
  for (const Defect& defect : inspection.defects) {
    if (isBlocking(defect.kind)) kinds.push_back(defect.kind);
  }
  return kinds;
}

TEST(InspectManifest, BadMeshesAreMendedOrKeepTheirDefect) {
  using enum DefectKind;
  const std::vector<Verdict> table = {
      {"alec__beetle.obj", {kNonManifoldEdge}, {kNonManifoldEdge}},
      {"alec__cow.obj", {kNonManifoldVertex}, {}},
      {"alec__suzanne.obj", {kDuplicateFace, kNonManifoldEdge}, {kNonManifoldEdge}},
      {"alec__teapot.obj", {kNonManifoldVertex}, {}},
      {"bff__inverted_triangles.obj", {kInconsistentOrientation}, {}},
      {"bff__triple_vierbein.obj",
       {kNonManifoldEdge, kInconsistentOrientation},
       {kNonManifoldEdge}},
      {"cfwen__eight.open.off", {}, {}},
      {"geomcentral__fan3.obj", {kNonManifoldEdge}, {kNonManifoldEdge}},
      {"geomcentral__hourglass_ico.obj", {kNonManifoldVertex}, {}},
      {"geomcentral__moebius.obj",
       {kNonOrientable, kInconsistentOrientation},
       {kNonOrientable, kInconsistentOrientation}},
      {"geomcentral__platonic_shelf.obj", {}, {}},
      {"geomcentral__stl_box_ascii.stl", {}, {}},
      {"geomcentral__stl_box_binary.stl", {}, {}},
      {"gpeyre__hypersheet.off", {}, {}},
      {"libigl-data__truck.obj",
       {kNonManifoldEdge, kInconsistentOrientation, kNonManifoldVertex},
       {kNonManifoldEdge}},
      {"trimesh__capsule.obj", {}, {}},
      {"trimesh__comments.off", {}, {}},
      {"trimesh__joined_tetrahedra.obj", {kDuplicateFace, kNonManifoldEdge}, {kNonManifoldEdge}},
      {"trimesh__nancolor.obj", {}, {}},
      {"trimesh__negative_indices.obj", {}, {}},
      {"trimesh__soup.stl", {}, {}},
  };
  if (!sharedMesh("MANIFEST.csv")) {
    GTEST_SKIP() << "needs the shared meshes; set MODULI_SHARED to the folder with meshes/";
  }
  for (const Verdict& verdict : table) {
    SCOPED_TRACE(verdict.file);
    const auto file = sharedMesh(std::string("bad/") + verdict.file);
    ASSERT_TRUE(file.has_value());
    Context context;
    const auto soup = readMeshFile(context, *file);
    ASSERT_OK(soup);
    const auto before = inspectSoup(context, *soup);
    ASSERT_OK(before);
    EXPECT_EQ(blockingKinds(*before), verdict.before);
    const auto repaired = repairSoup(context, *soup, {true, {}});
    ASSERT_OK(repaired);
    const auto after = inspectSoup(context, repaired->soup);
    ASSERT_OK(after);
    EXPECT_EQ(blockingKinds(*after), verdict.after);
  }
}

}  // namespace
}  // namespace moduli
