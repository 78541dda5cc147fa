#include "core/matching/match_disks.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>
#include <string>

#include "core/mesh/read.h"
#include "tests/bench/retrieval/deform.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/core/matching/disk_samples.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

TriangleMesh meshOf(const TriangleSoup& soup) {
  return *TriangleMesh::fromSoup(soup);
}

/// By the surfaces, not by their triangulations.
SurfaceMatch match(const TriangleMesh& a, const TriangleMesh& b, MatchOptions options = {}) {
  options.same_triangulation = false;
  Context context;
  auto found = matchSurfaces(context, a, b, options);
  EXPECT_OK(found);
  return found.ok() ? *std::move(found) : SurfaceMatch();
}

std::vector<Vector3d> places(const std::vector<SurfacePoint>& points, const TriangleMesh& mesh) {
  std::vector<Vector3d> result;
  for (const SurfacePoint& point : points) {
    result.push_back(spacePoint(mesh.connectivity(), mesh.positions(), point));
  }
  return result;
}

/// Mean distance from where images should be, over the root of the area.
double meanError(const SurfaceMatch& found, const TriangleMesh& b,
                 const std::vector<Vector3d>& truth) {
  const std::vector<Vector3d> there = places(found.images, b);
  double sum = 0;
  for (std::size_t v = 0; v < truth.size(); ++v) sum += (there[v] - truth[v]).norm();
  return sum / static_cast<double>(truth.size()) / std::sqrt(b.area());
}

std::vector<Vector3d> carried(const Renumbered& other) {
  std::vector<Vector3d> truth;
  for (const Index v : other.image) truth.push_back(other.soup.vertices[v]);
  return truth;
}

/// The edge of the boundary that a point is on, to the last bit; kNone where there is none.
Index rimEdge(const Connectivity& surface, const SurfacePoint& point) {
  for (int c = 0; c < 3; ++c) {
    const Index h = 3 * point.face + c;
    if (point.barycentric[(c + 2) % 3] == 0 && surface.twin(h) == kNone) return h;
  }
  return kNone;
}

/// The boundary onto the boundary, in order and once around, and nothing else there.
void expectRimOntoRim(const TriangleMesh& a, const TriangleMesh& b,
                      const std::vector<SurfacePoint>& images) {
  const Connectivity &from = a.connectivity(), &to = b.connectivity();
  std::vector<double> begin(to.halfedgeCount(), 0);  // Of edges of the boundary, along it.
  double length = 0;
  Index first = 0;
  while (to.twin(first) != kNone) ++first;
  Index h = first;
  do {
    begin[h] = length;
    length += (b.positions()[to.head(h)] - b.positions()[to.tail(h)]).norm();
    h = to.outgoing(to.head(h));
  } while (h != first);
  const auto place = [&](Index v) {
    const Index edge = rimEdge(to, images[v]);
    return begin[edge] + images[v].barycentric[(edge + 1) % 3] *
                             (b.positions()[to.head(edge)] - b.positions()[to.tail(edge)]).norm();
  };
  double around = 0;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    if (!from.isBoundaryVertex(v)) continue;
    ASSERT_NE(rimEdge(to, images[v]), kNone) << "vertex " << v;
    const Index next = from.head(from.outgoing(v));
    double step = place(next) - place(v);
    if (step < -length / 2) step += length;
    if (step > length / 2) step -= length;
    EXPECT_GE(step, -1e-12 * length);
    around += step;
  }
  EXPECT_NEAR(around, length, 1e-9 * length);
}

/// Both ways; and the images cover all of b once: the areas of the images' faces, in space, make up
/// its area but for what the triangles cut off.
void expectOneToOne(const TriangleMesh& a, const TriangleMesh& b, const SurfaceMatch& found,
                    double cut_off) {
  expectRimOntoRim(a, b, found.images);
  expectRimOntoRim(b, a, found.inverse);
  EXPECT_EQ(found.report.folded_faces, 0);
  EXPECT_TRUE(std::isfinite(found.report.max_dilatation));
  const std::vector<Vector3d> there = places(found.images, b);
  double area = 0;
  for (const auto& [p, q, r] : a.connectivity().faces()) {
    area += (there[q] - there[p]).cross(there[r] - there[p]).norm() / 2;
  }
  EXPECT_NEAR(area / b.area(), 1, cut_off);
}

