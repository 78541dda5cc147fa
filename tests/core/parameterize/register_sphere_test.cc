// One sphere laid onto another: by rotations, by landmarks, in the mirror, with cut faces.

#include "core/parameterize/register_sphere.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/mesh/prepare.h"
#include "core/parameterize/sphere.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using testing::HasSubstr;

/// A surface and its map.
struct Mapped {
  TriangleMesh mesh;
  Parameterization map;
  std::vector<double> field = {};

  const Connectivity& surface() const { return mesh.connectivity(); }
};

Mapped mapped(TriangleMesh mesh) {
  Context context;
  auto map = parameterizeSphere(context, mesh.connectivity(), mesh.edgeLengths(), mesh.positions());
  EXPECT_OK(map);
  return {std::move(mesh), *std::move(map)};
}

/// An ellipsoid with two lumps: no symmetry.
TriangleSoup lumpySoup(double resolution, double seed) {
  TriangleSoup soup = surfaces::sample("sphere", {{"resolution", resolution}, {"seed", seed}});
  for (Eigen::Vector3d& p : soup.vertices) {
    const double lump = std::exp(4 * (p.dot(Eigen::Vector3d(0.6, 0.48, 0.64)) - 1)) +
                        0.5 * std::exp(9 * (p.dot(Eigen::Vector3d(-0.6, 0.0, 0.8)) - 1));
    p = Eigen::Vector3d(p.x(), 1.2 * p.y(), 0.9 * p.z()) * (1 + 0.4 * lump);
  }
  return soup;
}

TriangleSoup mirrored(TriangleSoup soup) {
  for (Eigen::Vector3d& p : soup.vertices) p.x() = -p.x();
  return surfaces::reversed(std::move(soup));
}

Result<SphereRegistration> registered(const Mapped& a, const Mapped& b,
                                      const SphereRegistrationOptions& options = {}) {
  Context context;
  const std::vector<double> lengths_a = a.mesh.edgeLengths(), lengths_b = b.mesh.edgeLengths();
  return registerSphere(context, {a.surface(), lengths_a, a.map, a.field},
                        {b.surface(), lengths_b, b.map, b.field}, options);
}

double farthest(const Points3& a, const Points3& b) {
  double distance = a.size() == b.size() ? 0 : 2;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    distance = std::max(distance, (a[i] - b[i]).norm());
  }
  return distance;
}

/// A map that is the same but for a rotation: what registration has to undo.
Mapped turned(Mapped a, unsigned seed) {
  const Eigen::Matrix3d turn = surfaces::rotation(seed);
  for (Eigen::Vector3d& p : a.map.sphere) p = (turn * p).normalized();
  return a;
}

// Tolerances of recovered rotations: Gauss and Newton's method stops where the correlation, known
// to 1e-16, is flat: at the root of that, 1e-8, over a slope of order one.
constexpr double kTurn = 1e-7;

TEST(RegisterSphere, ASurfaceLiesOnItself) {
  const Mapped a = mapped(surfaces::mesh(lumpySoup(10, 3)));
  const auto result = registered(turned(a, 4), a);
  ASSERT_OK(result);
  EXPECT_EQ(result->field, ComparedField::kAreaDistortion);
  EXPECT_LT(farthest(result->points, a.map.sphere), kTurn);
  EXPECT_NEAR(*result->correlation_after, 1, 1e-12);
  EXPECT_LT(*result->correlation_before, 0.9);
  EXPECT_LT(*result->mean_absolute_difference, 1e-6);
  EXPECT_EQ(result->landmarks, 0);
  EXPECT_FALSE(result->landmark_distance);
  EXPECT_FALSE(result->mean_beltrami);
  EXPECT_EQ(result->quality.flipped_faces, 0);
  EXPECT_NEAR(result->quality.mean_dilatation, a.map.certificate.quality.mean_dilatation, 1e-9);
  ASSERT_EQ(result->carried.size(), a.map.sphere.size());
}

