#include "core/matching/hemisphere_flow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>

#include "core/matching/capped_disk.h"
#include "core/matching/split_surface.h"
#include "core/spherical/exact_sign.h"
#include "tests/core/matching/disk_samples.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

struct Mapped {
  SplitSurface split;
  TriangleMesh capped;
  Points3 points;

  explicit Mapped(const TriangleSoup& soup)
      : split(*SplitSurface::make(*TriangleMesh::fromSoup(soup))),
        capped(*cappedDisk(split.mesh())) {
    Context context;
    points = *conformalHemisphere(context, split.mesh(), capped, true);
  }
  const Connectivity& surface() const { return capped.connectivity(); }
  bool isRim(Index v) const { return split.mesh().connectivity().isBoundaryVertex(v); }

  /// No fold, the boundary on the equator to the last bit, all else above, the pole where it was.
  void expectHemisphere(const Points3& there) const {
    for (const auto& [a, b, c] : surface().faces()) {
      EXPECT_EQ(spherical::orientationSign(there[a], there[b], there[c]), 1);
    }
    for (Index v = 0; v + 1 < capped.vertexCount(); ++v) {
      EXPECT_TRUE(isRim(v) ? there[v].z() == 0 : there[v].z() > 0);
    }
    EXPECT_EQ(there.back(), Vector3d(0, 0, -1));
  }

  HemisphereFlow flow(const std::vector<HemisphereMark>& marks) const {
    Context context;
    auto found = flowOnHemisphere(context, surface(), points, marks);
    EXPECT_OK(found);
    expectHemisphere(found->points);
    return *std::move(found);
  }

  /// Every so many vertices, sent where another one is, some edges on; some points within faces.
  std::vector<HemisphereMark> marks(Index every) const {
    std::vector<HemisphereMark> result;
    for (Index v = 3; v + 1 < capped.vertexCount(); v += every) {
      Index to = v;
      for (int n = 0; n < 2; ++n) {
        const Index first = surface().outgoing(to);
        for (Index h = first; isRim(surface().head(h)) != isRim(v) || surface().head(h) == v;) {
          h = surface().rotate(h);
          if (h == first) break;
          if (isRim(surface().head(h)) == isRim(v)) to = surface().head(h);
        }
      }
      HemisphereMark mark{vertexPoint(surface(), v), points[to]};
      result.push_back(mark);
    }
    return result;
  }
};

TEST(HemisphereFlow, MeetsMarksInsideAndOnTheBoundary) {
  for (const int seed : {1, 2}) {
    const Mapped disk(shield(14, seed));
    std::vector<HemisphereMark> marks = disk.marks(60);
    int on_rim = 0;
    double at_first = 0;
    for (const HemisphereMark& mark : marks) {
      on_rim += mark.target.z() == 0;
      at_first = std::max(
          at_first, (spherePoint(disk.surface(), disk.points, mark.point) - mark.target).norm());
    }
    ASSERT_GT(on_rim, 0);
    ASSERT_LT(on_rim, static_cast<int>(marks.size()));
    const HemisphereFlow flow = disk.flow(marks);
    EXPECT_TRUE(flow.met);
    double missed = 0;
    for (const HemisphereMark& mark : marks) {
      missed = std::max(
          missed, (spherePoint(disk.surface(), flow.points, mark.point) - mark.target).norm());
    }
    std::cout << marks.size() << " marks, " << on_rim << " on the boundary, at first missed by "
              << at_first << ", after " << flow.steps << " steps by " << missed << "\n";
    // 1e-7 of edges that are shorter than a fifth.
    EXPECT_LT(missed, 2e-8);
  }
}

TEST(HemisphereFlow, LeavesAMapAloneThatMeetsThem) {
  const Mapped disk(shield(8, 1));
  std::vector<HemisphereMark> marks;
  for (const Index v : {3, 40, 100}) {
    marks.push_back({vertexPoint(disk.surface(), v), disk.points[v]});
  }
  const HemisphereFlow flow = disk.flow(marks);
  EXPECT_EQ(flow.steps, 0);
  EXPECT_EQ(flow.points, disk.points);
}

// Turned about the axis of the half sphere, all goes with it.
TEST(HemisphereFlow, CommutesWithTurns) {
  Mapped disk(shield(10, 1));
  std::vector<HemisphereMark> marks = disk.marks(60);
  const Points3 own = disk.flow(marks).points;
  // A quarter and a half: the equator stays one to the last bit.
  const auto turned = [](const Vector3d& p) { return Vector3d(-p[1], p[0], p[2]); };
  for (Vector3d& p : disk.points) p = turned(p);
  for (HemisphereMark& mark : marks) mark.target = turned(mark.target);
  const Points3 other = disk.flow(marks).points;
  double apart = 0;
  for (std::size_t v = 0; v < own.size(); ++v) {
    apart = std::max(apart, (turned(own[v]) - other[v]).norm());
  }
  EXPECT_LT(apart, 1e-9);
}

TEST(HemisphereFlow, StopsBeforeAFold) {
  const Mapped disk(shield(8, 1));
  // Two neighbours on the boundary change places.
  Index h = 0;
  while (disk.split.mesh().connectivity().twin(h) != kNone) ++h;
  const Index v = disk.surface().tail(h), w = disk.surface().head(h);
  const HemisphereFlow flow = disk.flow({{vertexPoint(disk.surface(), v), disk.points[w]},
                                         {vertexPoint(disk.surface(), w), disk.points[v]}});
  EXPECT_FALSE(flow.met);
}

TEST(HemisphereFlow, StopsWhenCancelled) {
  const Mapped disk(shield(8, 1));
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(flowOnHemisphere(context, disk.surface(), disk.points, disk.marks(40)),
              FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