TEST(MatchDisks, NeedsNoCommonTriangulation) {
  // 0.05 and 0.04 an edge, beside the root of the area.
  const TriangleMesh a = meshOf(shield(14, 1)), b = meshOf(moved(shield(17, 2)));
  const SurfaceMatch found = match(a, b);
  EXPECT_EQ(found.method, MatchMethod::kNearIsometry);
  EXPECT_LE(meanError(found, b, moved(shield(14, 1)).vertices), 0.01);
  EXPECT_LE(found.cycle_error, 0.005);
  EXPECT_LE(found.distance, 0.06);
  expectOneToOne(a, b, found, 0.02);
}

TEST(MatchDisks, FindsARenumberedCopyBySurfaceAlone) {
  const TriangleSoup soup = shield(12, 3);
  const Renumbered other = renumbered(moved(soup), 4);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SurfaceMatch found = match(a, b);
  EXPECT_LE(meanError(found, b, carried(other)), 1e-6);
  EXPECT_LE(found.distance, 1e-4);
  expectOneToOne(a, b, found, 1e-4);
}

TEST(MatchDisks, TakesTheTriangulationWhereItTells) {
  const TriangleSoup soup = simplified(shield(12, 3), 700);
  const Renumbered other = renumbered(moved(soup), 4);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  Context context;
  const auto found = matchSurfaces(context, a, b);
  ASSERT_OK(found);
  EXPECT_EQ(found->method, MatchMethod::kSameTriangulation);
  EXPECT_LE(meanError(*found, b, carried(other)), 1e-12);
}

TEST(MatchDisks, FollowsABentCopy) {
  SampleRandom random(3);
  const TriangleSoup soup = shield(16, 1), posed = bent(soup, 1.5, 0.1, random);
  const TriangleMesh a = meshOf(soup), b = meshOf(simplified(posed, posed.faces.size() * 7 / 10));
  const SurfaceMatch found = match(a, b);
  EXPECT_LE(meanError(found, b, posed.vertices), 0.01);
  expectOneToOne(a, b, found, 0.02);
}

TEST(MatchDisks, TurnsOverForAMirrorImage) {
  const TriangleMesh a = meshOf(shield(14, 1)), b = meshOf(mirrored(shield(16, 2)));
  MatchOptions options;
  options.mirror = true;
  const SurfaceMatch found = match(a, b, options);
  EXPECT_LE(meanError(found, b, mirrored(shield(14, 1)).vertices), 0.01);
  EXPECT_LE(found.cycle_error, 0.006);
  for (Index v = 0; v < a.vertexCount(); ++v) {
    if (!a.connectivity().isBoundaryVertex(v)) continue;
    EXPECT_NE(rimEdge(b.connectivity(), found.images[v]), kNone);
  }
}

TEST(MatchDisks, MatchesAnInversionOfSpaceConformally) {
  const TriangleSoup soup = shield(20, 1);
  SampleRandom random(3);
  const Renumbered other = renumbered(inverted(soup, 0.5, random), 5);
  const TriangleMesh a = meshOf(soup), b = meshOf(other.soup);
  const SurfaceMatch found = match(a, b);
  EXPECT_EQ(found.method, MatchMethod::kMobius);
  EXPECT_LE(meanError(found, b, carried(other)), 0.005);
  EXPECT_LE(found.report.mean_dilatation, 1.1);
  expectOneToOne(a, b, found, 0.02);
}

TEST(MatchDisks, MapsSurfacesWithoutInnerVertices) {
  const TriangleMesh a = meshOf(strip(30)), b = meshOf(moved(strip(30)));
  const SurfaceMatch found = match(a, b);
  EXPECT_LE(meanError(found, b, moved(strip(30)).vertices), 1e-6);
  expectOneToOne(a, b, found, 1e-4);
}

