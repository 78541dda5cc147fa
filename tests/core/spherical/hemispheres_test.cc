#include "core/spherical/hemispheres.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/forms/cotan.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;

/// Enough for fields whose features are 0.3 wide.
const FieldSearchOptions kQuick = {.rotations = 8192, .samples = 600, .candidates = 6};

/// A surface on the sphere with areas as weights and a field.
struct Half {
  MappedSurface map;
  std::vector<double> weights, field;

  Hemisphere view() const { return {map.surface(), map.points, weights, field}; }
};

/// How much the map shrinks the surface, in logarithms: high on what stands out.
std::vector<double> logShrinking(const MappedSurface& map) {
  const std::vector<double> areas = vertexAreas(map.surface(), map.mesh.edgeLengths());
  std::vector<double> images(areas.size(), 0.0), field;
  for (const auto& [a, b, c] : map.surface().faces()) {
    const double angle = signedSolidAngle(map.points[a], map.points[b], map.points[c]);
    for (const Index v : {a, b, c}) images[v] += angle / 3;
  }
  for (std::size_t v = 0; v < areas.size(); ++v) field.push_back(std::log(areas[v] / images[v]));
  return field;
}

Half halfOf(MappedSurface map) {
  Half half{std::move(map), {}, {}};
  half.weights = vertexAreas(half.map.surface(), half.map.mesh.edgeLengths());
  half.field = logShrinking(half.map);
  return half;
}

/// An ellipsoid with a lump: no symmetry.
Half lumpyHalf(double resolution, double seed) {
  TriangleSoup soup = surfaces::sample("sphere", {{"resolution", resolution}, {"seed", seed}});
  for (Eigen::Vector3d& p : soup.vertices) {
    const double lump = std::exp(4 * (p.dot(Eigen::Vector3d(0.6, 0.48, 0.64)) - 1)) +
                        0.5 * std::exp(9 * (p.dot(Eigen::Vector3d(-0.6, 0.0, 0.8)) - 1));
    p = Eigen::Vector3d(p.x(), 1.2 * p.y(), 0.9 * p.z()) * (1 + 0.4 * lump);
  }
  const TriangleMesh mesh = surfaces::mesh(soup);
  Context context;
  auto map = mapToSphereLinear(context, mesh.connectivity(), mesh.edgeLengths());
  EXPECT_OK(map);
  return halfOf({mesh, std::move(map->points)});
}

/// The mirror image of a surface in space, mapped by the mirror image of the map, turned.
Half mirrored(const Half& half, const Eigen::Matrix3d& turn) {
  TriangleSoup soup{half.map.mesh.positions(), half.map.surface().faces()};
  for (Eigen::Vector3d& p : soup.vertices) p.x() = -p.x();
  Half result{
      {surfaces::mesh(surfaces::reversed(soup)), half.map.points}, half.weights, half.field};
  for (Eigen::Vector3d& p : result.map.points) {
    p = (turn * Eigen::Vector3d(-p.x(), p.y(), p.z())).normalized();
  }
  return result;
}

TEST(MirrorSphere, TurnsBackTheFacesThatItTurnsOver) {
  const MappedSurface map = surfaces::roundSphere(5, 2);
  const MirroredSphere image = mirrorSphere(map.surface(), map.points);
  const std::vector<double> same_lengths = [&] {
    std::vector<double> lengths;
    for (Index e = 0; e < image.surface.edgeCount(); ++e) {
      const Index h = image.surface.halfedge(e);
      lengths.push_back((map.mesh.positions()[image.surface.tail(h)] -
                         map.mesh.positions()[image.surface.head(h)])
                            .norm());
    }
    return lengths;
  }();
  const MapQuality quality = measureSphereMap(image.surface, same_lengths, image.points);
  const MapQuality before = measureSphereMap(map.surface(), map.mesh.edgeLengths(), map.points);
  EXPECT_EQ(quality.flipped_faces, 0);
  EXPECT_NEAR(quality.covering_degree, 1, 1e-12);
  EXPECT_NEAR(quality.max_dilatation, before.max_dilatation, 1e-12);
  // Only the points: everything is inside out.
  EXPECT_EQ(measureSphereMap(map.surface(), map.mesh.edgeLengths(), image.points).flipped_faces,
            map.surface().faceCount());
  const MirroredSphere again = mirrorSphere(image.surface, image.points);
  EXPECT_EQ(again.surface.faces(), map.surface().faces());
  EXPECT_EQ(again.points, map.points);
  for (Index h = 0; h < map.surface().halfedgeCount(); ++h) {
    EXPECT_EQ(again.surface.twin(h), map.surface().twin(h));
  }
}

