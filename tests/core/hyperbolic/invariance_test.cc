// What the closed geodesics of real meshes do not depend on.

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/ricci/uniformize.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr std::size_t kLengths = 20;

Result<TriangleMesh> readMesh(const std::string& path) {
  Context context;
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  ASSIGN_OR_RETURN(PreparedMesh prepared, prepareMesh(context, soup, {}));
  return std::move(prepared.mesh);
}

/// From the surface's own edges: inversion keeps the discrete conformal class of these exactly.
UniformizeOptions ownEdges() {
  UniformizeOptions options;
  options.initial_delaunay = false;
  return options;
}

Result<std::vector<double>> firstLengths(const MetricSurface& given,
                                         const UniformizeOptions& options,
                                         const DevelopOptions& layout = {}) {
  Context context;
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(given.surface, given.lengths));
  ASSIGN_OR_RETURN(const Uniformization found,
                   uniformize(context, given.surface, mollified.lengths, options));
  ASSIGN_OR_RETURN(const HyperbolicTriangles triangles, hyperbolicTriangles(found.metric));
  ASSIGN_OR_RETURN(const FuchsianGroup group, computeFuchsianGroup(context, triangles, layout));
  ASSIGN_OR_RETURN(const OrbitPolygon polygon, orbitPolygon(context, group));
  std::vector<double> lengths;
  for (double length = 3; lengths.size() < kLengths; length += 0.5) {
    ASSIGN_OR_RETURN(const LengthSpectrum spectrum, lengthSpectrum(context, polygon, length));
    lengths.clear();
    for (const ClosedGeodesic& geodesic : spectrum.geodesics) lengths.push_back(geodesic.length);
  }
  lengths.resize(kLengths);
  return lengths;
}

void expectNear(const Result<std::vector<double>>& found, const std::vector<double>& expected,
                double tolerance) {
  ASSERT_OK(found);
  for (std::size_t i = 0; i < kLengths; ++i) EXPECT_NEAR((*found)[i], expected[i], tolerance) << i;
}

class RealMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Meshes, RealMesh,
                         testing::Values("genus2/cfwen__eight.off",
                                         "genus2/odedstein__skull_low_resolution.obj",
                                         "genus3plus/libigl-data__3holes.off",
                                         "genus3plus/libigl-data__fertility.off"));

TEST_P(RealMesh, NumbersOrientationAndRootKeepTheFirstGeodesics) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto mesh = readMesh(path);
  ASSERT_OK(mesh);
  const MetricSurface given{mesh->connectivity(), mesh->edgeLengths()};
  const auto expected = firstLengths(given, {});
  ASSERT_OK(expected);
  // Elements move 0 by some 12: e^12 1e-16, and a few products.
  expectNear(firstLengths(renumber(given, 5), {}), *expected, 1e-8);
  expectNear(firstLengths(mirror(given), {}), *expected, 1e-8);
  DevelopOptions layout;
  layout.root = given.surface.faceCount() / 2;
  expectNear(firstLengths(given, {}, layout), *expected, 1e-8);
}

TEST_P(RealMesh, InversionOfSpaceKeepsTheFirstGeodesics) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  const auto mesh = readMesh(path);
  ASSERT_OK(mesh);
  std::vector<Eigen::Vector3d> positions = mesh->positions();
  Eigen::Vector3d low = positions[0], high = positions[0];
  for (const Eigen::Vector3d& p : positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d center = high + 0.5 * (high - low);
  const double size = (high - low).squaredNorm();
  for (Eigen::Vector3d& p : positions) p = size * (p - center) / (p - center).squaredNorm();
  MetricSurface image{mesh->connectivity(), {}};
  for (Index e = 0; e < image.surface.edgeCount(); ++e) {
    const Index h = image.surface.halfedge(e);
    image.lengths.push_back(
        (positions[image.surface.head(h)] - positions[image.surface.tail(h)]).norm());
  }
  const auto expected = firstLengths({mesh->connectivity(), mesh->edgeLengths()}, ownEdges());
  ASSERT_OK(expected);
  expectNear(firstLengths(image, ownEdges()), *expected, 1e-6);
}

}  // namespace
}  // namespace moduli
