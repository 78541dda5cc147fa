#include "core/matching/match_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <set>

#include "core/intrinsic/edge_graph.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "tests/bench/retrieval/deform.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/core/matching/cover_samples.h"
#include "tests/core/matching/lumps.h"
#include "tests/core/matching/matched.h"
#include "tests/core/matching/nearly_symmetric.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

TEST(MatchSurfaces, IsTheIdentityOnARenumberedCopy) {
  const TriangleSoup soup = lump(12, 1);
  // Irregular, so that the triangulation tells: one vertex less.
  const TriangleSoup irregular = simplified(soup, soup.faces.size() - 40);
  const Renumbered other = renumbered(moved(irregular), 4);
  const TriangleMesh a = meshOf(irregular), b = meshOf(other.soup);
  const SurfaceMatch found = match(a, b);
  EXPECT_EQ(found.method, MatchMethod::kSameTriangulation);
  EXPECT_LE(errors(found, b, carried(other)).back(), 1e-12);
  EXPECT_LE(found.distance, 1e-7);  // The root of rounding.
  EXPECT_EQ(found.report.folded_faces, 0);
  EXPECT_LE(found.cycle_error, 1e-12);
}

TEST(MatchSurfaces, NeedsNoCommonTriangulation) {
  // 0.06 and 0.05 an edge: a fifth of one is what a map made of points can hope for.
  const TriangleMesh a = meshOf(lump(16, 1)), b = meshOf(moved(lump(19, 2)));
  const SurfaceMatch found = match(a, b);
  EXPECT_EQ(found.method, MatchMethod::kNearIsometry);
  const auto error = errors(found, b, moved(lump(16, 1)).vertices);
  EXPECT_LE(mean(error), 0.01);
  EXPECT_LE(error.back(), 0.06);
  EXPECT_EQ(found.report.folded_faces, 0);
  EXPECT_LE(found.distance, 0.05);
  // There and back: two maps that are linear on faces which are not each other's.
  EXPECT_LE(found.cycle_error, 0.005);
}

// By what stands for them: as near as their own modes would lead. Edges of the surfaces are 0.03
// and 0.025 long, and a fifth of one is what a map made of points can hope for.
TEST(MatchSurfaces, FindsItsWayBackFromThinnedSurfaces) {
  const TriangleSoup from = lump(28, 1), to = lump(31, 2);
  const TriangleMesh a = meshOf(from), b = meshOf(moved(to));
  ASSERT_GT(std::min(a.vertexCount(), b.vertexCount()), 7500);
  const SurfaceMatch found = match(a, b);
  EXPECT_EQ(found.method, MatchMethod::kNearIsometry);
  const auto error = errors(found, b, moved(from).vertices);
  std::cout << a.vertexCount() << " vertices: mean error " << mean(error) << ", largest "
            << error.back() << ", distance " << found.distance << "\n";
  EXPECT_LE(mean(error), 0.005);
  EXPECT_LE(error.back(), 0.03);
  EXPECT_EQ(found.report.folded_faces, 0);
  EXPECT_LE(found.cycle_error, 0.002);
}

TEST(MatchSurfaces, FindsItsWayBackFromThinnedTori) {
  const TriangleMesh a = meshOf(lumpyTorus(64, 1)), b = meshOf(lumpyTorus(68, 2));
  ASSERT_GT(std::min(a.vertexCount(), b.vertexCount()), 7500);
  const SurfaceMatch found = match(a, b, surfacesAlone());
  const auto error = errors(found, b, a.positions());
  std::cout << a.vertexCount() << " vertices: mean error " << mean(error) << ", largest "
            << error.back() << ", distance " << found.distance << "\n";
  EXPECT_LE(mean(error), 0.01);  // Two bumps hardly keep a torus from turning within itself.
  EXPECT_LE(error.back(), 0.03);
  EXPECT_EQ(found.report.folded_faces, 0);
  EXPECT_LE(found.cycle_error, 0.002);
}

TEST(MatchSurfaces, MatchesThinnedInversionsOfSpace) {
  SampleRandom random(3);
  const TriangleSoup soup = lump(28, 1), other = inverted(soup, 0.5, random);
  const TriangleMesh a = meshOf(soup), b = meshOf(other);
  ASSERT_GT(a.vertexCount(), 7500);
  const SurfaceMatch found = match(a, b, surfacesAlone());
  EXPECT_EQ(found.method, MatchMethod::kMobius);
  const auto error = errors(found, b, b.positions());
  std::cout << "inverted: mean error " << mean(error) << ", largest " << error.back() << "\n";
  EXPECT_LE(mean(error), 0.005);
  EXPECT_EQ(found.report.folded_faces, 0);
}

