#include "core/spherical/landmark_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "core/spherical/beltrami_field.h"
#include "core/spherical/mobius_map.h"
#include "tests/core/spherical/sphere_testing.h"

namespace moduli {
namespace {

using surfaces::MappedSurface;

Result<LandmarkMap> met(const MappedSurface& map, const std::vector<Landmark>& landmarks,
                        const LandmarkMapOptions& options = {}) {
  Context context;
  return meetLandmarks(context, map.surface(), map.mesh.edgeLengths(), map.points, landmarks,
                       options);
}

/// All landmarks on their targets, no face turned over, the sphere covered once.
void expectMet(const MappedSurface& map, const std::vector<Landmark>& landmarks,
               const Result<LandmarkMap>& result) {
  ASSERT_OK(result);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector3d there = spherePoint(map.surface(), result->points, landmarks[i].point);
    EXPECT_LT((there - landmarks[i].target).norm(), 1e-12);
    EXPECT_LT(result->distances[i], 1e-12);
  }
  const MapQuality quality =
      measureSphereMap(map.surface(), map.mesh.edgeLengths(), result->points);
  EXPECT_EQ(quality.flipped_faces, 0);
  EXPECT_NEAR(quality.covering_degree, 1, 1e-12);
  EXPECT_EQ(quality.max_dilatation, result->quality.max_dilatation);
  for (const Eigen::Vector3d& p : result->points) EXPECT_NEAR(p.norm(), 1, 1e-15 * 4);
}

double largestMove(const Points3& a, const Points3& b) {
  double worst = 0;
  for (std::size_t v = 0; v < a.size(); ++v) worst = std::max(worst, (a[v] - b[v]).norm());
  return worst;
}

TEST(BeltramiField, IsThatOfALinearMapOfEveryFace) {
  // z + nu conj(z) in the frame of a face.
  const FaceFrame frame{1.3, 0.4, 0.9};
  const std::complex<double> nu(0.3, -0.2), turn = std::polar(2.0, 0.7), apex(0.4, 0.9);
  const auto map = spherical::FaceMap::between(frame, turn * (1.3 + nu * 1.3),
                                               turn * (apex + nu * std::conj(apex)));
  EXPECT_LT(std::abs(map.beltrami() - nu), 1e-15);
  // K = (1 + |mu|) / (1 - |mu|) is what the shapes of the faces say too.
  const Eigen::Vector3d a(0, 0, 0), b(1.3 * 1.3, 1.3 * -0.2, 0);
  const std::complex<double> w = apex + nu * std::conj(apex);
  const FaceFrame bent = spherical::chordFrame(a, b, {w.real(), w.imag(), 0});
  EXPECT_NEAR(dilatation(frame, bent), (1 + std::abs(nu)) / (1 - std::abs(nu)), 1e-14);
}

TEST(BeltramiField, WeightsOfABentFaceAreTheCotangentsOfItsImage) {
  const FaceFrame frame{1.3, 0.4, 0.9};
  const std::complex<double> nu(0.5, 0.3), apex(0.4, 0.9);
  const std::array<std::complex<double>, 3> z = {0.0, 1.3 + nu * 1.3, apex + nu * std::conj(apex)};
  const auto weights = spherical::bentWeights(frame, nu);
  for (int c = 0; c < 3; ++c) {
    const std::complex<double> tip = z[(c + 2) % 3];
    const double angle = std::arg((z[(c + 1) % 3] - tip) / (z[c] - tip));
    EXPECT_NEAR(weights[c], 0.5 / std::tan(angle), 1e-14);
  }
}

TEST(BeltramiField, SmoothingKeepsFieldsThatAreParallelAndDampsTheRest) {
  const MappedSurface map = surfaces::roundSphere(10, 3);
  Context context;
  const auto narrow = spherical::BeltramiField::make(context, map.surface(), map.points, 1e-6, 0);
  const auto wide = spherical::BeltramiField::make(context, map.surface(), map.points, 0.3, 0);
  ASSERT_OK(narrow);
  ASSERT_OK(wide);
  // Stretched along z: a smooth field, which vanishes at the poles to second order.
  Points3 points = map.points;
  for (Eigen::Vector3d& p : points) p = Eigen::Vector3d(p.x(), p.y(), 1.3 * p.z()).normalized();
  const auto mu = narrow->measure(points);
  const auto kept = narrow->smooth(context, mu, 0.9);
  const auto damped = wide->smooth(context, mu, 0.9);
  ASSERT_OK(kept);
  ASSERT_OK(damped);
  double power = 0, kept_power = 0, damped_power = 0, cross = 0;
  for (std::size_t f = 0; f < mu.size(); ++f) {
    const double area = narrow->frames()[f].area();
    EXPECT_LT(std::abs((*kept)[f] - mu[f]), 1e-6);
    power += area * std::norm(mu[f]);
    kept_power += area * std::norm((*kept)[f]);
    damped_power += area * std::norm((*damped)[f]);
    cross += area * (std::conj(mu[f]) * (*damped)[f]).real();
  }
  EXPECT_NEAR(kept_power / power, 1, 1e-6);
  // mu is of degree 2 and spin 2, whose Laplace eigenvalue is 2 * 3 - 4 = 2 (and higher degrees,
  // weakly): smoothing divides it by 1 + 0.09 * 2. In frames that did not fit together the sum over
  // neighbours would cancel and little would be left.
  EXPECT_NEAR(cross / power, 1 / 1.18, 0.02);
  EXPECT_NEAR(std::sqrt(damped_power / power), 1 / 1.18, 0.02);
}

TEST(MeetLandmarks, LeavesAMapAloneThatMeetsThemAlready) {
  const MappedSurface map = surfaces::roundSphere(8, 2);
  std::vector<Landmark> landmarks = surfaces::randomLandmarks(map, 5, 0.3, true, 1);
  for (Landmark& landmark : landmarks) {
    landmark.target = spherePoint(map.surface(), map.points, landmark.point);
  }
  const auto result = met(map, landmarks);
  expectMet(map, landmarks, result);
  EXPECT_EQ(largestMove(result->points, map.points), 0);
  EXPECT_EQ(result->steps, 0);
  EXPECT_LT(result->max_beltrami, 1e-12);
  const auto none = met(map, {});
  ASSERT_OK(none);
  EXPECT_EQ(largestMove(none->points, map.points), 0);
}

TEST(MeetLandmarks, MovesLittleWhereLandmarksMoveLittle) {
  // With the given map's own coefficients nothing moves, so the answer is continuous: the points
  // move by no more than some multiple of the landmarks.
  const MappedSurface map = surfaces::roundSphere(8, 2);
  for (const double angle : {1e-2, 1e-4, 1e-6}) {
    const auto landmarks = surfaces::randomLandmarks(map, 5, angle, true, 1);
    const auto result = met(map, landmarks);
    expectMet(map, landmarks, result);
    EXPECT_LT(largestMove(result->points, map.points), 3 * angle);
    EXPECT_LT(result->max_beltrami, 20 * angle);
  }
}

class RandomLandmarks : public testing::TestWithParam<bool> {};

TEST_P(RandomLandmarks, AreMetWithoutAFold) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const MappedSurface map = surfaces::roundSphere(12, seed + 1);
    const auto landmarks = surfaces::randomLandmarks(map, 6, 0.3, GetParam(), seed);
    const auto result = met(map, landmarks);
    expectMet(map, landmarks, result);
    EXPECT_LT(result->mean_beltrami, 0.25);
    EXPECT_LT(result->max_beltrami, 0.95);
    EXPECT_GE(result->max_beltrami, result->mean_beltrami);
  }
}

