#include "core/hyperbolic/closed_path.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "tests/core/hyperbolic/groups.h"
#include "tests/core/hyperbolic/uniformized_samples.h"

namespace moduli {
namespace {

/// A surface, laid out, and its closed geodesics by elements in the coordinates of the layout.
struct LaidOut {
  HyperbolicTriangles triangles;
  Development development;
  std::vector<Su11> generators;
  std::vector<ClosedGeodesic> geodesics;
};

/// reach: in systoles.
LaidOut layOut(HyperbolicTriangles triangles, double reach, Index root = kNone) {
  Context context;
  DevelopOptions options;
  options.root = root;
  auto development = develop(context, triangles, options);
  EXPECT_OK(development);
  LaidOut result{std::move(triangles), *std::move(development), {}, {}};
  const auto group = computeFuchsianGroup(context, result.triangles, result.development);
  EXPECT_OK(group);
  const auto polygon = orbitPolygon(context, *group);
  EXPECT_OK(polygon);
  const auto shortest = systoles(context, *polygon);
  EXPECT_OK(shortest);
  auto spectrum = lengthSpectrum(context, *polygon, reach * shortest->geodesics[0].length);
  EXPECT_OK(spectrum);
  const auto carried = [](const Su11& frame, const Su11& g) {
    return renormalized(frame * g * inverse(frame));
  };
  for (const Su11& g : group->generators) {
    result.generators.push_back(carried(group->base, g));
  }
  result.geodesics = std::move(spectrum->geodesics);
  for (ClosedGeodesic& geodesic : result.geodesics) {
    geodesic.element = carried(group->base * polygon->base, geodesic.element);
  }
  return result;
}

std::vector<PathStep> follow(const LaidOut& surface, const Su11& element) {
  Context context;
  auto steps = followGeodesic(context, surface.triangles, surface.development, element);
  EXPECT_OK(steps);
  return steps.ok() ? *std::move(steps) : std::vector<PathStep>();
}

const PathStep& following(const std::vector<PathStep>& path, std::size_t i) {
  return path[(i + 1) % path.size()];
}

/// In the coordinates of the face of h.
Complex pointAlong(const HyperbolicTriangles& triangles, Index h, double fraction) {
  return imageOf(cornerFrame(triangles, h), std::tanh(fraction * triangles.lengths[h] / 2));
}

/// Every step leaves the face that it came into through another of its sides.
void expectConnected(const HyperbolicTriangles& triangles, const std::vector<PathStep>& path) {
  ASSERT_FALSE(path.empty());
  for (std::size_t i = 0; i < path.size(); ++i) {
    ASSERT_GE(path[i].fraction, 0);
    ASSERT_LE(path[i].fraction, 1);
    const Index exit = triangles.surface.twin(following(path, i).entry);
    ASSERT_EQ(Connectivity::faceOf(exit), Connectivity::faceOf(path[i].entry)) << "step " << i;
    ASSERT_NE(exit, path[i].entry) << "step " << i;
  }
}

double lengthOf(const HyperbolicTriangles& triangles, const std::vector<PathStep>& path) {
  double sum = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathStep& next = following(path, i);
    sum += hyperbolicDistance(
        pointAlong(triangles, path[i].entry, path[i].fraction),
        pointAlong(triangles, triangles.surface.twin(next.entry), 1 - next.fraction));
  }
  return sum;
}

/// Whether it passes a vertex.
bool meetsVertex(const std::vector<PathStep>& path) {
  return std::any_of(path.begin(), path.end(), [](const PathStep& step) {
    return std::min(step.fraction, 1 - step.fraction) < 1e-6;
  });
}

bool sameCyclicPath(const std::vector<PathStep>& a, const std::vector<PathStep>& b,
                    double tolerance) {
  if (a.size() != b.size()) return false;
  for (std::size_t shift = 0; shift < a.size(); ++shift) {
    bool same = true;
    for (std::size_t i = 0; i < a.size() && same; ++i) {
      const PathStep& other = b[(i + shift) % b.size()];
      same = a[i].entry == other.entry && std::abs(a[i].fraction - other.fraction) < tolerance;
    }
    if (same) return true;
  }
  return false;
}

std::vector<PathStep> backwards(const HyperbolicTriangles& triangles,
                                const std::vector<PathStep>& path) {
  std::vector<PathStep> result;
  for (auto step = path.rbegin(); step != path.rend(); ++step) {
    result.push_back({triangles.surface.twin(step->entry), 1 - step->fraction});
  }
  return result;
}

/// Its paths are connected and as long as the geodesics. How many of them pass a vertex.
int expectPathsOfAllGeodesics(const LaidOut& surface) {
  int through_vertices = 0;
  double worst = 0;
  for (const ClosedGeodesic& geodesic : surface.geodesics) {
    const std::vector<PathStep> path = follow(surface, geodesic.element);
    expectConnected(surface.triangles, path);
    const double length = lengthOf(surface.triangles, path);
    // Elements carry some 1e-13, sides of corners up to 1e-9 count as on the axis: ways cut there
    // are wrong by the square of this.
    EXPECT_NEAR(length, geodesic.length, 1e-9);
    worst = std::max(worst, std::abs(length - geodesic.length));
    through_vertices += meetsVertex(path) ? 1 : 0;
  }
  std::cout << surface.geodesics.size() << " geodesics, " << through_vertices
            << " through vertices, lengths to " << worst << "\n";
  return through_vertices;
}

TEST(ClosedPath, OfBolzasSystolesRunsAlongItsEdges) {
  // The systole is two edges, 2 acosh(1 + sqrt 2) = 4 acosh(1 / (2 sin(pi / 8))).
  const LaidOut surface = layOut(regularSample("bolza"), 1.001);
  EXPECT_EQ(surface.geodesics.size(), 12U);
  EXPECT_EQ(expectPathsOfAllGeodesics(surface), 12);
}

TEST(ClosedPath, OfKleinsSystolesIsAsLongAsThey) {
  const LaidOut surface = layOut(regularSample("klein"), 1.4);
  EXPECT_GT(surface.geodesics.size(), 21U);
  expectPathsOfAllGeodesics(surface);
}

TEST(ClosedPath, DoesNotMindLoopsAndFacesWithOneVertex) {
  for (const int genus : {2, 3}) {
    auto triangles = hyperbolicTriangles(polygonSurface(genus));
    ASSERT_OK(triangles);
    expectPathsOfAllGeodesics(layOut(*std::move(triangles), 1.5));
  }
}

HyperbolicTriangles sampleTriangles(double genus, double resolution, double seed) {
  const Uniformization found = uniformized(
      metricOfSample("genus", {{"genus", genus}, {"resolution", resolution}, {"seed", seed}}));
  auto triangles = hyperbolicTriangles(found.metric);
  EXPECT_OK(triangles);
  return *std::move(triangles);
}

TEST(ClosedPath, OfUniformizedSurfacesIsAsLongAsTheGeodesic) {
  for (const double seed : {0, 7}) {
    const int through = expectPathsOfAllGeodesics(layOut(sampleTriangles(2, 4, seed), 1.5));
    // The regular triangulation has the symmetries of the surface; the other has none.
    EXPECT_EQ(through > 0, seed == 0);
  }
  MODULI_NEED_SHARED_MESH(path, "genus2/cfwen__eight.off");
  const auto given = metricOfFile(path);
  ASSERT_OK(given);
  auto triangles = hyperbolicTriangles(uniformized(*given).metric);
  ASSERT_OK(triangles);
  expectPathsOfAllGeodesics(layOut(*std::move(triangles), 1.3));
}

TEST(ClosedPath, OfTheInverseIsTheSameBackwards) {
  const LaidOut surface = layOut(sampleTriangles(2, 4, 7), 1.5);
  for (const ClosedGeodesic& geodesic : surface.geodesics) {
    const std::vector<PathStep> path = follow(surface, geodesic.element);
    const std::vector<PathStep> back = follow(surface, inverse(geodesic.element));
    EXPECT_TRUE(sameCyclicPath(backwards(surface.triangles, path), back, 1e-8));
    EXPECT_FALSE(sameCyclicPath(path, back, 1e-8));
  }
}

TEST(ClosedPath, OfConjugateElementsIsTheSame) {
  for (const LaidOut& surface :
       {layOut(sampleTriangles(2, 4, 7), 1.3), layOut(regularSample("bolza"), 1.001)}) {
    for (const ClosedGeodesic& geodesic : surface.geodesics) {
      const std::vector<PathStep> path = follow(surface, geodesic.element);
      for (const Su11& g : surface.generators) {
        const Su11 other = renormalized(g * geodesic.element * inverse(g));
        // Moving 0 by twice a generator's 8 more costs e^8.
        EXPECT_TRUE(sameCyclicPath(path, follow(surface, other), 1e-6));
        EXPECT_TRUE(sameCyclicPath(path, follow(surface, -other), 1e-6));
      }
    }
  }
}

TEST(ClosedPath, DoesNotDependOnTheLayout) {
  const HyperbolicTriangles triangles = sampleTriangles(2, 4, 7);
  const LaidOut first = layOut(triangles, 1.2), second = layOut(triangles, 1.2, 11);
  ASSERT_EQ(first.geodesics.size(), second.geodesics.size());
  std::vector<std::vector<PathStep>> others;
  for (const ClosedGeodesic& geodesic : second.geodesics) {
    others.push_back(follow(second, geodesic.element));
    others.push_back(backwards(triangles, others.back()));
  }
  for (const ClosedGeodesic& geodesic : first.geodesics) {
    const std::vector<PathStep> path = follow(first, geodesic.element);
    EXPECT_EQ(std::count_if(others.begin(), others.end(),
                            [&](const auto& other) { return sameCyclicPath(path, other, 1e-8); }),
              1);
  }
}

TEST(ClosedPath, OfAPowerGoesAroundAsOften) {
  for (const LaidOut& surface :
       {layOut(sampleTriangles(2, 4, 7), 1.1), layOut(regularSample("bolza"), 1.001)}) {
    const Su11& g = surface.geodesics[0].element;
    const std::vector<PathStep> once = follow(surface, g);
    std::vector<PathStep> twice = once;
    twice.insert(twice.end(), once.begin(), once.end());
    EXPECT_TRUE(sameCyclicPath(twice, follow(surface, g * g), 1e-8));
    const std::vector<PathStep> thrice = follow(surface, g * g * g);
    EXPECT_EQ(thrice.size(), 3 * once.size());
    EXPECT_NEAR(lengthOf(surface.triangles, thrice), 3 * surface.geodesics[0].length, 1e-8);
  }
}

TEST(ClosedPath, IsRefusedToElementsOfNoGroup) {
  const LaidOut surface = layOut(sampleTriangles(2, 4, 7), 1.1);
  Context context;
  const Su11 stranger = renormalized(surface.geodesics[0].element * translation(0.1));
  EXPECT_THAT(followGeodesic(context, surface.triangles, surface.development, stranger),
              FailsWith(Reason::kInternal));
}

TEST(ClosedPath, StopsWhenCancelled) {
  const LaidOut surface = layOut(regularSample("bolza"), 1.001);
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  EXPECT_THAT(
      followGeodesic(context, surface.triangles, surface.development, surface.geodesics[0].element),
      FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
