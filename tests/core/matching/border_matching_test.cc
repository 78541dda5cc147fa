#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>

#include "core/intrinsic/edge_graph.h"
#include "core/matching/border_places.h"
#include "core/matching/match_surfaces.h"
#include "core/mesh/read.h"
#include "core/topology/surface_topology.h"
#include "tests/core/matching/bordered_samples.h"
#include "tests/core/matching/renumbered.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

/// A surface and a copy of it of which nothing is the same but the shape.
struct Copy {
  TriangleMesh a, b;
  std::vector<Index> image;  ///< Per vertex of a.

  explicit Copy(const TriangleSoup& soup) : Copy(soup, renumbered(moved(soup), 5)) {}

  Vector3d truth(Index v) const { return b.positions()[image[v]]; }
  double meanError(const SurfaceMatch& found) const {
    return errorsOf(b, found.images, vertexPlaces(b, image)).mean;
  }

 private:
  Copy(const TriangleSoup& soup, const Renumbered& other)
      : a(meshOf(soup)), b(meshOf(other.soup)), image(other.image) {}
};

/// A ring, a plate with three holes and a torus with one, without symmetries.
std::vector<TriangleSoup> samples() {
  TriangleSoup skew = ring(12, 2, 3), plate = bentPlate(4, 2);
  for (Vector3d& p : skew.vertices) {
    p[2] = 0.5 * std::exp(-(p - Vector3d(1.3, 0.4, 0)).squaredNorm() / 0.3) + 0.2 * p[0];
    p[1] *= 1 + 0.15 * p[0];
  }
  for (Vector3d& p : plate.vertices) p[1] *= 1 + 0.08 * p[0];
  return {skew, plate, openTorus(16, 2)};
}

Result<SurfaceMatch> tried(const TriangleMesh& a, const TriangleMesh& b, MatchOptions options) {
  Context context;
  options.same_triangulation = false;
  return matchSurfaces(context, a, b, options);
}

SurfaceMatch match(const TriangleMesh& a, const TriangleMesh& b, const MatchOptions& options = {}) {
  auto found = tried(a, b, options);
  EXPECT_TRUE(found.ok()) << found.status().toString();
  return found.ok() ? *std::move(found) : SurfaceMatch();
}

bool isOnBorder(const Connectivity& surface, const SurfacePoint& point) {
  const auto& [face, weights] = point;
  for (int c = 0; c < 3; ++c) {
    if (surface.twin(3 * face + c) == kNone && weights[(c + 2) % 3] == 0) return true;
    if (surface.isBoundaryVertex(surface.face(face)[c]) && weights[c] == 1) return true;
  }
  return false;
}

/// What holds of every answer.
void expectOneToOne(const TriangleMesh& a, const TriangleMesh& b, const SurfaceMatch& found) {
  EXPECT_EQ(found.report.folded_faces, 0);
  ASSERT_EQ(found.images.size(), static_cast<std::size_t>(a.vertexCount()));
  for (Index v = 0; v < a.vertexCount(); ++v) {
    if (!a.connectivity().isBoundaryVertex(v)) continue;
    EXPECT_TRUE(isOnBorder(b.connectivity(), found.images.at(v)));
  }
  for (Index w = 0; w < b.vertexCount(); ++w) {
    if (!b.connectivity().isBoundaryVertex(w)) continue;
    EXPECT_TRUE(isOnBorder(a.connectivity(), found.inverse.at(w)));
  }
}

/// Vertices of a far from each other, every loop's among them, with those they are sent to: in the
/// copy's numbering the same ones or others about `way` (in roots of the area) from them, of the
/// boundary along it and all in one direction.
std::vector<MatchLandmark> marks(const Copy& copy, Index inside, Index per_loop, double way) {
  const Connectivity& surface = copy.a.connectivity();
  const double length = way * std::sqrt(copy.a.area());
  std::vector<MatchLandmark> result;
  const auto add = [&](Index v, Index to) {
    result.push_back({vertexPoint(surface, v), vertexPoint(copy.b.connectivity(), copy.image[to]),
                      "marks.txt:" + std::to_string(result.size() + 1)});
  };
  const BorderPlaces places(copy.a);
  std::vector<Index> known;
  for (std::size_t i = 0; i < places.loops().size(); ++i) {
    const std::vector<Index>& loop = places.loops()[i];
    for (Index n = 0; n < per_loop; ++n) {
      std::size_t k = n * loop.size() / per_loop, to = k;
      const double rest = places.length(static_cast<Index>(i)) / (3 * per_loop);
      for (double gone = 0; gone < std::min(length, rest) && way > 0;) {
        const Index h = loop[to];
        gone += (copy.a.positions()[surface.head(h)] - copy.a.positions()[surface.tail(h)]).norm();
        to = (to + 1) % loop.size();
      }
      add(surface.tail(loop[k]), surface.tail(loop[to]));
    }
    for (const Index h : loop) known.push_back(surface.tail(h));
  }
  const EdgeGraph graph(surface, copy.a.edgeLengths());
  for (const Index v :
       graph.farthestSamples(known, static_cast<Index>(known.size()) + inside).vertices) {
    if (surface.isBoundaryVertex(v)) continue;
    Index to = v;
    for (const auto& [w, distance] : graph.within(v, length)) {
      if (!surface.isBoundaryVertex(w)) to = w;
    }
    add(v, to);
  }
  return result;
}

