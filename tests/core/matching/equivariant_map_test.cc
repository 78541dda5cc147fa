#include "core/matching/equivariant_map.h"

#include <cmath>
#include <iostream>
#include <numbers>
#include <utility>

#include "core/forms/cotan.h"
#include "core/mesh/sample_tools.h"
#include "tests/core/matching/cover_samples.h"

namespace moduli {
namespace {

/// The same hyperbolic surface with every triangle cut into four at the middles of its sides.
struct Refined {
  Connectivity surface;
  std::vector<double> lengths;  ///< Per edge.
};

Refined cutInFour(const Refined& coarse) {
  const Connectivity& given = coarse.surface;
  const auto middle = [&](Index h) { return given.vertexCount() + given.edge(h); };
  std::vector<Triangle> faces;
  for (Index h = 0; h < given.halfedgeCount(); h += 3) {
    for (int c = 0; c < 3; ++c) {
      faces.push_back({given.tail(h + c), middle(h + c), middle(h + (c + 2) % 3)});
    }
    faces.push_back({middle(h), middle(h + 1), middle(h + 2)});
  }
  const Index count = given.vertexCount() + given.edgeCount();
  Refined fine{*Connectivity::fromFaces(count, std::move(faces)), {}};
  fine.lengths.resize(fine.surface.edgeCount());
  for (Index f = 0; f < given.faceCount(); ++f) {
    TriangleValues sides;
    for (int c = 0; c < 3; ++c) sides[c] = coarse.lengths[given.edge(3 * f + c)];
    const TriangleValues opposite = triangleAngles(Geometry::kHyperbolic, sides);
    for (int c = 0; c < 3; ++c) {
      // At corner c, between sides c and c + 2: opposite side c + 1.
      const double x = sides[c] / 2, y = sides[(c + 2) % 3] / 2;
      const double half =
          std::hypot(std::sinh((x - y) / 2),
                     std::sin(opposite[(c + 1) % 3] / 2) * std::sqrt(std::sinh(x) * std::sinh(y)));
      const Index child = 3 * (4 * f + c);
      fine.lengths[fine.surface.edge(child)] = x;
      fine.lengths[fine.surface.edge(child + 1)] = 2 * std::asinh(half);
      fine.lengths[fine.surface.edge(child + 2)] = y;
    }
  }
  return fine;
}

CoverSurface coverOf(const Refined& fine) {
  std::vector<double> lengths, angles;
  for (Index f = 0; f < fine.surface.faceCount(); ++f) {
    TriangleValues sides;
    for (int c = 0; c < 3; ++c) sides[c] = fine.lengths[fine.surface.edge(3 * f + c)];
    const TriangleValues opposite = triangleAngles(Geometry::kHyperbolic, sides);
    lengths.insert(lengths.end(), sides.begin(), sides.end());
    for (int c = 0; c < 3; ++c) angles.push_back(opposite[(c + 1) % 3]);
  }
  return coverOfTriangles(Geometry::kHyperbolic, fine.surface, lengths, angles, fine.lengths);
}

Refined hyperbolicSample(int resolution, int seed = 0) {
  const TriangleMesh mesh = meshOf(lumpyPlate(resolution, seed));
  const CoverSurface cover = coverOf(mesh);
  const CoverPlane plane = cover.plane();
  const VertexLinks links = ownLinks(cover, vertexFrames(cover));
  Refined result{cover.surface, {}};
  for (Index e = 0; e < cover.surface.edgeCount(); ++e) {
    result.lengths.push_back(plane.wayTo(links[cover.surface.halfedge(e)].col(2)).norm());
  }
  return result;
}

VertexLinks linksOf(const CoverSurface& cover) {
  return ownLinks(cover, vertexFrames(cover));
}

TEST(HarmonicMap, OfASurfaceToItselfTendsToTheIdentityAtSecondOrder) {  // CHECKS H4.
  Context context;
  Refined level = hyperbolicSample(2);
  std::vector<double> excess, moved;
  for (int n = 0; n < 4; ++n, level = cutInFour(level)) {
    const CoverSurface cover = coverOf(level);
    const VertexLinks links = linksOf(cover);
    ASSERT_LT(closureResidual(cover.surface, links), 1e-12);
    EXPECT_NEAR(coveredArea(cover.geometry, cover.surface, links), 4 * std::numbers::pi, 1e-11);
    const auto map = harmonicMap(context, cover.geometry, cover.surface,
                                 cotanWeights(cover.surface, level.lengths), links);
    ASSERT_OK(map);
    EXPECT_EQ(map->folded_faces, 0);
    double square = 0;
    for (const Motion& move : map->moves) {
      square +=
          cover.plane().wayTo(move.col(2)).squaredNorm() / static_cast<double>(map->moves.size());
    }
    excess.push_back(map->energy - 4 * std::numbers::pi);
    moved.push_back(std::sqrt(square));
    std::cout << cover.surface.vertexCount() << " vertices: energy - 4 pi " << excess.back()
              << ", moved " << moved.back() << ", " << map->iterations << " steps\n";
    EXPECT_GT(excess.back(), 0);  // E >= area, for cotan weights.
  }
  // Second order: ratios tend to 4. Of the last two levels, with a fifth of room.
  EXPECT_NEAR(std::log2(excess[2] / excess[3]), 2, 0.2);
  EXPECT_NEAR(std::log2(moved[2] / moved[3]), 2, 0.4);
}

TEST(HarmonicMap, IsWhatAnyStartInItsClassLeadsTo) {
  Context context;
  const CoverSurface cover = coverOf(hyperbolicSample(4, 3));
  const Connectivity& surface = cover.surface;
  const CoverPlane plane = cover.plane();
  const std::vector<double> weights = positiveWeights(surface, cover.lengths);
  const VertexLinks links = linksOf(cover);
  SampleRandom random(5);
  std::vector<Motion> shift;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    shift.push_back(plane.shift({3 * random.uniform() - 1.5, 3 * random.uniform() - 1.5}));
  }
  VertexLinks wild(links.size());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    wild[h] = plane.inverse(shift[surface.tail(h)]) * links[h] * shift[surface.head(h)];
  }
  EXPECT_GT(countFolded(surface, wild), surface.faceCount() / 4);
  EXPECT_NEAR(coveredArea(cover.geometry, surface, wild), 4 * std::numbers::pi, 1e-8);
  const auto near = harmonicMap(context, cover.geometry, surface, weights, links);
  const auto far = harmonicMap(context, cover.geometry, surface, weights, wild);
  ASSERT_OK(near);
  ASSERT_OK(far);
  EXPECT_EQ(near->folded_faces, 0);
  EXPECT_EQ(far->folded_faces, 0);
  EXPECT_NEAR(near->energy, far->energy, 1e-10 * near->energy);
  // The same lifts: positions seen from the start's frames agree.
  double apart = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    const Eigen::Vector3d back = plane.inverse(near->moves[v]) * shift[v] * far->moves[v].col(2);
    apart = std::max(apart, back.head<2>().norm());
  }
  EXPECT_LT(apart, 1e-9);
}

