#include "core/spherical/cap_loops.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/context.h"
#include "core/intrinsic/geometry.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/topology/surface_topology.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

struct Sides {
  const CappedSurface& surface;
  TriangleValues operator()(Index f) const {
    const Connectivity& mesh = surface.connectivity;
    return {surface.lengths[mesh.edge(3 * f)], surface.lengths[mesh.edge(3 * f + 1)],
            surface.lengths[mesh.edge(3 * f + 2)]};
  }
};

/// Sum of the angles around the apex of cap `k`.
double coneAngle(const CappedSurface& capped, std::size_t k) {
  const Connectivity& mesh = capped.connectivity;
  double sum = 0;
  for (Index f = capped.face_count; f < mesh.faceCount(); ++f) {
    if (mesh.face(f)[2] != capped.apex[k]) continue;
    // Corner 2 lies opposite to side 0.
    sum += triangleAngles(Geometry::kEuclidean, Sides{capped}(f))[0];
  }
  return sum;
}

Result<CappedSurface> capAll(const TriangleMesh& mesh) {
  return capLoops(mesh.connectivity(), mesh.edgeLengths(),
                  computeTopology(mesh.connectivity()).boundary_loops);
}

TriangleMesh sample(const std::string& kind, const std::map<std::string, double>& parameters) {
  return *TriangleMesh::fromSoup(*makeSample(kind, parameters));
}

TEST(CapRadius, OfRegularAndCyclicPolygonsIsTheCircumradius) {
  for (const int n : {3, 4, 5, 30, 1000}) {
    const double exact = 0.5 / std::sin(kPi / n);
    EXPECT_NEAR(capRadius(std::vector<double>(n, 1.0)) / exact, 1, 1e-13) << n;
  }
  // R = abc / (4 area) of an acute triangle, in any units.
  const double acute = 10.0 * 10 * 11 / (4 * 5.5 * std::sqrt(100 - 5.5 * 5.5));
  EXPECT_NEAR(capRadius({10, 10, 11}) / acute, 1, 1e-13);
  EXPECT_NEAR(capRadius({10e200, 11e200, 10e200}) / acute / 1e200, 1, 1e-13);
  EXPECT_NEAR(capRadius({10e-200, 11e-200, 10e-200}) / acute * 1e200, 1, 1e-13);
}

TEST(CapRadius, LeavesTrianglesProperWhereNoCircleServes) {
  for (const std::vector<double>& sides :
       {std::vector<double>{1}, {1, 1}, {1, 3}, {3, 4, 5}, {1, 1, 1.999}, {1, 1, 7}}) {
    const double longest = *std::max_element(sides.begin(), sides.end());
    EXPECT_EQ(capRadius(sides), 17.0 / 32 * longest);
  }
}

TEST(CapLoops, KeepsTheNumbersOfTheOriginalAndClosesIt) {
  const TriangleMesh annulus = sample("annulus", {{"resolution", 5}, {"seed", 3}});
  const Connectivity& given = annulus.connectivity();
  const auto capped = capAll(annulus);
  ASSERT_OK(capped);
  const Connectivity& mesh = capped->connectivity;
  EXPECT_EQ(capped->face_count, given.faceCount());
  EXPECT_EQ(capped->apex, (std::vector<Index>{given.vertexCount(), given.vertexCount() + 1}));
  for (Index f = 0; f < given.faceCount(); ++f) ASSERT_EQ(mesh.face(f), given.face(f));
  for (Index h = 0; h < given.halfedgeCount(); ++h) ASSERT_EQ(mesh.edge(h), given.edge(h));
  const std::vector<double> lengths = annulus.edgeLengths();
  EXPECT_TRUE(std::equal(lengths.begin(), lengths.end(), capped->lengths.begin()));
  EXPECT_EQ(static_cast<Index>(capped->lengths.size()), mesh.edgeCount());
  EXPECT_EQ(mesh.eulerCharacteristic(), 2);
  EXPECT_TRUE(computeTopology(mesh).boundary_loops.empty());
}

TEST(CapLoops, NumbersSpokesInTheOrderOfTheLoops) {
  const TriangleMesh annulus = sample("annulus", {{"resolution", 4}});
  const Connectivity& given = annulus.connectivity();
  const auto loops = computeTopology(given).boundary_loops;
  const auto capped = capLoops(given, annulus.edgeLengths(), {loops[1], loops[0]});
  ASSERT_OK(capped);
  const Connectivity& mesh = capped->connectivity;
  Index spoke = given.edgeCount();
  for (const std::size_t k : {1, 0}) {
    const Index apex = capped->apex[1 - k];
    for (const Index h : loops[k]) {
      const Index side = mesh.halfedge(spoke++);
      const std::array<Index, 2> ends = {mesh.tail(side), mesh.head(side)};
      EXPECT_TRUE((ends == std::array<Index, 2>{given.tail(h), apex}) ||
                  (ends == std::array<Index, 2>{apex, given.tail(h)}));
    }
  }
  EXPECT_EQ(spoke, mesh.edgeCount());
}

