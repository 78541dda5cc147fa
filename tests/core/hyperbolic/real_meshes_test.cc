// Every closed real mesh of genus 2 and more has its Fuchsian group and its Dirichlet domain.

#include <algorithm>
#include <string>
#include <vector>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/ricci/uniformize.h"
#include "core/topology/surface_topology.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Result<MetricSurface> readSurface(const std::string& path) {
  Context context;
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, {}));
  const Connectivity& surface = prepared.mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, prepared.mesh.edgeLengths()));
  return MetricSurface{surface, std::move(mollified.lengths)};
}

Result<HyperbolicTriangles> uniformized(const MetricSurface& given) {
  Context context;
  ASSIGN_OR_RETURN(const Uniformization found, uniformize(context, given.surface, given.lengths));
  return hyperbolicTriangles(found.metric);
}

/// A closed mesh, or the double of one with a boundary.
void expectGroup(const MetricSurface& given) {
  const auto triangles = uniformized(given);
  ASSERT_OK(triangles);
  const Index characteristic = triangles->surface.eulerCharacteristic();
  Context context;
  const auto group = computeFuchsianGroup(context, *triangles);
  ASSERT_OK(group);
  const FuchsianCertificate& certificate = group->certificate;
  ASSERT_EQ(static_cast<Index>(group->generators.size()), 2 - characteristic);
  // Promised 1e-8; seen 5e-11 and less.
  EXPECT_LE(certificate.relation_residual, 1e-9);
  EXPECT_LE(certificate.development.vertex_residual, 1e-12);
  EXPECT_LE(certificate.development.determinant_drift, 1e-12);
  // Angles are right to some 1e-16, paths to the corners of the layout to some thousand of these.
  EXPECT_LE(certificate.moved, 1e-11);
  EXPECT_GT(certificate.shortest_generator, 0.1);
  const auto domain = dirichletDomain(context, *group);
  ASSERT_OK(domain);
  // Seen 4e-11 and 1e-9, where rounded corners at distance 5 have rounded angles.
  EXPECT_LE(domain->certificate.area_error, 1e-9);
  EXPECT_LE(domain->certificate.cycle_residual, 1e-8);
  EXPECT_LE(domain->certificate.side_residual, 1e-9);
  // A surface without symmetries has three corners in each point: 12 g - 6 sides.
  EXPECT_EQ(static_cast<Index>(domain->sides.size()), 6 - 6 * characteristic);
}

class EveryMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Folders, EveryMesh, testing::Values("genus2", "genus3plus"));

TEST_P(EveryMesh, HasAGroupThatSatisfiesItsRelationAndADomainThatIsGlued) {
  const std::vector<std::string> paths = sharedMeshes(GetParam());
  if (paths.empty()) GTEST_SKIP() << "no meshes in " << GetParam() << "; set MODULI_SHARED";
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const auto surface = readSurface(path);
    ASSERT_OK(surface);
    expectGroup(*surface);
  }
}

class BorderedMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Doubles, BorderedMesh,
                         testing::Values("multi_boundary/cfwen__bunny.off",
                                         "multi_boundary/gpeyre__pipes.off"));

TEST_P(BorderedMesh, HasTheGroupOfItsDouble) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto surface = readSurface(path);
  ASSERT_OK(surface);
  expectGroup(*surface);
}

/// The halfedges between neighbours of a loop of vertices, where each is there once; else empty.
std::vector<Index> edgesBetween(const Connectivity& surface, const std::vector<Index>& vertices) {
  std::vector<Index> loop;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Index head = vertices[(i + 1) % vertices.size()];
    int count = 0;
    const Index first = surface.outgoing(vertices[i]);
    Index h = first;
    do {
      if (surface.head(h) == head && count++ == 0) loop.push_back(h);
      h = surface.rotate(h);
    } while (h != first);
    if (count != 1) return {};
  }
  return loop;
}

