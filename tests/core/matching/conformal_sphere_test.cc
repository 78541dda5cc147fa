#include "core/matching/conformal_sphere.h"

#include <Eigen/Geometry>
#include <map>
#include <numbers>
#include <random>

#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/spherical/map_quality.h"
#include "tests/core/matching/ball_with_limbs.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TriangleMesh sample(const std::string& name, const std::map<std::string, double>& parameters) {
  return *TriangleMesh::fromSoup(*makeSample(name, parameters));
}

Result<ConformalSphere> mapped(const TriangleMesh& mesh, bool initial_delaunay = true) {
  Context context;
  return conformalSphere(context, mesh, initial_delaunay);
}

MapQuality qualityOf(const TriangleMesh& mesh, const ConformalSphere& sphere) {
  return measureSphereMap(mesh.connectivity(), sphere.lengths, sphere.points);
}

void expectCover(const TriangleMesh& mesh) {
  const auto sphere = mapped(mesh);
  ASSERT_OK(sphere);
  const MapQuality quality = qualityOf(mesh, *sphere);
  EXPECT_EQ(quality.flipped_faces, 0);
  EXPECT_NEAR(quality.covering_degree, 1, 1e-9);
}

/// A cylinder as machines draw it: long triangles along it, and fans from one corner at its ends.
TriangleMesh sharpCylinder(int sides, double height) {
  TriangleSoup soup;
  for (const double z : {0.0, height}) {
    for (int i = 0; i < sides; ++i) {
      const double t = 2 * std::numbers::pi * i / sides;
      soup.vertices.emplace_back(std::cos(t), std::sin(t), z);
    }
  }
  for (int i = 0; i < sides; ++i) {
    const int j = (i + 1) % sides;
    soup.faces.push_back({i, j, sides + j});
    soup.faces.push_back({i, sides + j, sides + i});
    if (i == 0 || j == 0) continue;
    soup.faces.push_back({0, j, i});
    soup.faces.push_back({sides, sides + i, sides + j});
  }
  return *TriangleMesh::fromSoup(std::move(soup));
}

TEST(ConformalSphere, LimbsAreMoreConformalOnFinerMeshes) {
  // Three times as long as thick: e^(-6) of the ball's scale.
  const TriangleMesh coarse = ballWithLimbs(10, 3), fine = ballWithLimbs(20, 3);
  const auto first = mapped(coarse), second = mapped(fine);
  ASSERT_OK(first);
  ASSERT_OK(second);
  const MapQuality before = qualityOf(coarse, *first), after = qualityOf(fine, *second);
  EXPECT_EQ(before.flipped_faces, 0);
  EXPECT_EQ(after.flipped_faces, 0);
  // Of first order in the edge length, which is halved: 0.5 but for the creases at the limbs' ends.
  EXPECT_LT(after.mean_dilatation - 1, 0.65 * (before.mean_dilatation - 1));
}

TEST(ConformalSphere, LimbsLongerThanDoublesReachKeepTheLeastScale) {
  // Conformally the ends would be e^(-100) of the ball's scale.
  const TriangleMesh mesh = ballWithLimbs(8, 50);
  const auto sphere = mapped(mesh);
  ASSERT_OK(sphere);
  const MapQuality quality = qualityOf(mesh, *sphere);
  EXPECT_EQ(quality.flipped_faces, 0);
  EXPECT_NEAR(quality.covering_degree, 1, 1e-9);
  // Edges are long enough for half of a double's digits to be more than rounding.
  for (Index e = 0; e < mesh.connectivity().edgeCount(); ++e) {
    const Index h = mesh.connectivity().halfedge(e);
    EXPECT_GT(
        (sphere->points[mesh.connectivity().tail(h)] - sphere->points[mesh.connectivity().head(h)])
            .norm(),
        1e-14);
  }
}