/// Of the landmarks, vertices, in roots of the area.
double largestMiss(const Copy& copy, const SurfaceMatch& found,
                   const std::vector<MatchLandmark>& landmarks) {
  double largest = 0;
  for (const MatchLandmark& mark : landmarks) {
    const auto& weights = mark.a.barycentric;
    const Index v = copy.a.connectivity().face(
        mark.a.face)[std::max_element(weights.begin(), weights.end()) - weights.begin()];
    largest =
        std::max(largest, (spaceAt(copy.b, found.images[v]) - spaceAt(copy.b, mark.b)).norm());
  }
  return largest / std::sqrt(copy.b.area());
}

TEST(BorderMatching, LeavesAMapAloneThatMeetsTheLandmarks) {
  for (const TriangleSoup& soup : samples()) {
    const Copy copy(soup);
    const SurfaceMatch free = match(copy.a, copy.b);
    MatchOptions options;
    for (const MatchLandmark& mark : marks(copy, 4, 3, 0)) {
      const Triangle& face = copy.a.connectivity().face(mark.a.face);
      const Index v = face[std::max_element(mark.a.barycentric.begin(), mark.a.barycentric.end()) -
                           mark.a.barycentric.begin()];
      options.landmarks.push_back({mark.a, free.images[v], mark.name});
    }
    const SurfaceMatch met = match(copy.a, copy.b, options);
    double apart = 0;
    for (Index v = 0; v < copy.a.vertexCount(); ++v) {
      apart = std::max(apart,
                       (spaceAt(copy.b, free.images[v]) - spaceAt(copy.b, met.images[v])).norm());
    }
    EXPECT_LT(apart, 1e-9);
    EXPECT_LT(met.landmark_error.value_or(1), 1e-9);
  }
}

TEST(BorderMatching, LandmarksAtTheTruthKeepTheMapNearIt) {
  for (const TriangleSoup& soup : samples()) {
    const Copy copy(soup);
    const double before = copy.meanError(match(copy.a, copy.b));
    MatchOptions options;
    options.landmarks = marks(copy, 4, 3, 0);
    const SurfaceMatch found = match(copy.a, copy.b, options);
    expectOneToOne(copy.a, copy.b, found);
    std::cout << options.landmarks.size() << " marks: mean error " << before << ", with them "
              << copy.meanError(found) << ", missed by " << found.landmark_error.value_or(1)
              << "\n";
    EXPECT_LT(found.landmark_error.value_or(1), 1e-8);
    EXPECT_LT(copy.meanError(found), 1.2 * before + 1e-4);
  }
}

TEST(BorderMatching, MeetsDisplacedLandmarks) {
  for (const TriangleSoup& soup : samples()) {
    const Copy copy(soup);
    MatchOptions options, soft;
    options.landmarks = soft.soft_landmarks = marks(copy, 4, 3, 0.05);
    const SurfaceMatch found = match(copy.a, copy.b, options);
    expectOneToOne(copy.a, copy.b, found);
    const SurfaceMatch drawn = match(copy.a, copy.b, soft);
    expectOneToOne(copy.a, copy.b, drawn);
    const double at_first = largestMiss(copy, match(copy.a, copy.b), options.landmarks);
    std::cout << options.landmarks.size() << " marks, at first missed by " << at_first
              << ", then by " << found.landmark_error.value_or(1) << ", soft ones by "
              << drawn.soft_landmark_error.value_or(1) << "; mean error " << copy.meanError(found)
              << " and " << copy.meanError(drawn) << ", distances " << found.distance << " and "
              << drawn.distance << "\n";
    // 1e-7 of edges that are shorter than a tenth.
    EXPECT_LT(found.landmark_error.value_or(1), 1e-8);
    EXPECT_FALSE(drawn.landmark_error);
    EXPECT_LT(drawn.soft_landmark_error.value_or(1), at_first);
    EXPECT_LT(drawn.distance, found.distance);
  }
}