TEST(RegisterSphere, AMirroredCopyLiesOnTheSurfaceInTheMirrorAlone) {
  const Mapped a = mapped(surfaces::mesh(lumpySoup(10, 3)));
  const Mapped b = mapped(surfaces::mesh(mirrored(lumpySoup(10, 3))));
  const auto mirror = registered(
      a, b, {.mirror = true, .landmarks = {}, .curves = {}, .search = {}, .meeting = {}});
  ASSERT_OK(mirror);
  // The two maps are those of one discrete conformal class: Newton stops at 1e-10 or below.
  EXPECT_NEAR(*mirror->correlation_after, 1, 1e-9);
  const auto plain = registered(a, b);
  ASSERT_OK(plain);
  EXPECT_LT(*plain->correlation_after, 0.99);
}

TEST(RegisterSphere, AGivenFieldIsCarriedToWhereItBelongs) {
  Mapped a = mapped(surfaces::mesh(lumpySoup(10, 3)));
  for (const Eigen::Vector3d& p : a.mesh.positions()) a.field.push_back(p.x() + p.y() * p.z());
  const auto result = registered(turned(a, 8), a);
  ASSERT_OK(result);
  EXPECT_EQ(result->field, ComparedField::kGiven);
  EXPECT_NEAR(*result->correlation_after, 1, 1e-12);
  ASSERT_EQ(result->carried.size(), a.field.size());
  for (std::size_t v = 0; v < a.field.size(); ++v)
    EXPECT_NEAR(result->carried[v], a.field[v], 1e-5);
  Mapped without = a;
  without.field.clear();
  EXPECT_THAT(registered(without, a), FailsWith(Reason::kInvalidOption));
  without.field.resize(3);
  EXPECT_THAT(registered(without, a), FailsWith(Reason::kInvalidOption));
}

TEST(RegisterSphere, LandmarksAreMetWithoutFolds) {
  const Mapped a = mapped(surfaces::mesh(lumpySoup(14, 3)));
  const Mapped b = mapped(surfaces::mesh(mirrored(lumpySoup(14, 8))));
  SphereRegistrationOptions options;
  options.mirror = true;
  // Where the surfaces have the same places in space, roughly, at vertices and within faces.
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0),
        Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1)}) {
    const auto nearest = [](const Mapped& side, const Eigen::Vector3d& p) {
      Index best = 0;
      for (Index v = 0; v < side.surface().vertexCount(); ++v) {
        const auto& x = side.mesh.positions();
        if ((x[v] - p).norm() < (x[best] - p).norm()) best = v;
      }
      return vertexPoint(side.surface(), best);
    };
    SurfacePoint here = nearest(a, place);
    if (place.z() > 0) here.barycentric = {0.5, 0.25, 0.25};
    options.landmarks.push_back({here, nearest(b, {-place.x(), place.y(), place.z()})});
  }
  const auto result = registered(a, b, options);
  ASSERT_OK(result);
  EXPECT_EQ(result->landmarks, 6);
  EXPECT_LT(*result->landmark_distance, 1e-9);
  EXPECT_EQ(result->quality.flipped_faces, 0);
  EXPECT_GT(*result->max_beltrami, *result->mean_beltrami);
  EXPECT_GT(*result->mean_beltrami, 0);
  EXPECT_LT(*result->mean_beltrami, 0.3);
  EXPECT_EQ(result->field, ComparedField::kNothing);
  EXPECT_FALSE(result->correlation_after);
  EXPECT_TRUE(result->carried.empty());
  for (const SphereLandmark& landmark : options.landmarks) {
    Eigen::Vector3d target = spherePoint(b.surface(), b.map.sphere, landmark.reference);
    target.x() = -target.x();
    EXPECT_LT((spherePoint(a.surface(), result->points, landmark.point) - target).norm(), 1e-9);
  }
}