TEST(ConformalSphere, InversionOfSpaceChangesItByAMoebiusMapAlone) {
  const TriangleMesh mesh =
      sample("spheroid", {{"a", 1}, {"c", 1.6}, {"resolution", 8}, {"seed", 3}});
  TriangleSoup soup{mesh.positions(), mesh.connectivity().faces()};
  const Eigen::Vector3d centre(2.5, 0.4, 0.7);
  for (Eigen::Vector3d& p : soup.vertices) {
    const Eigen::Vector3d way = p - centre;
    p = way / way.squaredNorm();
  }
  // From outside an inversion turns the surface over.
  for (Triangle& f : soup.faces) std::swap(f[1], f[2]);
  const TriangleMesh other = *TriangleMesh::fromSoup(std::move(soup));
  // Lengths change by factors at their ends: the map of the given triangulation is the same.
  const auto a = mapped(mesh, false), b = mapped(other, false);
  ASSERT_OK(a);
  ASSERT_OK(b);
  std::vector<PointPair> pairs;
  Points3 mirrored = b->points;
  for (Eigen::Vector3d& p : mirrored) p.x() = -p.x();
  for (Index v = 0; v < mesh.vertexCount(); ++v) pairs.push_back({mirrored[v], a->points[v]});
  const auto moved = broughtNear(mirrored, pairs);
  ASSERT_OK(moved);
  double farthest = 0;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    farthest = std::max(farthest, ((*moved)[v] - a->points[v]).norm());
  }
  // What the preference for rotations leaves: 0.001 of a motion of length 1.
  EXPECT_LT(farthest, 0.005);
}

TEST(ConformalSphere, NeedlesOfASharpBodyDoNotFold) {
  for (const int sides : {24, 96}) expectCover(sharpCylinder(sides, 3));
}

TEST(ConformalSphere, NeighboursAMillionthApartDoNotFold) {
  TriangleMesh mesh = sample("sphere", {{"resolution", 6}, {"seed", 2}});
  TriangleSoup soup{mesh.positions(), mesh.connectivity().faces()};
  // Into every fourth face a vertex, a millionth from one of its corners.
  const std::size_t count = soup.faces.size();
  for (std::size_t f = 0; f < count; f += 4) {
    const auto [a, b, c] = soup.faces[f];
    const auto v = static_cast<Index>(soup.vertices.size());
    soup.vertices.push_back(Eigen::Vector3d((1 - 1e-6) * soup.vertices[a] +
                                            5e-7 * (soup.vertices[b] + soup.vertices[c])));
    soup.faces[f] = {a, b, v};
    soup.faces.push_back({b, c, v});
    soup.faces.push_back({c, a, v});
  }
  expectCover(*TriangleMesh::fromSoup(std::move(soup)));
}

TEST(ConformalSphere, RoughStarsDoNotFold) {
  TriangleMesh mesh = sample("sphere", {{"resolution", 10}, {"seed", 2}});
  for (const double roughness : {0.3, 1.0}) {
    TriangleSoup soup{mesh.positions(), mesh.connectivity().faces()};
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (Eigen::Vector3d& p : soup.vertices) p *= std::exp(roughness * normal(random));
    expectCover(*TriangleMesh::fromSoup(std::move(soup)));
  }
}

/// Every vertex in the mean of its neighbours, so many times: limbs become wires, faces needles.
TriangleMesh averaged(const TriangleMesh& mesh, int times) {
  const Connectivity& surface = mesh.connectivity();
  std::vector<Eigen::Vector3d> places = mesh.positions();
  for (int n = 0; n < times; ++n) {
    std::vector<Eigen::Vector3d> sums(places.size(), Eigen::Vector3d::Zero());
    std::vector<double> counts(places.size(), 0.0);
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      sums[surface.tail(h)] += places[surface.head(h)];
      ++counts[surface.tail(h)];
    }
    for (std::size_t v = 0; v < places.size(); ++v) places[v] = sums[v] / counts[v];
  }
  return *TriangleMesh::fromSoup({std::move(places), surface.faces()});
}

TEST(ConformalSphere, RealSurfacesSmoothedToWiresDoNotFold) {
  MODULI_NEED_SHARED_MESH(path, "closed_g0/odedstein__bunny.obj");
  Context context;
  const auto soup = readMeshFile(context, path);
  ASSERT_OK(soup);
  const TriangleMesh mesh = *TriangleMesh::fromSoup(*soup);
  for (const int times : {20, 200}) expectCover(averaged(mesh, times));
}

}  // namespace
}  // namespace moduli