TEST_P(RandomLandmarks, AreMetWithoutTheAlignment) {
  const MappedSurface map = surfaces::roundSphere(12, 5);
  const auto landmarks = surfaces::randomLandmarks(map, 6, 0.3, GetParam(), 9);
  LandmarkMapOptions options;
  options.align = false;
  expectMet(map, landmarks, met(map, landmarks, options));
}

INSTANTIATE_TEST_SUITE_P(AtVerticesAndWithinFaces, RandomLandmarks, testing::Bool());

TEST(MeetLandmarks, OneLandmarkCostsARotationHoweverFarItGoes) {
  const MappedSurface map = surfaces::roundSphere(8, 2);
  const auto landmarks = surfaces::randomLandmarks(map, 1, 3, true, 3);
  const auto result = met(map, landmarks);
  expectMet(map, landmarks, result);
  // Rounding of edges of length 0.1.
  EXPECT_LT(result->max_beltrami, 1e-13);
}

TEST(MeetLandmarks, AMobiusMapOfManyLandmarksCostsLittle) {
  const MappedSurface map = surfaces::roundSphere(16, 2);
  auto landmarks = surfaces::randomLandmarks(map, 10, 0.3, true, 3);
  const MobiusMap mobius = {std::exp(0.15), 0, 0, std::exp(-0.15)};
  for (Landmark& landmark : landmarks) {
    landmark.target = mobius(spherePoint(map.surface(), map.points, landmark.point));
  }
  LandmarkMapOptions options;
  options.rotation_preference = 0;
  const auto result = met(map, landmarks, options);
  expectMet(map, landmarks, result);
  // Landmarks within flat faces are off by the second order, (edge 0.07)^2 times the change of the
  // conformal factor, 0.3: a hundredth of an edge. Their faces are bent by that.
  EXPECT_LT(result->mean_beltrami, 0.01);
  EXPECT_LT(result->max_beltrami, 0.1);
}