TEST(CompareHemispheres, FindsAMirroredCopyInAnyPosition) {
  const Half half = lumpyHalf(12, 3);
  const Eigen::Matrix3d turn = surfaces::rotation(14);
  const Half other = mirrored(half, turn);
  Context context;
  HemisphereOptions options;
  options.mirror = true;
  options.search = kQuick;
  const auto result = compareHemispheres(context, half.view(), other.view(), options);
  ASSERT_OK(result);
  EXPECT_NEAR(result->correlation_after, 1, 1e-12);
  EXPECT_LT(result->correlation_before, 0.9);
  EXPECT_LT(result->mean_absolute_difference, 1e-10);
  // Mirror, turn, mirror: the rotation is the turn seen in the mirror.
  const Eigen::Matrix3d reflect = Eigen::Vector3d(-1, 1, 1).asDiagonal();
  EXPECT_LT((result->rotation - reflect * turn * reflect).norm(), 1e-10);
  for (std::size_t v = 0; v < half.field.size(); ++v) {
    EXPECT_NEAR(result->carried[v], half.field[v], 1e-9);
    // Places are in the numbering of the surface as given.
    const Eigen::Vector3d there =
        spherePoint(other.map.surface(), other.map.points, result->places[v]);
    EXPECT_LT((there - other.map.points[v]).norm(), 1e-10);
  }
  // Without the mirror there is no such rotation.
  options.mirror = false;
  const auto plain = compareHemispheres(context, half.view(), other.view(), options);
  ASSERT_OK(plain);
  EXPECT_LT(plain->correlation_after, 0.99);
}

TEST(CompareHemispheres, LandmarksGiveTheSameRotationAsTheField) {
  const Half half = lumpyHalf(10, 3);
  const Eigen::Matrix3d turn = surfaces::rotation(15);
  const Half other = mirrored(half, turn);
  HemisphereOptions options;
  options.mirror = true;
  options.search = kQuick;
  for (const Index v : {3, 50, 200}) {
    options.landmarks.emplace_back(vertexPoint(half.map.surface(), v),
                                   vertexPoint(other.map.surface(), v));
  }
  Context context;
  const auto result = compareHemispheres(context, half.view(), other.view(), options);
  ASSERT_OK(result);
  EXPECT_NEAR(result->correlation_after, 1, 1e-12);
  EXPECT_LT(result->mean_absolute_difference, 1e-12);
}

TEST(CompareHemispheres, SeesTheSameSurfaceInAnotherTriangulation) {
  const Half a = lumpyHalf(20, 3), b = lumpyHalf(20, 8);
  Context context;
  HemisphereOptions options;
  options.search = kQuick;
  const auto result = compareHemispheres(context, a.view(), b.view(), options);
  ASSERT_OK(result);
  // Areas of single vertices are noisy on irregular meshes; the shape is not.
  EXPECT_GT(result->correlation_after, 0.97);
  EXPECT_LT(result->mean_absolute_difference, 0.1);
}

TEST(CompareHemispheres, NamesTheHemisphereThatIsWrong) {
  const Half half = lumpyHalf(6, 3);
  Half folded = half;
  for (Eigen::Vector3d& p : folded.map.points) p = -p;
  Context context;
  const auto result = compareHemispheres(context, half.view(), folded.view());
  EXPECT_THAT(result, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(result.status().message(), testing::HasSubstr("second hemisphere"));
  Half small = half;
  small.weights.pop_back();
  EXPECT_THAT(compareHemispheres(context, small.view(), half.view()),
              FailsWith(Reason::kInvalidOption));
}

TEST(CompareHemispheres, OfABrainAreMirrorImages) {
  MODULI_NEED_SHARED_MESH(left_path, "brain/nilearn__pial_left.ply");
  MODULI_NEED_SHARED_MESH(right_path, "brain/nilearn__pial_right.ply");
  const Half left = halfOf(surfaces::mappedMesh(left_path));
  const Half right = halfOf(surfaces::mappedMesh(right_path));
  Context context;
  HemisphereOptions options;
  options.mirror = true;
  options.search = kQuick;
  const auto mirror = compareHemispheres(context, left.view(), right.view(), options);
  HemisphereOptions unmirrored;
  unmirrored.search = kQuick;
  const auto plain = compareHemispheres(context, left.view(), right.view(), unmirrored);
  ASSERT_OK(mirror);
  ASSERT_OK(plain);
  EXPECT_GT(mirror->correlation_after, 0.9);
  // The other half is the mirror image, and not a copy.
  EXPECT_GT(mirror->correlation_after, plain->correlation_after);

  const Half copy = mirrored(left, surfaces::rotation(3));
  const auto self = compareHemispheres(context, left.view(), copy.view(), options);
  ASSERT_OK(self);
  EXPECT_NEAR(self->correlation_after, 1, 1e-10);
  EXPECT_LT(self->mean_absolute_difference, 1e-8);
}

}  // namespace
}  // namespace moduli