TEST(MatchDisks, DoesNotDependOnNumbersPlaceAndSize) {
  const TriangleSoup soup = shield(12, 1), second = moved(shield(13, 2));
  const Renumbered first = renumbered(soup, 8), last = renumbered(second, 9);
  const TriangleMesh a = meshOf(soup), b = meshOf(second), x = meshOf(first.soup),
                     y = meshOf(last.soup);
  const std::vector<Vector3d> one = places(match(a, b).images, b),
                              other = places(match(x, y).images, y);
  double largest = 0;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    largest = std::max(largest, (one[v] - other[first.image[v]]).norm() / std::sqrt(b.area()));
  }
  // As for spheres: samples begin with the vertex that comes first among equals. An edge has 0.06.
  EXPECT_LE(largest, 0.06);
}

/// Marks at some vertices, in a face, on the boundary; each sent some edges off.
TEST(MatchDisks, MeetsLandmarks) {
  const TriangleMesh a = meshOf(shield(14, 1)), b = meshOf(shield(16, 2));
  const auto nearest = [&](const Vector3d& p, bool on_rim) {
    Index best = kNone;
    for (Index w = 0; w < b.vertexCount(); ++w) {
      if (b.connectivity().isBoundaryVertex(w) != on_rim) continue;
      if (best == kNone || (b.positions()[w] - p).norm() < (b.positions()[best] - p).norm()) {
        best = w;
      }
    }
    return vertexPoint(b.connectivity(), best);
  };
  MatchOptions options;
  for (const Index v : {10, 200, 400, 610}) {
    const bool on_rim = a.connectivity().isBoundaryVertex(v);
    options.landmarks.push_back({vertexPoint(a.connectivity(), v),
                                 nearest(a.positions()[v] + Vector3d(0.1, 0, 0), on_rim),
                                 "a mark"});
  }
  int on_rim = 0;
  for (Index v = 0; v < a.vertexCount(); v += 40) {
    if (!a.connectivity().isBoundaryVertex(v)) continue;
    ++on_rim;
    options.landmarks.push_back({vertexPoint(a.connectivity(), v),
                                 nearest(a.positions()[v] + Vector3d(0.05, 0.05, 0), true),
                                 "a mark"});
  }
  ASSERT_GT(on_rim, 0);
  const SurfaceMatch found = match(a, b, options);
  ASSERT_TRUE(found.landmark_error);
  EXPECT_LE(*found.landmark_error, 1e-12);
  expectOneToOne(a, b, found, 0.03);
}

TEST(MatchDisks, MeetsLandmarksInFacesAndOnEdges) {
  const TriangleMesh a = meshOf(shield(14, 1)), b = meshOf(shield(16, 2));
  Index rim = 0, other = 0;
  while (a.connectivity().twin(rim) != kNone) ++rim;
  const Vector3d p = a.positions()[a.connectivity().tail(rim)];
  double least = 1e300;
  for (Index h = 0; h < b.connectivity().halfedgeCount(); ++h) {
    const double distance = (b.positions()[b.connectivity().tail(h)] - p).norm();
    if (b.connectivity().twin(h) != kNone || !(distance < least)) continue;
    least = distance;
    other = h;
  }
  MatchOptions options;
  options.landmarks.push_back({edgePoint(rim, 0.4), edgePoint(other, 0.6), "on the boundary"});
  const SurfaceMatch found = match(a, b, options);
  // The mark is met by a vertex put there.
  ASSERT_TRUE(found.landmark_error);
  EXPECT_LE(*found.landmark_error, 1e-9);
  expectOneToOne(a, b, found, 0.03);
}