/// Meshes whose flips leave the edges of some boundary loop.
class BorderInEdges : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Doubles, BorderInEdges,
                         testing::Values("multi_boundary/gpeyre__pipes.off",
                                         "multi_boundary/libigl-data__halftunnel.off"));

TEST_P(BorderInEdges, BoundaryIsMadeOfClosedGeodesicsOfTheDouble) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto given = readSurface(path);
  ASSERT_OK(given);
  const auto triangles = uniformized(*given);
  ASSERT_OK(triangles);
  Context context;
  const auto development = develop(context, *triangles);
  ASSERT_OK(development);
  int found = 0;
  for (const std::vector<Index>& halfedges : computeTopology(given->surface).boundary_loops) {
    std::vector<Index> vertices;
    for (const Index h : halfedges) vertices.push_back(given->surface.tail(h));
    // Flips may have taken edges of the boundary away; the double keeps the numbers of vertices.
    const std::vector<Index> loop = edgesBetween(triangles->surface, vertices);
    if (loop.empty()) continue;
    ++found;
    double sum = 0;
    for (const Index h : loop) sum += triangles->lengths[h];
    const double length = translationLength(holonomy(triangles->surface, *development, loop));
    // A hundred lengths of faces, angles of pi to some 1e-13 between them.
    EXPECT_NEAR(length, sum, 1e-10 * std::max(1.0, sum));
  }
  EXPECT_GT(found, 0);
}

/// The lengths of the closed geodesics up to 1.4 systoles.
std::vector<double> shortLengths(const HyperbolicTriangles& triangles, Index root) {
  Context context;
  DevelopOptions options;
  options.root = root;
  const auto group = computeFuchsianGroup(context, triangles, options);
  EXPECT_OK(group);
  if (!group.ok()) return {};
  const auto polygon = orbitPolygon(context, *group);
  EXPECT_OK(polygon);
  if (!polygon.ok()) return {};
  const auto shortest = systoles(context, *polygon);
  EXPECT_OK(shortest);
  if (!shortest.ok()) return {};
  const auto spectrum = lengthSpectrum(context, *polygon, 1.4 * shortest->geodesics[0].length);
  EXPECT_OK(spectrum);
  std::vector<double> lengths;
  if (!spectrum.ok()) return lengths;
  for (const ClosedGeodesic& geodesic : spectrum->geodesics) lengths.push_back(geodesic.length);
  return lengths;
}

void expectSameLengths(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  // Metrics that agree to some 1e-13 in lengths of faces, paths of a hundred faces.
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9);
}

class SmallMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, SmallMesh,
                         testing::Values("genus2/cfwen__eight.off",
                                         "genus3plus/libigl-data__3holes.off"));

TEST_P(SmallMesh, GeodesicsDoNotDependOnTheCut) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto surface = readSurface(path);
  ASSERT_OK(surface);
  const auto triangles = uniformized(*surface);
  ASSERT_OK(triangles);
  const std::vector<double> expected = shortLengths(*triangles, kNone);
  EXPECT_FALSE(expected.empty());
  for (const Index root : {0, 500, 1000}) {
    SCOPED_TRACE(root);
    expectSameLengths(shortLengths(*triangles, root), expected);
  }
}

TEST_P(SmallMesh, GeodesicsDoNotDependOnNumbersOrOrientation) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto surface = readSurface(path);
  ASSERT_OK(surface);
  const auto triangles = uniformized(*surface);
  ASSERT_OK(triangles);
  const std::vector<double> expected = shortLengths(*triangles, kNone);
  EXPECT_FALSE(expected.empty());
  for (const MetricSurface& other :
       {renumber(*surface, 1), mirror(*surface), scale(*surface, 1000)}) {
    const auto image = uniformized(other);
    ASSERT_OK(image);
    expectSameLengths(shortLengths(*image, kNone), expected);
  }
}

}  // namespace
}  // namespace moduli