TEST(MeetLandmarks, CommutesWithRotations) {
  const MappedSurface map = surfaces::roundSphere(8, 4);
  const auto landmarks = surfaces::randomLandmarks(map, 5, 0.3, true, 2);
  const Eigen::Matrix3d turn = surfaces::rotation(8);
  MappedSurface turned = map;
  for (Eigen::Vector3d& p : turned.points) p = (turn * p).normalized();
  auto turned_landmarks = landmarks;
  for (Landmark& landmark : turned_landmarks) landmark.target = turn * landmark.target;
  const auto a = met(map, landmarks), b = met(turned, turned_landmarks);
  expectMet(map, landmarks, a);
  expectMet(turned, turned_landmarks, b);
  Points3 expected = a->points;
  for (Eigen::Vector3d& p : expected) p = turn * p;
  // Rounding, 1e-16, times the condition of a fourth-order operator with edges of 0.13, some 1e5,
  // through a hundred solves.
  EXPECT_LT(largestMove(expected, b->points), 1e-9);
}

TEST(MeetLandmarks, DoesNotDependOnNumbers) {
  const TriangleSoup soup = surfaces::sample("sphere", {{"resolution", 8}, {"seed", 4}});
  const TriangleSoup other = surfaces::renumbered(soup, 6);
  MappedSurface a{surfaces::mesh(soup), soup.vertices}, b{surfaces::mesh(other), other.vertices};
  for (Points3* points : {&a.points, &b.points}) {
    for (Eigen::Vector3d& p : *points) p.normalize();
  }
  const auto landmarks = surfaces::randomLandmarks(a, 5, 0.3, false, 2);
  std::vector<Landmark> renumbered = landmarks;
  for (Landmark& landmark : renumbered) {
    const Eigen::Vector3d p = spherePoint(a.surface(), a.points, landmark.point);
    landmark.point = vertexPoint(b.surface(), surfaces::nearestVertex(b.points, p));
  }
  const auto met_a = met(a, landmarks), met_b = met(b, renumbered);
  expectMet(a, landmarks, met_a);
  expectMet(b, renumbered, met_b);
  for (Index v = 0; v < a.surface().vertexCount(); ++v) {
    const Index w = surfaces::nearestVertex(b.points, a.points[v]);
    EXPECT_LT((met_a->points[v] - met_b->points[w]).norm(), 1e-9);
  }
}

TEST(MeetLandmarks, AgreesBetweenTriangulations) {
  // The same landmarks of the same sphere, by places: the maps differ by the edge length at most.
  std::vector<Points3> images;
  const MappedSurface coarse = surfaces::roundSphere(8, 0);
  const auto landmarks = surfaces::randomLandmarks(coarse, 4, 0.3, false, 12);
  const MappedSurface fine = surfaces::roundSphere(16, 0);
  std::vector<Landmark> same = landmarks;
  for (Landmark& landmark : same) {
    const Eigen::Vector3d p = spherePoint(coarse.surface(), coarse.points, landmark.point);
    const Index v = surfaces::nearestVertex(fine.points, p);
    EXPECT_LT((fine.points[v] - p).norm(), 1e-12);
    landmark.point = vertexPoint(fine.surface(), v);
  }
  const auto a = met(coarse, landmarks), b = met(fine, same);
  ASSERT_OK(a);
  ASSERT_OK(b);
  double worst = 0;
  for (Index v = 0; v < coarse.surface().vertexCount(); ++v) {
    const Index w = surfaces::nearestVertex(fine.points, coarse.points[v]);
    worst = std::max(worst, (a->points[v] - b->points[w]).norm());
  }
  EXPECT_LT(worst, 0.08);
}

TEST(MeetLandmarks, MovesLandmarksOfABrain) {
  MODULI_NEED_SHARED_MESH(path, "brain/nilearn__pial_left.ply");
  const MappedSurface map = surfaces::mappedMesh(path);
  const auto landmarks = surfaces::randomLandmarks(map, 8, 0.3, true, 5);
  const auto result = met(map, landmarks);
  expectMet(map, landmarks, result);
  EXPECT_LT(result->mean_beltrami, 0.25);
}

