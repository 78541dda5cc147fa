// Every closed connected real mesh has its metric of constant curvature.

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/ricci/punctured_sphere.h"
#include "core/ricci/uniformize.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// Promised: this curvature and so many steps. Real meshes leave some 1e-14 after 3 to 10.
constexpr double kResidual = 1e-10;
constexpr int kSteps = 30;

struct Surface {
  Connectivity connectivity;
  std::vector<double> lengths;
  std::vector<Eigen::Vector3d> positions;
};

Result<Surface> read(const std::string& path) {
  Context context;
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, {}));
  const Connectivity& surface = prepared.mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, prepared.mesh.edgeLengths()));
  return Surface{surface, std::move(mollified.lengths), prepared.mesh.positions()};
}

bool isClosed(const Connectivity& surface) {
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (surface.isBoundaryVertex(v)) return false;
  }
  return true;
}

void expectUniformized(const Surface& surface, bool initial_delaunay) {
  Context context;
  MetricCertificate certificate;
  if (surface.connectivity.eulerCharacteristic() > 0) {
    PuncturedSphereOptions options;
    options.initial_delaunay = initial_delaunay;
    const auto found = uniformizePuncturedSphere(context, surface.connectivity, surface.lengths,
                                                 surface.positions, options);
    ASSERT_OK(found);
    certificate = found->metric.certificate;
    EXPECT_LE(found->max_link_angle, std::numbers::pi + 1e-9);
  } else {
    UniformizeOptions options;
    options.initial_delaunay = initial_delaunay;
    const auto found = uniformize(context, surface.connectivity, surface.lengths, options);
    ASSERT_OK(found);
    certificate = found->metric.certificate;
  }
  EXPECT_LE(certificate.curvature_residual, kResidual);
  EXPECT_LE(certificate.newton_iterations, kSteps);
  // A sum of as many angles as there are corners.
  EXPECT_LE(certificate.gauss_bonnet_residual, 1e-15 * 3 * surface.connectivity.faceCount());
  EXPECT_GT(certificate.smallest_angle, 0);
}

class EveryClosedMesh : public testing::TestWithParam<const char*> {};

TEST_P(EveryClosedMesh, IsUniformizedFromBothTriangulations) {
  const std::vector<std::string> paths = sharedMeshes(GetParam());
  if (paths.empty()) GTEST_SKIP() << "no meshes in " << GetParam() << "; set MODULI_SHARED";
  int closed = 0;
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const Result<Surface> surface = read(path);
    if (!surface.ok() || !isClosed(surface->connectivity)) continue;
    ++closed;
    expectUniformized(*surface, true);
    expectUniformized(*surface, false);
  }
  EXPECT_GT(closed, 0);
}

INSTANTIATE_TEST_SUITE_P(Folders, EveryClosedMesh,
                         testing::Values("closed_g0", "brain", "genus1", "genus2", "genus3plus"),
                         [](const auto& folder) { return std::string(folder.param); });

}  // namespace
}  // namespace moduli
