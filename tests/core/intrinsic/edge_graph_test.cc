#include "core/intrinsic/edge_graph.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TriangleMesh sample(const std::string& kind, const std::map<std::string, double>& parameters) {
  return *TriangleMesh::fromSoup(*makeSample(kind, parameters));
}

EdgeGraph graphOf(const TriangleMesh& mesh) {
  return EdgeGraph(mesh.connectivity(), mesh.edgeLengths());
}

TEST(EdgeGraph, CountsEdgesOnAnOctahedronSubdivided) {
  // All edges of length 1: distances are numbers of edges.
  const TriangleMesh mesh = sample("sphere", {{"resolution", 4}});
  const EdgeGraph graph(mesh.connectivity(),
                        std::vector<double>(mesh.connectivity().edgeCount(), 1));
  const Index source = 0;
  const std::vector<double> distance = graph.distances(std::span(&source, 1));
  EXPECT_EQ(distance[0], 0);
  for (Index v = 1; v < mesh.vertexCount(); ++v) {
    double least = 1e9;
    for (const auto& [u, length] : graph.neighbours(v)) least = std::min(least, distance[u]);
    EXPECT_EQ(distance[v], least + 1) << v;
  }
}

TEST(EdgeGraph, IsNoShorterThanArcsAndTendsToWithinTheirZigzag) {
  const TriangleMesh mesh = sample("sphere", {{"resolution", 20}, {"seed", 3}});
  const EdgeGraph graph = graphOf(mesh);
  const Index source = 5;
  const std::vector<double> distance = graph.distances(std::span(&source, 1));
  const Eigen::Vector3d p = mesh.positions()[source];
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const double arc = std::acos(std::clamp(p.dot(mesh.positions()[v]), -1.0, 1.0));
    // Chords are shorter than arcs by a 24th of the square of the edge, some 0.06 here.
    EXPECT_GE(distance[v], arc * (1 - 0.1 * 0.1 / 24));
    // No zigzag between directions 60 degrees apart is longer than 2 / sqrt(3).
    EXPECT_LE(distance[v], arc * 1.35 + 0.1) << v;
  }
}

TEST(EdgeGraph, FindsWhatIsWithinARadiusNearestFirst) {
  const TriangleMesh mesh = sample("torus", {{"R", 2}, {"r", 1}, {"resolution", 12}, {"seed", 4}});
  const EdgeGraph graph = graphOf(mesh);
  const Index source = 17;
  const std::vector<double> distance = graph.distances(std::span(&source, 1));
  const auto near = graph.within(source, 1.5);
  const auto expected =
      std::count_if(distance.begin(), distance.end(), [](double d) { return d <= 1.5; });
  EXPECT_EQ(static_cast<std::ptrdiff_t>(near.size()), expected);
  for (std::size_t i = 0; i < near.size(); ++i) {
    EXPECT_EQ(near[i].second, distance[near[i].first]);
    EXPECT_LE(near[i > 0 ? i - 1 : 0].second, near[i].second);
  }
}

TEST(EdgeGraph, SpreadsSamplesFarFromEachOther) {
  const TriangleMesh mesh = sample("ellipsoid", {{"resolution", 8}, {"seed", 2}});
  const EdgeGraph graph = graphOf(mesh);
  const VertexSamples samples = graph.farthestSamples({}, 20);
  ASSERT_EQ(samples.vertices.size(), 20U);
  // Every one is the farthest from those before it, and the labels tell the nearest.
  std::vector<Index> before;
  for (const Index v : samples.vertices) {
    if (!before.empty()) {
      const std::vector<double> distance = graph.distances(before);
      EXPECT_EQ(distance[v], *std::max_element(distance.begin(), distance.end()));
    }
    before.push_back(v);
  }
  std::vector<std::vector<double>> from;
  for (const Index v : samples.vertices) from.push_back(graph.distances(std::span(&v, 1)));
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    for (const auto& distance : from) EXPECT_LE(from[samples.nearest[v]][v], distance[v]);
  }
  EXPECT_EQ(graph.farthestSamples({3, 4}, 2).vertices, (std::vector<Index>{3, 4}));
}

TEST(EdgeGraph, ReachesNoOtherComponent) {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", 1}});
  const TriangleSoup other = soup;
  const auto count = static_cast<Index>(soup.vertices.size());
  soup.vertices.insert(soup.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.faces) {
    soup.faces.push_back({t[0] + count, t[1] + count, t[2] + count});
  }
  const TriangleMesh mesh = *TriangleMesh::fromSoup(soup);
  const Index source = 0;
  const std::vector<double> distance = graphOf(mesh).distances(std::span(&source, 1));
  EXPECT_TRUE(std::isfinite(distance[count - 1]));
  EXPECT_TRUE(std::isinf(distance[count]));
}

}  // namespace
}  // namespace moduli