TEST(HarmonicMap, GradientVanishesVertexByVertex) {
  // Each vertex is the weighted barycentre of its neighbours: found without the solver's Hessian.
  Context context;
  const CoverSurface cover = coverOf(hyperbolicSample(4, 3));
  const Connectivity& surface = cover.surface;
  const std::vector<double> weights = positiveWeights(surface, cover.lengths);
  const auto map = harmonicMap(context, cover.geometry, surface, weights, linksOf(cover));
  ASSERT_OK(map);
  std::vector<Eigen::Vector2d> sum(surface.vertexCount(), Eigen::Vector2d::Zero());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    sum[surface.tail(h)] += weights[surface.edge(h)] * cover.plane().wayTo(map->links[h].col(2));
  }
  for (const Eigen::Vector2d& pull : sum) EXPECT_LT(pull.norm(), 1e-12);
}

TEST(HarmonicMap, PullsKeepVerticesNearTheirPlaces) {
  Context context;
  const CoverSurface cover = coverOf(hyperbolicSample(4, 3));
  const std::vector<double> weights = positiveWeights(cover.surface, cover.lengths);
  double before = 1e9;
  for (const double pull : {0.0, 1.0, 100.0, 1e8}) {
    HarmonicOptions options;
    options.pulls.assign(cover.surface.vertexCount(), pull);
    const auto map =
        harmonicMap(context, cover.geometry, cover.surface, weights, linksOf(cover), options);
    ASSERT_OK(map);
    double farthest = 0;
    for (const Motion& move : map->moves) {
      farthest = std::max(farthest, cover.plane().wayTo(move.col(2)).norm());
    }
    EXPECT_LT(farthest, before);
    before = farthest;
  }
  EXPECT_LT(before, 1e-6);  // Weights of some units against 1e8.
}

TEST(HarmonicMap, StopsWhenItIsTold) {
  const CoverSurface cover = coverOf(hyperbolicSample(2));
  const std::vector<double> weights = positiveWeights(cover.surface, cover.lengths);
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(harmonicMap(context, cover.geometry, cover.surface, weights, linksOf(cover)),
              FailsWith(Reason::kCancelled));
  Context free;
  EXPECT_THAT(harmonicMap(free, cover.geometry, cover.surface, {1, 2}, linksOf(cover)),
              FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