TEST(BorderMatching, MeetsPointsInFacesAndOnEdgesOfTheBoundary) {
  for (const TriangleSoup& soup : samples()) {
    const Copy copy(soup);
    MatchOptions options;
    options.landmarks = marks(copy, 4, 3, 0.03);
    for (MatchLandmark& mark : options.landmarks) {
      const auto here = borderPointAt(copy.a.connectivity(), mark.a);
      const auto there = borderPointAt(copy.b.connectivity(), mark.b);
      ASSERT_EQ(here.has_value(), there.has_value());
      if (here) {
        mark.a = edgePoint(here->halfedge, 0.3);
        mark.b = edgePoint(there->halfedge, 0.6);
      } else {
        mark.a.barycentric = {0.5, 0.3, 0.2};
        mark.b.barycentric = {0.1, 0.3, 0.6};
      }
    }
    const SurfaceMatch found = match(copy.a, copy.b, options);
    expectOneToOne(copy.a, copy.b, found);
    EXPECT_LT(found.landmark_error.value_or(1), 1e-8);
    options.mirror = true;
    TriangleSoup turned = mirrored({copy.b.positions(), copy.b.connectivity().faces()});
    for (MatchLandmark& mark : options.landmarks) {
      std::swap(mark.b.barycentric[1], mark.b.barycentric[2]);
    }
    const TriangleMesh mirror = meshOf(turned);
    const SurfaceMatch other = match(copy.a, mirror, options);
    expectOneToOne(copy.a, mirror, other);
    EXPECT_LT(other.landmark_error.value_or(1), 1e-8);
  }
}