TEST(MatchSurfaces, DoesNotDependOnNumbersPlaceAndSize) {
  const TriangleSoup soup = lump(12, 1);
  const Renumbered first = renumbered(soup, 8), second = renumbered(moved(lump(13, 2)), 9);
  const TriangleMesh a = meshOf(soup), b = meshOf(moved(lump(13, 2)));
  const TriangleMesh x = meshOf(first.soup), y = meshOf(second.soup);
  const SurfaceMatch one = match(a, b), other = match(x, y);
  EXPECT_NEAR(one.distance, other.distance, 0.01);
  double largest = 0;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    const Vector3d p = spacePoint(b.connectivity(), b.positions(), one.images[v]);
    const Vector3d q = spacePoint(y.connectivity(), y.positions(), other.images[first.image[v]]);
    largest = std::max(largest, (p - q).norm() / std::sqrt(b.area()));
  }
  // Samples begin with the vertex that comes first among equals; the rest follows. An edge has
  // 0.07.
  EXPECT_LE(largest, 0.07);
}

TEST(MatchSurfaces, TurnsOverForAMirrorImage) {
  const TriangleMesh a = meshOf(lump(14, 1)), b = meshOf(mirrored(lump(16, 2)));
  MatchOptions options;
  options.mirror = true;
  const SurfaceMatch found = match(a, b, options);
  const auto error = errors(found, b, mirrored(lump(14, 1)).vertices);
  EXPECT_LE(mean(error), 0.012);
  EXPECT_EQ(found.report.folded_faces, 0);
  EXPECT_LE(found.cycle_error, 0.006);
}

TEST(MatchSurfaces, MeetsTheVerticesOfAMirroredCopy) {
  // Exactly: a corner for another is an edge's length.
  const TriangleSoup soup = lump(12, 1);
  const TriangleSoup irregular = simplified(soup, soup.faces.size() - 40);
  const Renumbered other = renumbered(mirrored(irregular), 4);
  const TriangleMesh a = meshOf(irregular), b = meshOf(other.soup);
  MatchOptions options;
  options.mirror = true;
  const SurfaceMatch found = match(a, b, options);
  EXPECT_EQ(found.method, MatchMethod::kSameTriangulation);
  EXPECT_LE(errors(found, b, carried(other)).back(), 1e-12);
}

TEST(MatchSurfaces, MatchesAnInversionOfSpaceConformally) {
  const TriangleSoup soup = lump(24, 1);
  SampleRandom random(3);
  const Renumbered other = renumbered(inverted(soup, 0.5, random), 5);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SurfaceMatch found = match(a, b, surfacesAlone());
  EXPECT_EQ(found.method, MatchMethod::kMobius);
  EXPECT_LE(mean(errors(found, b, carried(other))), 0.01);
  EXPECT_LE(found.report.mean_dilatation, 1.1);
  EXPECT_GT(found.distance, 0.1);  // Sizes change.
  EXPECT_EQ(found.report.folded_faces, 0);
}