TEST(CapLoops, LeavesOtherLoopsOpen) {
  const TriangleMesh annulus = sample("annulus", {{"resolution", 4}});
  const auto loops = computeTopology(annulus.connectivity()).boundary_loops;
  const auto capped = capLoops(annulus.connectivity(), annulus.edgeLengths(), {loops[1]});
  ASSERT_OK(capped);
  const SurfaceTopology topology = computeTopology(capped->connectivity);
  ASSERT_EQ(topology.boundary_loops.size(), 1U);
  EXPECT_EQ(topology.boundary_loops[0].size(), loops[0].size());
  EXPECT_EQ(topology.genus, 0);
}

// The angles at the apex add up to a full turn: up to rounding of n angles of a polygon whose
// radius is known to a few units in the last place.
TEST(CapLoops, IsFlatOverLoopsOfManySides) {
  const auto capped = capAll(sample("annulus", {{"resolution", 8}, {"seed", 5}}));
  ASSERT_OK(capped);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(coneAngle(*capped, k), 2 * kPi, 1e-11);
}

TEST(CapLoops, ClosesLoopsOfOneAndOfTwoEdges) {
  // Two triangles glued along two sides each make a pillow with one slit of two edges; gluing two
  // sides of one triangle to each other leaves a cone with a rim of one edge.
  const auto slit = Connectivity::fromGluing(3, {{0, 1, 2}, {1, 0, 2}}, {-1, 5, 4, -1, 2, 1});
  ASSERT_OK(slit);
  const auto slit_loops = computeTopology(*slit).boundary_loops;
  const auto closed = capLoops(*slit, {1, 1, 1, 1}, slit_loops);
  ASSERT_OK(closed);
  EXPECT_EQ(closed->connectivity.eulerCharacteristic(), 2);
  EXPECT_EQ(closed->connectivity.faceCount(), 4);

  const auto cone = Connectivity::fromGluing(2, {{0, 0, 1}}, {-1, 2, 1});
  ASSERT_OK(cone);
  const auto capped = capLoops(*cone, {1, 1}, computeTopology(*cone).boundary_loops);
  ASSERT_OK(capped);
  EXPECT_EQ(capped->connectivity.eulerCharacteristic(), 2);
  for (Index f = 0; f < 2; ++f) EXPECT_FALSE(isBrokenTriangle(Sides{*capped}(f)));
}

TEST(CapLoops, RefusesWhatIsNoLoop) {
  const TriangleMesh annulus = sample("annulus", {{"resolution", 4}});
  const Connectivity& given = annulus.connectivity();
  const std::vector<double> lengths = annulus.edgeLengths();
  const auto loops = computeTopology(given).boundary_loops;
  std::vector<Index> reversed = loops[0];
  std::reverse(reversed.begin(), reversed.end());
  std::vector<Index> part = loops[0];
  part.pop_back();
  Index inner = 0;
  while (given.twin(inner) == kNone) ++inner;
  for (const std::vector<std::vector<Index>>& bad : {std::vector<std::vector<Index>>{{}},
                                                     {reversed},
                                                     {part},
                                                     {{inner}},
                                                     {{-1}},
                                                     {{given.halfedgeCount()}},
                                                     {loops[0], loops[0]}}) {
    EXPECT_THAT(capLoops(given, lengths, bad), FailsWith(Reason::kInvalidOption));
  }
  EXPECT_THAT(capLoops(given, {1, 2}, loops), FailsWith(Reason::kInvalidOption));
}

TEST(CapLoops, ClosesRealSurfaces) {
  for (const std::string name :
       {"multi_boundary/cfwen__bunny.off", "multi_boundary/odedstein__plane_holes.obj",
        "multi_boundary/gpeyre__pipes.off"}) {
    MODULI_NEED_SHARED_MESH(path, name);
    Context context;
    const auto soup = readMeshFile(context, path);
    ASSERT_OK(soup);
    const auto prepared = prepareMesh(context, *soup, {});
    ASSERT_OK(prepared);
    const auto capped = capAll(prepared->mesh);
    ASSERT_OK(capped);
    const SurfaceTopology topology = computeTopology(capped->connectivity);
    EXPECT_EQ(topology.boundary_loops.size(), 0U) << name;
    EXPECT_EQ(topology.genus, computeTopology(prepared->mesh.connectivity()).genus) << name;
    for (Index f = capped->face_count; f < capped->connectivity.faceCount(); ++f) {
      ASSERT_FALSE(isBrokenTriangle(Sides{*capped}(f))) << name << " face " << f;
    }
  }
}

}  // namespace
}  // namespace moduli