TEST(MatchDisks, NamesALandmarkThatLeavesTheBoundary) {
  const TriangleMesh a = meshOf(shield(8, 1)), b = meshOf(shield(9, 2));
  Index rim = 0, inside = 0;
  while (!a.connectivity().isBoundaryVertex(rim)) ++rim;
  while (b.connectivity().isBoundaryVertex(inside)) ++inside;
  MatchOptions options;
  options.landmarks.push_back(
      {vertexPoint(a.connectivity(), rim), vertexPoint(b.connectivity(), inside), "marks.txt:7"});
  Context context;
  const auto found = matchSurfaces(context, a, b, options);
  EXPECT_THAT(found, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(found.status().message(), testing::HasSubstr("marks.txt:7"));
}

TEST(MatchDisks, NamesTwoLandmarksAtOnePoint) {
  const TriangleMesh a = meshOf(shield(8, 1));
  const auto mark = [&](Index v) { return vertexPoint(a.connectivity(), v); };
  MatchOptions options;
  options.landmarks = {{mark(3), mark(3), "marks.txt:1"}, {mark(3), mark(4), "marks.txt:2"}};
  Context context;
  const auto found = matchSurfaces(context, a, a, options);
  EXPECT_THAT(found, FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(found.status().message(), testing::HasSubstr("marks.txt:1 and marks.txt:2"));
}

TEST(MatchDisks, NamesALandmarkThatCannotBeMet) {
  // Three marks of the boundary in the other order.
  const TriangleMesh a = meshOf(shield(8, 1));
  std::vector<Index> rim;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    if (a.connectivity().isBoundaryVertex(v)) rim.push_back(v);
  }
  const auto mark = [&](std::size_t i) { return vertexPoint(a.connectivity(), rim[i]); };
  MatchOptions options;
  options.same_triangulation = false;
  options.landmarks = {{mark(0), mark(0), "marks.txt:1"},
                       {mark(16), mark(32), "marks.txt:2"},
                       {mark(32), mark(16), "marks.txt:3"}};
  Context context;
  const auto found = matchSurfaces(context, a, a, options);
  EXPECT_THAT(found, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(found.status().message(), testing::HasSubstr("marks.txt:"));
}

/// The mean distance of vertices from where they are sent, over the root of the area.
double meanMiss(const SurfaceMatch& found, const TriangleMesh& a, const TriangleMesh& b,
                const std::vector<MatchLandmark>& marks) {
  double sum = 0;
  for (const MatchLandmark& mark : marks) {
    const auto& weights = mark.a.barycentric;
    const Index v = a.connectivity().face(
        mark.a.face)[std::max_element(weights.begin(), weights.end()) - weights.begin()];
    sum += (spacePoint(b.connectivity(), b.positions(), found.images[v]) -
            spacePoint(b.connectivity(), b.positions(), mark.b))
               .norm();
  }
  return sum / static_cast<double>(marks.size()) / std::sqrt(b.area());
}

/// Vertices of a, sent to those of b that are nearest to places `off` from theirs.
std::vector<MatchLandmark> displaced(const TriangleMesh& a, const TriangleMesh& b,
                                     const std::vector<Vector3d>& truth, const Vector3d& off) {
  std::vector<MatchLandmark> marks;
  for (Index v = 5; v < a.vertexCount(); v += a.vertexCount() / 9) {
    const bool on_rim = a.connectivity().isBoundaryVertex(v);
    Index best = kNone;
    for (Index w = 0; w < b.vertexCount(); ++w) {
      if (b.connectivity().isBoundaryVertex(w) != on_rim) continue;
      const auto distance = [&](Index u) { return (b.positions()[u] - truth[v] - off).norm(); };
      if (best == kNone || distance(w) < distance(best)) best = w;
    }
    marks.push_back({vertexPoint(a.connectivity(), v), vertexPoint(b.connectivity(), best),
                     "marks.txt:" + std::to_string(marks.size() + 1)});
  }
  return marks;
}

TEST(MatchDisks, SoftLandmarksDrawTheMap) {
  const TriangleMesh a = meshOf(shield(14, 1)), b = meshOf(shield(16, 2));
  MatchOptions exact, soft, both;
  exact.landmarks = soft.soft_landmarks = displaced(a, b, a.positions(), {0.1, 0.05, 0});
  const auto middle = exact.landmarks.begin() + 4;
  both.landmarks.assign(exact.landmarks.begin(), middle);
  both.soft_landmarks.assign(middle, exact.landmarks.end());
  const SurfaceMatch free = match(a, b), met = match(a, b, exact), drawn = match(a, b, soft),
                     mixed = match(a, b, both);
  const double at_first = meanMiss(free, a, b, exact.landmarks),
               after = meanMiss(drawn, a, b, exact.landmarks);
  std::cout << exact.landmarks.size() << " marks, at first missed by " << at_first
            << ", soft ones by " << after << "; distances " << free.distance << ", " << met.distance
            << " and " << drawn.distance << "\n";
  expectOneToOne(a, b, drawn, 0.03);
  EXPECT_FALSE(drawn.landmark_error);
  EXPECT_TRUE(drawn.soft_landmark_error);
  EXPECT_LT(after, at_first / 4);
  EXPECT_LT(drawn.distance, met.distance);
  expectOneToOne(a, b, mixed, 0.03);
  EXPECT_LE(mixed.landmark_error.value_or(1), 1e-12);
  EXPECT_LT(meanMiss(mixed, a, b, exact.landmarks), at_first / 4);
}

TEST(MatchDisks, SoftLandmarksMayContradictEachOther) {
  const TriangleMesh a = meshOf(shield(8, 1));
  std::vector<Index> rim;
  for (Index v = 0; v < a.vertexCount(); ++v) {
    if (a.connectivity().isBoundaryVertex(v)) rim.push_back(v);
  }
  const auto mark = [&](std::size_t i) { return vertexPoint(a.connectivity(), rim[i]); };
  MatchOptions options;
  options.soft_landmarks = {{mark(0), mark(0), "marks.txt:1"},
                            {mark(16), mark(32), "marks.txt:2"},
                            {mark(32), mark(16), "marks.txt:3"}};
  expectOneToOne(a, a, match(a, a, options), 0.2);
}

TEST(MatchDisks, StopsWhenCancelled) {
  const TriangleMesh a = meshOf(shield(8, 1)), b = meshOf(shield(9, 2));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(matchSurfaces(context, a, b), FailsWith(Reason::kCancelled));
}

// Bent by a radian and a half, on another triangulation.
class RealDisk : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Bent, RealDisk,
                         testing::Values("disk/libigl-data__lion.off", "disk/cfwen__face.off",
                                         "disk/gpeyre__venus.off", "disk/libigl-data__snail.obj",
                                         "disk/alec__woody.obj"));

TEST_P(RealDisk, IsFollowedWhereItGoes) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const TriangleSoup soup = *readMeshFile(context, path);
  SampleRandom random(2);
  const TriangleSoup posed = bent(soup, 1.5, 0.05, random);
  const TriangleMesh a = meshOf(soup), b = meshOf(simplified(posed, posed.faces.size() * 7 / 10));
  const SurfaceMatch found = match(a, b);
  EXPECT_LE(meanError(found, b, posed.vertices), 0.01);
  EXPECT_LE(found.cycle_error, 0.005);
  expectOneToOne(a, b, found, 0.03);
}