TEST(MatchSurfaces, MeetsLandmarks) {
  const TriangleMesh a = meshOf(lump(14, 1)), b = meshOf(lump(16, 2));
  MatchOptions options;
  // Some vertex near where it belongs, a few edges off.
  for (const Index v : {10, 200, 700}) {
    Index nearest = 0;
    for (Index w = 0; w < b.vertexCount(); ++w) {
      if ((b.positions()[w] - a.positions()[v] - Vector3d(0.1, 0, 0)).norm() <
          (b.positions()[nearest] - a.positions()[v] - Vector3d(0.1, 0, 0)).norm()) {
        nearest = w;
      }
    }
    options.landmarks.push_back(
        {vertexPoint(a.connectivity(), v), vertexPoint(b.connectivity(), nearest), "a mark"});
  }
  const SurfaceMatch found = match(a, b, options);
  ASSERT_TRUE(found.landmark_error);
  EXPECT_LE(*found.landmark_error, 1e-9);
  EXPECT_EQ(found.report.folded_faces, 0);
  MatchOptions wrong;
  wrong.landmarks.push_back({{a.faceCount(), {1, 0, 0}}, {0, {1, 0, 0}}, "marks.txt:1"});
  Context context;
  const auto refused = matchSurfaces(context, a, b, wrong);
  EXPECT_THAT(refused, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(refused.status().message(), testing::HasSubstr("marks.txt:1"));
}

TEST(MatchSurfaces, NamesTopologiesThatDiffer) {
  const TriangleMesh sphere = meshOf(lump(6, 1));
  const TriangleMesh torus = meshOf(*makeSample("torus", {{"R", 2}, {"r", 1}, {"resolution", 8}}));
  const TriangleMesh disk = meshOf(*makeSample("disk", {{"resolution", 6}}));
  Context context;
  const auto handle = matchSurfaces(context, sphere, torus);
  EXPECT_THAT(handle, FailsWith(Reason::kUnsupportedTopology));
  EXPECT_THAT(handle.status().message(),
              testing::HasSubstr("genus 0, closed, and genus 1, closed"));
  const auto hole = matchSurfaces(context, sphere, disk);
  EXPECT_THAT(hole.status().message(), testing::HasSubstr("genus 0 with 1 boundary loop"));
  EXPECT_THAT(hole.status().hint(), testing::HasSubstr("--fill-holes"));
}

// A plate with three holes, without its mirror symmetry.
TEST(MatchSurfaces, MapsBoundariesOntoEachOther) {
  TriangleSoup soup = *makeSample("plate", {{"holes", 3}, {"resolution", 4}, {"seed", 2}});
  for (Vector3d& p : soup.vertices) {
    p[2] = 0.3 * std::sin(p[0]) + 0.05 * p[0] * p[1];
    p[1] *= 1 + 0.08 * p[0];
  }
  const TriangleMesh a = meshOf(soup);
  const Renumbered other = renumbered(moved(soup), 5);
  const TriangleMesh b = meshOf(other.soup);
  const SurfaceMatch found = match(a, b, surfacesAlone());
  EXPECT_LT(mean(errors(found, b, carried(other))), 0.01);  // Edges are 0.04 long.
  EXPECT_EQ(found.report.folded_faces, 0);
  const auto boundaryVertices = [](const TriangleMesh& from, const TriangleMesh& to,
                                   const std::vector<SurfacePoint>& images) {
    for (Index v = 0; v < from.vertexCount(); ++v) {
      if (!from.connectivity().isBoundaryVertex(v)) continue;
      const auto& [face, weights] = images.at(v);
      const auto least = std::min_element(weights.begin(), weights.end());
      EXPECT_EQ(*least, 0);
      bool on = false;
      for (int c = 0; c < 3; ++c) {
        const bool whole = weights[(c + 2) % 3] == 0;
        on = on || (whole && to.connectivity().twin(3 * face + c) == kNone) ||
             (weights[c] == 1 &&
              to.connectivity().isBoundaryVertex(to.connectivity().face(face)[c]));
      }
      EXPECT_TRUE(on) << v;
    }
  };
  boundaryVertices(a, b, found.images);
  boundaryVertices(b, a, found.inverse);
}

// An ellipsoid of three different axes: half turns about each of them are symmetries.
TriangleMesh ellipsoid(double resolution, double seed) {
  return meshOf(
      *makeSample("ellipsoid",
                  {{"a", 1}, {"b", 0.7}, {"c", 0.45}, {"resolution", resolution}, {"seed", seed}}));
}

Index nearestVertex(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  Index nearest = 0;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const double distance = (mesh.positions()[v] - point).norm();
    if (distance < (mesh.positions()[nearest] - point).norm()) nearest = v;
  }
  return nearest;
}

// An ellipsoid with a small hole off its planes of symmetry: four half turns are nearly as good.
TriangleMesh punctured(int resolution, int seed) {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", static_cast<double>(resolution)},
                                             {"seed", static_cast<double>(seed)}});
  const Vector3d where = Vector3d(0.6, 0.5, 0.6).normalized();
  std::erase_if(soup.faces, [&](const Triangle& face) {
    return ((soup.vertices[face[0]] + soup.vertices[face[1]] + soup.vertices[face[2]]) / 3 - where)
               .norm() < 0.15;
  });
  for (Vector3d& p : soup.vertices) p = p.cwiseProduct(Vector3d(1.5, 1, 0.7));
  Context context;
  return prepareMesh(context, soup, {})->mesh;
}