TEST(BorderMatching, RefusesLandmarksThatLeaveTheBoundary) {
  const Copy copy(samples()[1]);
  const auto all = marks(copy, 1, 1, 0);
  for (const bool exact : {true, false}) {
    MatchOptions options;
    auto& landmarks = exact ? options.landmarks : options.soft_landmarks;
    landmarks = {all.front(), {all[1].a, all.back().b, "marks.txt:9"}};
    const auto found = tried(copy.a, copy.b, options);
    EXPECT_THAT(found, FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(found.status().message(), testing::HasSubstr("marks.txt:9 is on the boundary"));
  }
}

TEST(BorderMatching, NamesLandmarksOfTheBoundaryThatContradictEachOther) {
  const Copy copy(samples()[1]);
  MatchOptions options;
  options.landmarks = marks(copy, 0, 4, 0);
  // Loops have four each. Three in the other order:
  MatchOptions wrong = options;
  std::swap(wrong.landmarks[5].b, wrong.landmarks[6].b);
  const auto order = tried(copy.a, copy.b, wrong);
  EXPECT_THAT(order, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(order.status().message(),
              testing::ContainsRegex("marks.txt:6 and marks.txt:7 contradict each other.*order"));
  // Two loops for one, and one for two.
  wrong = options;
  wrong.landmarks = {options.landmarks[0], options.landmarks[1]};
  wrong.landmarks[1].b = options.landmarks[9].b;
  EXPECT_THAT(tried(copy.a, copy.b, wrong).status().message(),
              testing::HasSubstr("marks.txt:1 and marks.txt:2 contradict each other"));
  wrong.landmarks = {options.landmarks[0], options.landmarks[9]};
  wrong.landmarks[1].b = options.landmarks[1].b;
  EXPECT_THAT(tried(copy.a, copy.b, wrong).status().message(),
              testing::HasSubstr("marks.txt:1 and marks.txt:10 contradict each other"));
  // As soft ones they may be missed.
  MatchOptions soft = options;
  soft.landmarks.clear();
  soft.soft_landmarks = options.landmarks;
  std::swap(soft.soft_landmarks[5].b, soft.soft_landmarks[6].b);
  expectOneToOne(copy.a, copy.b, match(copy.a, copy.b, soft));
}

TEST(BorderMatching, NamesLandmarksInsideThatContradictEachOther) {
  const Copy copy(samples()[1]);
  const Connectivity& surface = copy.a.connectivity();
  Index face = 60;
  const auto isInside = [&](Index f) {
    return std::none_of(surface.face(f).begin(), surface.face(f).end(), [&](Index v) {
      return surface.isBoundaryVertex(v) || surface.isBoundaryVertex(v);
    });
  };
  while (!isInside(face) || !isInside(surface.twin(3 * face) / 3)) ++face;
  const auto& [p, q, r] = surface.face(face);
  const Index beyond = surface.head(Connectivity::next(surface.twin(3 * face)));
  MatchOptions options;
  for (const auto& [from, to] : {std::pair(p, p), std::pair(q, q), std::pair(r, beyond)}) {
    options.landmarks.push_back({vertexPoint(surface, from),
                                 vertexPoint(copy.b.connectivity(), copy.image[to]),
                                 "marks.txt:" + std::to_string(options.landmarks.size() + 1)});
  }
  const auto folded = tried(copy.a, copy.b, options);
  EXPECT_THAT(folded, FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(folded.status().message(),
              testing::ContainsRegex("marks.txt:[12] and marks.txt:[23] contradict each other"));
  options.landmarks[1].b = options.landmarks[0].b;
  EXPECT_THAT(tried(copy.a, copy.b, options), FailsWith(Reason::kInvalidOption));
}

/// A pair of trousers with two legs alike, but for a low bump: the waist is the outer boundary.
TriangleMesh trousers(int resolution, int seed, double bump) {
  TriangleSoup soup = *makeSample("plate", {{"holes", 2},
                                            {"resolution", static_cast<double>(resolution)},
                                            {"seed", static_cast<double>(seed)}});
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : soup.vertices) middle += p / static_cast<double>(soup.vertices.size());
  for (Vector3d& p : soup.vertices) {
    p -= middle;
    // A half turn about z is a symmetry, mirror images are none.
    p = {p[0] + 0.3 * p[1], p[1], bump * std::exp(-(p - Vector3d(1, 0.8, 0)).squaredNorm())};
  }
  return meshOf(soup);
}

TEST(BorderMatching, LandmarksDecideWhichLoopGoesToWhich) {
  const TriangleMesh a = trousers(5, 1, 0.1), b = trousers(6, 2, 0.1);
  const auto nearest = [](const TriangleMesh& mesh, const Vector3d& p, bool on_border) {
    Index best = kNone;
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (mesh.connectivity().isBoundaryVertex(v) != on_border) continue;
      const auto distance = [&](Index w) { return (mesh.positions()[w] - p).head<2>().norm(); };
      if (best == kNone || distance(v) < distance(best)) best = v;
    }
    return vertexPoint(mesh.connectivity(), best);
  };
  const BorderPlaces loops(a);
  for (const double turn : {1.0, -1.0}) {
    for (const bool on_border : {false, true}) {
      for (const bool soft : {false, true}) {
        MatchOptions options;
        auto& landmarks = soft ? options.soft_landmarks : options.landmarks;
        // On the corner of a leg, or beside it.
        const Index h = *std::min_element(
            loops.loops()[1].begin(), loops.loops()[1].end(), [&](Index i, Index j) {
              const auto at = [&](Index k) { return a.positions()[a.connectivity().tail(k)]; };
              return at(i)[0] + at(i)[1] < at(j)[0] + at(j)[1];
            });
        const Vector3d p =
            a.positions()[a.connectivity().tail(h)] - Vector3d(0, on_border ? 0 : 0.2, 0);
        const SurfacePoint from = nearest(a, p, on_border);
        landmarks = {{from, nearest(b, turn * spaceAt(a, from), on_border), "marks.txt:1"}};
        const SurfaceMatch found = match(a, b, options);
        expectOneToOne(a, b, found);
        double mean = 0;
        for (Index v = 0; v < a.vertexCount(); ++v) {
          const Vector3d there = spaceAt(b, found.images[v]);
          mean += (there - turn * a.positions()[v]).head<2>().norm() / a.vertexCount();
        }
        std::cout << "turn " << turn << (on_border ? ", on the boundary" : "")
                  << (soft ? ", soft" : "") << ": mean error " << mean << "\n";
        // The size is 5.
        EXPECT_LT(mean, 0.1);
        EXPECT_LT(soft ? 0 : found.landmark_error.value_or(1), 1e-8);
      }
    }
  }
}

TEST(BorderMatching, NamesALandmarkThatTakesALoopWhereTheShapesDoNot) {
  const Copy copy(samples()[1]);
  MatchOptions options;
  const auto all = marks(copy, 0, 1, 0);
  options.landmarks = {{all[1].a, all[3].b, "marks.txt:7"}};
  const auto found = tried(copy.a, copy.b, options);
  EXPECT_THAT(found, FailsWith(Reason::kNoConvergence));
  EXPECT_THAT(found.status().message(), testing::HasSubstr("marks.txt:7 takes a boundary loop"));
}

/// A barrel that half turns about the axes carry to itself.
TriangleMesh barrel(int resolution, int seed) {
  TriangleSoup soup = ring(resolution, 2, seed);
  for (Vector3d& p : soup.vertices) {
    const double h = 2 * p.norm() - 3, angle = std::atan2(p[1], p[0]);
    const double out = 1 - 0.4 * h * h;
    p = {out * std::cos(angle), 0.5 * out * std::sin(angle), 0.8 * h};
  }
  return meshOf(soup);
}

TEST(BorderMatching, LandmarksTellWhichEndGoesToWhich) {
  const TriangleMesh a = barrel(12, 3), b = barrel(13, 4);
  const auto nearest = [](const TriangleMesh& mesh, const Vector3d& p) {
    Index best = kNone;
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      if (!mesh.connectivity().isBoundaryVertex(v)) continue;
      const auto distance = [&](Index w) { return (mesh.positions()[w] - p).norm(); };
      if (best == kNone || distance(v) < distance(best)) best = v;
    }
    return best;
  };
  // Beside the planes of symmetry.
  const Index from = nearest(a, {0.5, 0.2, 0.8});
  for (const Vector3d& turn :
       {Vector3d(1, 1, 1), Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)}) {
    MatchOptions options;
    options.landmarks = {
        {vertexPoint(a.connectivity(), from),
         vertexPoint(b.connectivity(), nearest(b, a.positions()[from].cwiseProduct(turn))), "one"}};
    const SurfaceMatch found = match(a, b, options);
    expectOneToOne(a, b, found);
    EXPECT_LT(found.landmark_error.value_or(1), 1e-8);
    double mean = 0;
    for (Index v = 0; v < a.vertexCount(); ++v) {
      mean += (spaceAt(b, found.images[v]) - a.positions()[v].cwiseProduct(turn)).norm() /
              a.vertexCount();
    }
    std::cout << "turn " << turn.transpose() << ": mean error " << mean << "\n";
    EXPECT_LT(mean, 0.1);
  }
}