// Closed surfaces without a piece, limbs turned.
class OpenedMesh : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(WithTurnedLimbs, OpenedMesh,
                         testing::Values("closed_g0/alec__spot.obj", "closed_g0/alec__homer.obj"));

TEST_P(OpenedMesh, IsFollowedWhereItGoes) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  SampleRandom random(1);
  const TriangleSoup soup = *punched(*readMeshFile(context, path), 0.05, random);
  const TriangleSoup posed = articulated(soup, random);
  const TriangleMesh a = meshOf(soup), b = meshOf(simplified(posed, posed.faces.size() * 7 / 10));
  const SurfaceMatch found = match(a, b);
  EXPECT_LE(meanError(found, b, posed.vertices), 0.03);
  EXPECT_LE(found.cycle_error, 0.005);
  expectOneToOne(a, b, found, 0.03);
}

TEST_P(RealDisk, IsDrawnBySoftLandmarks) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const TriangleSoup soup = *readMeshFile(context, path);
  SampleRandom random(2);
  const TriangleSoup posed = bent(soup, 1.5, 0.05, random);
  const TriangleMesh a = meshOf(soup), b = meshOf(simplified(posed, posed.faces.size() * 7 / 10));
  MatchOptions soft;
  const Vector3d off = 0.03 * std::sqrt(b.area()) * Vector3d(1, 0.5, 0.3);
  soft.soft_landmarks = displaced(a, b, posed.vertices, off);
  const double at_first = meanMiss(match(a, b), a, b, soft.soft_landmarks);
  const SurfaceMatch drawn = match(a, b, soft);
  const double after = meanMiss(drawn, a, b, soft.soft_landmarks);
  std::cout << GetParam() << ": at first missed by " << at_first << ", then by " << after << "\n";
  // Some marks of the boundary change places by that, and stay behind.
  EXPECT_LT(after, at_first / 2);
  expectOneToOne(a, b, drawn, 0.05);
}

}  // namespace
}  // namespace moduli