TEST(MatchSurfaces, LetsBoundariesDecideBetweenSymmetricAnswers) {
  for (int seed = 1; seed <= 4; ++seed) {
    const TriangleMesh a = punctured(10, seed), b = punctured(11, seed + 10);
    const SurfaceMatch found = match(a, b);
    EXPECT_EQ(found.report.folded_faces, 0);
    // Wrong answers are off by a fourth of the size and more. Boundaries are zigzags of edges, 0.1
    // long over a root of the area of 3.6: the map may be off by one, and less far from them.
    EXPECT_LE(mean(errors(found, b, a.positions())), 0.03) << seed;
  }
}

/// other: an ellipsoid, too.
void expectLandmarksToDecide(const TriangleMesh& mesh, const TriangleMesh& other) {
  // Beside all planes of symmetry.
  const Index from = nearestVertex(mesh, {0.6, 0.4, 0.2});
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, -1, -1),
                                      Eigen::Vector3d(-1, 1, -1), Eigen::Vector3d(-1, -1, 1)}) {
    MatchOptions options = surfacesAlone();
    const Index to = nearestVertex(other, mesh.positions()[from].cwiseProduct(turn));
    options.landmarks = {
        {vertexPoint(mesh.connectivity(), from), vertexPoint(other.connectivity(), to), "one"}};
    const SurfaceMatch found = match(mesh, other, options);
    EXPECT_LT(*found.landmark_error, 1e-9);
    EXPECT_EQ(found.report.folded_faces, 0);
    double mean = 0;
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      mean += (spacePoint(other.connectivity(), other.positions(), found.images[v]) -
               mesh.positions()[v].cwiseProduct(turn))
                  .norm() /
              mesh.vertexCount();
    }
    // The landmark itself is off by up to an edge, 0.15 at these resolutions.
    EXPECT_LT(mean, 0.15) << turn.transpose();
  }
}

TEST(MatchSurfaces, LetsLandmarksDecideBetweenSymmetricAnswers) {
  expectLandmarksToDecide(ellipsoid(10, 3), ellipsoid(11, 5));
}

TEST(MatchSurfaces, LetsLandmarksTurnASurfaceOntoItself) {
  // Though the identity fits incomparably better.
  const TriangleMesh mesh = ellipsoid(10, 3);
  expectLandmarksToDecide(mesh, mesh);
}

TEST(MatchSurfaces, GivesEachAnswerOfASymmetricSurface) {
  const TriangleMesh mesh = ellipsoid(10, 3), other = ellipsoid(11, 5);
  MatchOptions options = surfacesAlone();
  const SurfaceMatch best = match(mesh, other, options);
  ASSERT_GE(best.alternatives.size(), 3U);
  // Which halves go to which.
  std::set<std::array<bool, 3>> turns;
  const auto count = static_cast<int>(best.alternatives.size()) + 1;
  for (options.alternative = 0; options.alternative < count; ++options.alternative) {
    const SurfaceMatch found = match(mesh, other, options);
    EXPECT_EQ(found.alternatives.size(), best.alternatives.size());
    EXPECT_EQ(found.report.folded_faces, 0);
    Eigen::Vector3d agreement = Eigen::Vector3d::Zero();
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      agreement += spacePoint(other.connectivity(), other.positions(), found.images[v])
                       .cwiseProduct(mesh.positions()[v]);
    }
    if (found.distance < 0.1) {
      turns.insert({agreement[0] > 0, agreement[1] > 0, agreement[2] > 0});
    }
  }
  const std::set<std::array<bool, 3>> symmetries = {
      {true, true, true}, {true, false, false}, {false, true, false}, {false, false, true}};
  EXPECT_EQ(turns, symmetries);
  Context context;
  options.alternative = 1000;
  const auto none = matchSurfaces(context, mesh, other, options);
  EXPECT_THAT(none, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(none.status().message(), testing::HasSubstr("answer 1000"));
}