class BorderLandmarks : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(RealMeshes, BorderLandmarks,
                         testing::Values("multi_boundary/gpeyre__nefertiti-entire.off",
                                         "multi_boundary/gpeyre__pipes.off",
                                         "multi_boundary/odedstein__plane_holes.obj",
                                         "multi_boundary/libigl-data__halftunnel.off",
                                         "genus1/bff__punctured-torus.obj",
                                         "genus2/cfwen__eight.hole.off"));

TEST_P(BorderLandmarks, AreMetAndSoftOnesDrawTheMap) {
  MODULI_NEED_SHARED_MESH(path, GetParam());
  Context context;
  const Copy copy(*readMeshFile(context, path));
  MatchOptions exact, soft;
  // Where there are many holes, they are near each other.
  const bool many = computeTopology(copy.a.connectivity()).boundary_loops.size() > 10;
  exact.landmarks = soft.soft_landmarks = marks(copy, 5, many ? 1 : 3, many ? 0.005 : 0.02);
  const SurfaceMatch free = match(copy.a, copy.b), found = match(copy.a, copy.b, exact),
                     drawn = match(copy.a, copy.b, soft);
  if (HasFailure()) return;
  const double at_first = largestMiss(copy, free, exact.landmarks);
  std::cout << GetParam() << ", " << exact.landmarks.size() << " marks, at first missed by "
            << at_first << ", then by " << found.landmark_error.value_or(1) << ", soft ones by "
            << drawn.soft_landmark_error.value_or(1) << "; mean error " << copy.meanError(free)
            << ", " << copy.meanError(found) << " and " << copy.meanError(drawn) << ", distances "
            << free.distance << ", " << found.distance << " and " << drawn.distance << "\n";
  expectOneToOne(copy.a, copy.b, found);
  expectOneToOne(copy.a, copy.b, drawn);
  EXPECT_LT(found.landmark_error.value_or(1), 1e-8);
  EXPECT_LT(drawn.soft_landmark_error.value_or(1), at_first);
}

}  // namespace
}  // namespace moduli