TEST(MeetLandmarks, NamesLandmarksThatCannotBeMet) {
  const MappedSurface map = surfaces::roundSphere(6, 0);
  const auto good = surfaces::randomLandmarks(map, 3, 0.2, true, 4);
  LandmarkMapOptions fixed;
  fixed.align = false;
  const auto refuses = [&](const std::vector<Landmark>& landmarks, const std::string& words) {
    const auto result = met(map, landmarks, fixed);
    EXPECT_THAT(result, FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(result.status().message(), testing::HasSubstr(words));
  };
  auto bad = good;
  bad[1].point.face = map.surface().faceCount();
  refuses(bad, "landmark 1 is in face");
  bad = good;
  bad[2].point.barycentric = {1.5, -0.5, 0};
  refuses(bad, "landmark 2 leaves its face");
  bad = good;
  bad[2].point.barycentric = {0.5, 0.2, 0};
  refuses(bad, "landmark 2 has corner weights of sum");
  bad = good;
  bad[0].target *= 0.9;
  refuses(bad, "landmark 0 has a target");
  bad = good;
  bad[2].point = bad[0].point;
  refuses(bad, "landmarks 0 and 2 coincide");
  bad = good;
  bad[2].target = bad[1].target;
  refuses(bad, "landmarks 1 and 2 are sent to the same place");
  bad = good;
  bad[0].target = -spherePoint(map.surface(), map.points, bad[0].point);
  refuses(bad, "landmark 0 is sent to the opposite point");
  bad = good;
  bad[0].target = spherePoint(map.surface(), map.points, bad[1].point);
  bad[1].target = spherePoint(map.surface(), map.points, bad[0].point);
  refuses(bad, "landmarks 0 and 1 cross");
}

TEST(MeetLandmarks, NamesTheLandmarkThatFoldsACoarseMesh) {
  // A vertex is sent across the sphere, past five that stay, on a mesh of 42 vertices.
  const MappedSurface map = surfaces::roundSphere(2, 0);
  std::vector<Landmark> landmarks;
  for (const Index v : {0, 1, 2, 3, 4, 5}) {
    landmarks.push_back({vertexPoint(map.surface(), v), map.points[v]});
  }
  surfaces::RandomSphere random(3);
  landmarks[4].target = (-landmarks[4].target + 0.1 * random.direction()).normalized();
  LandmarkMapOptions options;
  options.align = false;
  const auto result = met(map, landmarks, options);
  EXPECT_THAT(result, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(result.status().message(), testing::HasSubstr("landmark"));
}

/// The corners of a face: two stay, the third one goes through between them.
std::vector<Landmark> turnedOver(const MappedSurface& map) {
  const auto& [a, b, c] = map.surface().face(17);
  const Eigen::Vector3d middle = (map.points[a] + map.points[b]).normalized();
  std::vector<Landmark> landmarks;
  for (const Index v : {a, b, c}) {
    landmarks.push_back(
        {vertexPoint(map.surface(), v), map.points[v], "mark " + std::to_string(v)});
  }
  landmarks[2].target = (2 * middle.dot(map.points[c]) * middle - map.points[c]).normalized();
  return landmarks;
}

TEST(MeetLandmarks, NamesTwoThatContradictEachOther) {
  const MappedSurface map = surfaces::roundSphere(8, 0);
  const std::vector<Landmark> landmarks = turnedOver(map);
  LandmarkMapOptions options;
  options.align = false;
  const auto result = met(map, landmarks, options);
  EXPECT_THAT(result, FailsWith(Reason::kFoldedMap));
  const std::string message = result.status().message();
  EXPECT_THAT(message, testing::HasSubstr("contradict each other"));
  const auto named = [&](const Landmark& landmark) {
    return message.find(landmark.name + " ") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(landmarks.begin(), landmarks.end(), named), 2) << message;
}

TEST(MeetLandmarks, GoesAsFarAsItCanWhereThatIsEnough) {
  const MappedSurface map = surfaces::roundSphere(8, 0);
  const std::vector<Landmark> landmarks = turnedOver(map);
  LandmarkMapOptions options;
  options.align = false;
  options.partly = true;
  const auto result = met(map, landmarks, options);
  ASSERT_OK(result);
  EXPECT_EQ(result->quality.flipped_faces, 0);
  EXPECT_GT(result->distances[2], 0.01);
  EXPECT_LT(result->distances[2],
            (landmarks[2].target - map.points[map.surface().face(17)[2]]).norm());
}

TEST(MeetLandmarks, RefusesFoldedMapsAndOpenSurfaces) {
  MappedSurface map = surfaces::roundSphere(4, 0);
  const auto landmarks = surfaces::randomLandmarks(map, 2, 0.2, true, 4);
  for (Eigen::Vector3d& p : map.points) p.x() = -p.x();
  EXPECT_THAT(met(map, landmarks), FailsWith(Reason::kFoldedMap));
  map.points.pop_back();
  EXPECT_THAT(met(map, landmarks), FailsWith(Reason::kInvalidOption));
  LandmarkMapOptions options;
  options.bound = 1;
  EXPECT_THAT(met(map, landmarks, options), FailsWith(Reason::kInvalidOption));
}

TEST(MeetLandmarks, StopsWhenCancelled) {
  const MappedSurface map = surfaces::roundSphere(6, 0);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(meetLandmarks(context, map.surface(), map.mesh.edgeLengths(), map.points,
                            surfaces::randomLandmarks(map, 4, 0.2, true, 4)),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