TEST(RegisterSphere, CurvesBecomeLandmarksAndTheirCommonEndsComeOnce) {
  const Mapped a = mapped(surfaces::mesh(lumpySoup(10, 3)));
  const Index v = 5, w = a.surface().head(a.surface().outgoing(v));
  const Index x = a.surface().head(a.surface().rotate(a.surface().outgoing(v)));
  SphereRegistrationOptions options;
  options.landmarks = {{vertexPoint(a.surface(), v), vertexPoint(a.surface(), v), "one"}};
  options.curves = {{{{w, v}, {w, v}, 3}, "two"}, {{{v, x}, {v, x}, 4}, "three"}};
  const auto result = registered(turned(a, 6), a, options);
  ASSERT_OK(result);
  EXPECT_EQ(result->landmarks, 1 + 2 + 3);
  EXPECT_LT(*result->landmark_distance, 1e-9);
  options.curves.push_back({{{v, v}, {v, x}, 2}, "four"});
  const auto standing = registered(a, a, options);
  EXPECT_THAT(standing, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(standing.status().message(), testing::StartsWith("four: "));
  options.curves.back() = {{{v, x}, {v, v}, 2}, "five"};
  EXPECT_THAT(registered(a, a, options).status().message(),
              testing::StartsWith("five: on the reference: "));
}

TEST(RegisterSphere, WrongLandmarksAreNamed) {
  const Mapped a = mapped(surfaces::mesh(lumpySoup(6, 3)));
  SphereRegistrationOptions options;
  const SurfacePoint good = vertexPoint(a.surface(), 3);
  options.landmarks = {{good, {a.surface().faceCount(), {1, 0, 0}}, "marks:7"}};
  const auto off = registered(a, a, options);
  EXPECT_THAT(off, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(off.status().message(), HasSubstr("marks:7 of the reference is in face"));
  options.landmarks = {{good, good, "marks:1"}, {good, vertexPoint(a.surface(), 9), "marks:2"}};
  const auto same = registered(a, a, options);
  EXPECT_THAT(same, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(same.status().message(), HasSubstr("marks:1 and marks:2 coincide"));
}

/// Splits every face near its first side: caps, whose middle vertices no map keeps where they are.
TriangleMesh withCaps(const TriangleMesh& mesh, double height) {
  TriangleSoup soup{mesh.positions(), {}};
  for (const Triangle& face : mesh.connectivity().faces()) {
    const auto apex = static_cast<Index>(soup.vertices.size());
    const double side = (1 - height) / 2;
    soup.vertices.push_back(side * soup.vertices[face[0]] + side * soup.vertices[face[1]] +
                            height * soup.vertices[face[2]]);
    for (int c = 0; c < 3; ++c) soup.faces.push_back({face[c], face[(c + 1) % 3], apex});
  }
  return surfaces::mesh(std::move(soup));
}

/// A surface whose map to the sphere cuts faces.
TriangleMesh cappedSurface() {
  return withCaps(surfaces::mesh(surfaces::sample(
                      "spheroid", {{"a", 1}, {"c", 2.5}, {"resolution", 4}, {"seed", 3}})),
                  0.002);
}

TEST(RegisterSphere, CutFacesKeepTheirLandmarksAndValues) {
  Mapped a = mapped(cappedSurface());
  ASSERT_TRUE(a.map.subdivision) << "the test needs a map that cuts faces";
  for (const Eigen::Vector3d& p : a.mesh.positions()) a.field.push_back(p.x() + 2 * p.y());
  Mapped other = turned(a, 9);
  const auto by_field = registered(other, a);
  ASSERT_OK(by_field);
  EXPECT_NEAR(*by_field->correlation_after, 1, 1e-10);
  EXPECT_EQ(by_field->points.size(), a.map.sphere.size());
  EXPECT_EQ(by_field->carried.size(), a.field.size()) << "of the surface as given";
  // The same point within a cut face of both: it is where it was.
  SphereRegistrationOptions options;
  const Subdivision& cut = *a.map.subdivision;
  int within = 0;
  for (std::size_t f = 0; f + 1 < cut.parent.size() && within < 4; ++f) {
    if (cut.parent[f] != cut.parent[f + 1]) continue;
    if (!options.landmarks.empty() && options.landmarks.back().point.face == cut.parent[f])
      continue;
    const SurfacePoint point{cut.parent[f], {0.2, 0.3, 0.5}};
    options.landmarks.push_back({point, point});
    ++within;
    f += cut.parent.size() / 5;
  }
  ASSERT_GE(within, 3);
  const auto met = registered(other, a, options);
  ASSERT_OK(met);
  EXPECT_LT(*met->landmark_distance, 1e-9);
  // All landmarks were met by a rotation: nothing else has moved.
  EXPECT_LT(farthest(met->points, a.map.sphere), 1e-6);
  EXPECT_LT(*met->mean_beltrami, 1e-6);
}

TEST(PointInPieces, IsTheSamePointOfSpace) {
  const Mapped a = mapped(cappedSurface());
  ASSERT_TRUE(a.map.subdivision) << "the test needs a map that cuts faces";
  const Subdivision& cut = *a.map.subdivision;
  Points3 positions = a.mesh.positions();
  for (const Subdivision::Vertex& vertex : cut.vertices) {
    const Eigen::Vector3d tail = positions[a.surface().tail(vertex.halfedge)];
    const Eigen::Vector3d head = positions[a.surface().head(vertex.halfedge)];
    positions.push_back(tail + vertex.fraction * (head - tail));
  }
  const auto refined = Connectivity::fromFaces(static_cast<Index>(positions.size()), cut.faces);
  ASSERT_OK(refined);
  const auto place = [](const Connectivity& surface, const Points3& at, const SurfacePoint& point) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) sum += point.barycentric[c] * at[surface.face(point.face)[c]];
    return sum;
  };
  for (Index f = 0; f < a.surface().faceCount(); ++f) {
    for (const std::array<double, 3>& weights :
         {std::array<double, 3>{1, 0, 0}, {0.2, 0.3, 0.5}, {0.9, 0.05, 0.05}, {0, 0.25, 0.75}}) {
      const SurfacePoint point{f, weights};
      const SurfacePoint piece = pointInPieces(a.surface(), cut, *refined, point);
      ASSERT_OK(checkSurfacePoint(*refined, piece, "the piece's point"));
      const double distance =
          (place(a.surface(), positions, point) - place(*refined, positions, piece)).norm();
      // Pieces may be thin: their weights lose what divides their height, some 1e-4 here.
      EXPECT_LT(distance, 1e-10) << f;
    }
  }
}

TEST(AsSphere, TakesRoundSpheresAlone) {
  const auto as = [](const TriangleSoup& soup) {
    const TriangleMesh mesh = surfaces::mesh(soup);
    return asSphere(mesh.connectivity(), mesh.edgeLengths(), mesh.positions());
  };
  TriangleSoup soup = surfaces::sample("sphere", {{"resolution", 6}, {"seed", 2}});
  for (Eigen::Vector3d& p : soup.vertices) p *= 100;
  const auto round = as(soup);
  ASSERT_TRUE(round);
  EXPECT_EQ(round->certificate.quality.flipped_faces, 0);
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    EXPECT_LT((100 * round->sphere[v] - soup.vertices[v]).norm(), 1e-12);
  }
  EXPECT_FALSE(as(surfaces::reversed(soup))) << "inside out";
  TriangleSoup uneven = soup;
  uneven.vertices[7] *= 1.0009;
  EXPECT_TRUE(as(uneven));
  uneven.vertices[7] *= 1.001;
  EXPECT_FALSE(as(uneven));
  TriangleSoup folded = soup;
  folded.vertices[7] = -folded.vertices[7];
  EXPECT_FALSE(as(folded));
  EXPECT_FALSE(as(lumpySoup(6, 3)));
  // Corners of a cube are as round, but it has faces all around as well: a sphere, too.
  EXPECT_FALSE(as(surfaces::sample("torus", {{"resolution", 6}})));
}

TEST(RegisterSphere, TheHalvesOfABrainAreMirrorImages) {
  MODULI_NEED_SHARED_MESH(left_path, "brain/nilearn__pial_left.ply");
  MODULI_NEED_SHARED_MESH(right_path, "brain/nilearn__pial_right.ply");
  const auto half = [](const std::string& path) {
    Context context;
    auto prepared = prepareMesh(context, surfaces::read(path), {});
    EXPECT_OK(prepared);
    return mapped(std::move(prepared->mesh));
  };
  const Mapped left = half(left_path), right = half(right_path);
  SphereRegistrationOptions options;
  options.mirror = true;
  const auto mirror = registered(left, right, options);
  const auto plain = registered(left, right);
  ASSERT_OK(mirror);
  ASSERT_OK(plain);
  RecordProperty("mirror", std::to_string(*mirror->correlation_after));
  RecordProperty("plain", std::to_string(*plain->correlation_after));
  EXPECT_GT(*mirror->correlation_after, 0.9);
  EXPECT_GT(*mirror->correlation_after, *plain->correlation_after);
  EXPECT_EQ(mirror->quality.flipped_faces, 0);
}

}  // namespace
}  // namespace moduli
