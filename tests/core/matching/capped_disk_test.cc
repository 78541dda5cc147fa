#include "core/matching/capped_disk.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/matching/disk_rim.h"
#include "core/matching/split_surface.h"
#include "core/mesh/read.h"
#include "core/spherical/exact_sign.h"
#include "core/spherical/map_quality.h"
#include "tests/core/matching/disk_samples.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

int foldedFaces(const Connectivity& surface, const Points3& points) {
  int folded = 0;
  for (const auto& [a, b, c] : surface.faces()) {
    if (spherical::orientationSign(points[a], points[b], points[c]) <= 0) ++folded;
  }
  return folded;
}

/// A disk made ready, and its map.
struct Mapped {
  SplitSurface split;
  TriangleMesh capped;
  Points3 points;

  explicit Mapped(const TriangleSoup& soup)
      : split(*SplitSurface::make(*TriangleMesh::fromSoup(soup))),
        capped(*cappedDisk(split.mesh())) {
    Context context;
    auto map = conformalHemisphere(context, split.mesh(), capped, true);
    EXPECT_OK(map);
    points = *std::move(map);
  }

  /// No fold, the boundary on the equator to the last bit, all else above, the cap's pole below.
  void expectHemisphere() const {
    EXPECT_EQ(foldedFaces(capped.connectivity(), points), 0);
    const Index pole = capped.vertexCount() - 1;
    EXPECT_EQ(points[pole], Eigen::Vector3d(0, 0, -1));
    for (Index v = 0; v < pole; ++v) {
      EXPECT_NEAR(points[v].norm(), 1, 1e-14);
      if (split.mesh().connectivity().isBoundaryVertex(v)) {
        EXPECT_EQ(points[v].z(), 0);
      } else {
        EXPECT_GT(points[v].z(), 0);
      }
    }
    double angle = 0;
    for (const auto& [a, b, c] : split.mesh().connectivity().faces()) {
      angle += signedSolidAngle(points[a], points[b], points[c]);
    }
    EXPECT_NEAR(angle, 2 * std::numbers::pi, 1e-9);
  }
};

TEST(CappedDisk, IsASphereWithTheDiskInFront) {
  const TriangleMesh disk = *TriangleMesh::fromSoup(shield(5, 1));
  const auto capped = cappedDisk(disk);
  ASSERT_OK(capped);
  EXPECT_EQ(capped->connectivity().eulerCharacteristic(), 2);
  EXPECT_EQ(capped->vertexCount(), disk.vertexCount() + 1);
  EXPECT_EQ(capped->faceCount(), disk.faceCount() + 30);
  for (Index f = 0; f < disk.faceCount(); ++f) {
    EXPECT_EQ(capped->connectivity().face(f), disk.connectivity().face(f));
  }
}

TEST(ConformalHemisphere, CoversHalfTheSphereOnce) {
  Mapped(shield(10, 3)).expectHemisphere();
  // Without any vertex inside before they are split.
  Mapped(twoTriangles()).expectHemisphere();
  Mapped(strip(9)).expectHemisphere();
  Mapped({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}).expectHemisphere();
}

TEST(ConformalHemisphere, KeepsAngles) {
  // Mean dilatation less 1 at two resolutions: it falls with the edges.
  double last = 1;
  for (const int resolution : {8, 16, 32}) {
    const Mapped map(shield(resolution, 0));
    std::vector<double> lengths = map.split.mesh().edgeLengths();
    const double k = measureSphereMap(map.split.mesh().connectivity(), lengths,
                                      {map.points.begin(), map.points.end() - 1})
                         .mean_dilatation;
    EXPECT_LT(k - 1, 0.7 * last);
    last = k - 1;
  }
  EXPECT_LT(last, 0.05);
}

TEST(ConformalHemisphere, UnfoldsWhatFolds) {
  Mapped map(shield(8, 3));
  // Two vertices of the boundary exchanged, one inside thrown over its ring, one below the equator.
  const DiskRim rim(map.capped.connectivity(), map.points, map.capped.positions());
  const Connectivity& surface = map.capped.connectivity();
  std::swap(map.points[surface.tail(rim.halfedge(3))], map.points[surface.tail(rim.halfedge(4))]);
  Index inside = 0;
  while (map.points[inside].z() < 0.5) ++inside;
  map.points[inside] = Eigen::Vector3d(0.6, 0.1, 0.5).normalized();
  Index near = 0;
  while (!(map.points[near].z() > 0 && map.points[near].z() < 0.2)) ++near;
  map.points[near] = (map.points[near] - Eigen::Vector3d(0, 0, 0.3)).normalized();
  ASSERT_GT(foldedFaces(surface, map.points), 3);
  Context context;
  auto unfolded = unfoldHemisphere(context, map.capped, map.points);
  ASSERT_OK(unfolded);
  map.points = *unfolded;
  map.expectHemisphere();
}

TEST(DiskRim, KnowsItsPoints) {
  const Mapped map(shield(6, 3));
  const Connectivity& surface = map.capped.connectivity();
  const DiskRim rim(surface, map.points, map.capped.positions());
  ASSERT_EQ(rim.size(), 36);
  double length = 0;
  for (Index i = 0; i < rim.size(); ++i) {
    const Index h = rim.halfedge(i), v = surface.tail(h), w = surface.head(h);
    EXPECT_EQ(surface.tail(rim.halfedge((i + 1) % 36)), w);  // One after the other,
    EXPECT_GT(map.points[v].cross(map.points[w]).z(), 0);    // counter-clockwise.
    EXPECT_NEAR(rim.begin(i), length, 1e-12);
    length += (map.capped.positions()[w] - map.capped.positions()[v]).norm();
    for (const double t : {0.0, 0.25, 0.7, 1.0}) {
      // By direction (the share t is that of the chord) and by place (that of the edge).
      const Eigen::Vector3d on_chord = (1 - t) * map.points[v] + t * map.points[w];
      const SurfacePoint by_angle = rim.at(3 * on_chord + Eigen::Vector3d(0, 0, 0.4));
      EXPECT_LT((spherePoint(surface, map.points, by_angle) - on_chord.normalized()).norm(), 1e-14);
      const double place =
          rim.begin(i) + t * (map.capped.positions()[w] - map.capped.positions()[v]).norm();
      const SurfacePoint by_place = rim.atPlace(place - 2 * rim.length());
      EXPECT_NEAR(std::remainder(rim.place(by_place) - place, rim.length()), 0, 1e-12);
      const Index edge = rim.halfedge(rim.edgeOf(by_place));
      EXPECT_EQ(by_place.barycentric[(edge + 2) % 3], 0);
    }
  }
  EXPECT_NEAR(rim.length(), length, 1e-12);
}

TEST(ConformalHemisphere, CoversHalfTheSphereByRealDisks) {
  for (const std::string& path : sharedMeshes("disk")) {
    Context context;
    auto soup = readMeshFile(context, path);
    ASSERT_OK(soup);
    if (soup->faces.size() > 10000) continue;
    SCOPED_TRACE(path);
    Mapped(*soup).expectHemisphere();
  }
}

}  // namespace
}  // namespace moduli