// A bump of a twentieth alone tells it from its half turns, by which it would be off by half of its
// width. One surface for every resolution and seed.
TEST(MatchSurfaces, KnowsANearlySymmetricSurfaceFromItsTurns) {
  for (const int seed : {1, 3, 5}) {
    const TriangleMesh a = kEgg.mesh(10, seed, 0.05), b = kEgg.mesh(12, seed + 1, 0.05);
    std::vector<Vector3d> truth;
    for (const Vector3d& p : kEgg.base(10, seed).vertices) truth.push_back(kEgg(p, 0.05));
    const SurfaceMatch found = match(a, b, surfacesAlone());
    EXPECT_EQ(found.report.folded_faces, 0);
    const double error = mean(errors(found, b, truth));
    std::cout << "seed " << seed << ": mean error " << error << '\n';
    EXPECT_LT(error, 0.02);  // Half an edge.
  }
}

/// An egg with two bumps, low and wide.
TriangleSoup bumpyEgg() {
  TriangleSoup soup = *makeSample("sphere", {{"resolution", 7}, {"seed", 1}});
  for (Vector3d& p : soup.vertices) {
    const auto bump = [&](const Vector3d& where) {
      return std::exp(-(p - where).squaredNorm() / 0.2);
    };
    const double height = 0.3 * bump({0.8, 0, 0.6}) + 0.18 * bump({-0.5, 0.75, -0.4});
    p = (1 + height) * Vector3d(p[0], p[1], 1.5 * p[2]);
  }
  return soup;
}

// Smoothed, it lies on what is made of it by a turn of a limb. The modes' places are far from
// there: they take it for its copy, off by an eighth of its size.
TEST(MatchSurfaces, TakesNearShapesFarFromTheModesByWhatTheyChange) {
  const TriangleSoup soup = bumpyEgg();
  SampleRandom random(1);
  const TriangleSoup posed = articulated(soup, random);
  const TriangleMesh a = meshOf(soup), b = meshOf(simplified(posed, posed.faces.size() * 7 / 10));
  const SurfaceMatch found = match(a, b, surfacesAlone());
  EXPECT_EQ(found.method, MatchMethod::kShape);
  EXPECT_EQ(found.report.folded_faces, 0);
  const double error = mean(errors(found, b, posed.vertices));
  std::cout << "mean error " << error << '\n';
  EXPECT_LT(error, 0.05);  // An edge; by the modes it is .13.
}

// Tori of revolution have tau = i r / sqrt(R^2 - r^2): the distance of i s and i t is |log(s / t)|
// / 2 (CHECKS B, MATH 12.12), here by metrics of second order.
TEST(MatchSurfaces, TellsTheTeichmuellerDistanceOfTori) {
  const auto torus = [](double r) {
    return meshOf(*makeSample("torus", {{"R", 2}, {"r", r}, {"resolution", 24}, {"seed", 2}}));
  };
  const SurfaceMatch found = match(torus(0.8), torus(0.9), surfacesAlone());
  const auto height = [](double r) { return r / std::sqrt(4 - r * r); };
  ASSERT_TRUE(found.teichmuller_distance);
  EXPECT_NEAR(*found.teichmuller_distance, std::log(height(0.9) / height(0.8)) / 2, 0.005);
  EXPECT_FALSE(match(meshOf(lump(6, 1)), meshOf(lump(6, 1))).teichmuller_distance);
}

TEST(MatchSurfaces, StopsWhenCancelled) {
  const TriangleMesh a = meshOf(lump(8, 1)), b = meshOf(lump(9, 2));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(matchSurfaces(context, a, b), FailsWith(Reason::kCancelled));
}

/// Vertices of a far from each other, and the vertices of b `off` (in roots of the area) from where
/// they belong; inside the faces there, if so wanted.
std::vector<MatchLandmark> landmarksOf(const TriangleMesh& a, const TriangleMesh& b,
                                       const std::vector<Vector3d>& truth, double off,
                                       bool within) {
  const EdgeGraph own(a.connectivity(), a.edgeLengths()), other(b.connectivity(), b.edgeLengths());
  std::vector<MatchLandmark> landmarks;
  for (const Index v : own.farthestSamples({}, 6).vertices) {
    Index nearest = 0;
    for (Index w = 0; w < b.vertexCount(); ++w) {
      if ((b.positions()[w] - truth[v]).norm() < (b.positions()[nearest] - truth[v]).norm()) {
        nearest = w;
      }
    }
    const Index to = other.within(nearest, off * std::sqrt(b.area())).back().first;
    landmarks.push_back({vertexPoint(a.connectivity(), v), vertexPoint(b.connectivity(), to),
                         "marks.txt:" + std::to_string(landmarks.size() + 1)});
    if (!within) continue;
    landmarks.back().a.barycentric = {0.5, 0.3, 0.2};
    landmarks.back().b.barycentric = {0.1, 0.3, 0.6};
  }
  return landmarks;
}

class LandmarksOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(RealMeshes, LandmarksOf,
                         testing::Values("closed_g0/alec__homer.obj", "genus1/ceaedf__Kitten.off",
                                         "genus3plus/libigl-data__fertility.off"));

TEST_P(LandmarksOf, AreMetAndSoftOnesDrawTheMap) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const TriangleSoup soup = *readMeshFile(context, path);
  SampleRandom random(2);
  const TriangleSoup posed = articulated(soup, random);
  const TriangleMesh a = meshOf(soup), b = meshOf(simplified(posed, posed.faces.size() * 7 / 10));
  const auto landmarks = landmarksOf(a, b, posed.vertices, 0.04, true);
  MatchOptions exact, soft;
  exact.landmarks = landmarks;
  soft.soft_landmarks = landmarks;
  const SurfaceMatch met = match(a, b, exact), drawn = match(a, b, soft);
  ASSERT_TRUE(met.landmark_error);
  EXPECT_LE(*met.landmark_error, 1e-9);
  EXPECT_FALSE(met.soft_landmark_error);
  EXPECT_EQ(met.report.folded_faces, 0);
  EXPECT_LE(met.cycle_error, 0.006);
  EXPECT_LE(mean(errors(met, b, posed.vertices)), 0.05);
  // Drawn most of the way, and nearer to keeping lengths.
  ASSERT_TRUE(drawn.soft_landmark_error);
  EXPECT_FALSE(drawn.landmark_error);
  std::cout << GetParam() << ": soft error " << *drawn.soft_landmark_error << ", distances "
            << met.distance << " and " << drawn.distance << "\n";
  EXPECT_GT(*drawn.soft_landmark_error, 1e-6);
  EXPECT_LT(*drawn.soft_landmark_error, 0.04);
  EXPECT_EQ(drawn.report.folded_faces, 0);
  EXPECT_LT(drawn.distance, met.distance);
}

TEST(MatchSurfaces, MeetsLandmarksInAMirrorImageOfASurfaceWithHandles) {
  const TriangleSoup soup = lumpyPlate(6, 2);
  const TriangleMesh a = meshOf(soup), b = meshOf(mirrored(soup));
  MatchOptions options = surfacesAlone();
  options.mirror = true;
  options.landmarks = landmarksOf(a, b, mirrored(soup).vertices, 0.03, true);
  const SurfaceMatch found = match(a, b, options);
  ASSERT_TRUE(found.landmark_error);
  EXPECT_LE(*found.landmark_error, 1e-9);
  EXPECT_EQ(found.report.folded_faces, 0);
}

TEST(MatchSurfaces, NamesLandmarksThatContradictEachOther) {
  for (const TriangleSoup& soup : {lump(12, 1), lumpyPlate(6, 2)}) {
    const TriangleMesh mesh = meshOf(soup);
    const Connectivity& surface = mesh.connectivity();
    const auto& [p, q, r] = surface.face(60);
    const Index beyond = surface.head(Connectivity::next(surface.twin(3 * 60)));
    MatchOptions options;
    for (const auto& [from, to] : {std::pair(p, p), std::pair(q, q), std::pair(r, beyond)}) {
      options.landmarks.push_back({vertexPoint(surface, from), vertexPoint(surface, to),
                                   "marks.txt:" + std::to_string(options.landmarks.size() + 1)});
    }
    Context context;
    const auto folded = matchSurfaces(context, mesh, mesh, options);
    EXPECT_THAT(folded, FailsWith(Reason::kFoldedMap));
    EXPECT_THAT(folded.status().message(),
                testing::ContainsRegex("marks.txt:[12] and marks.txt:[23] contradict each other"));
    // As soft ones they may be missed.
    std::swap(options.landmarks, options.soft_landmarks);
    EXPECT_EQ(match(mesh, mesh, options).report.folded_faces, 0);
    std::swap(options.landmarks, options.soft_landmarks);
    options.landmarks[1].b = options.landmarks[0].b;
    const auto same = matchSurfaces(context, mesh, mesh, options);
    EXPECT_THAT(same, FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(same.status().message(), testing::HasSubstr("marks.txt:1 and marks.txt:2"));
  }
}

}  // namespace
}  // namespace moduli
