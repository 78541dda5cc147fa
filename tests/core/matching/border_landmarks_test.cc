#include "core/matching/border_landmarks.h"

#include <algorithm>
#include <numeric>

#include "tests/core/matching/bordered_samples.h"

namespace moduli {
namespace {

TEST(BorderPlaces, KnowsPointsOfTheBoundaryFromOthers) {
  const TriangleMesh mesh = meshOf(ring(4, 2, 3));
  const Connectivity& surface = mesh.connectivity();
  const BorderPlaces places(mesh);
  Index on = 0;
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const auto middle = borderPointAt(surface, edgePoint(h, 0.25));
    ASSERT_EQ(middle.has_value(), surface.twin(h) == kNone);
    if (!middle) continue;
    ++on;
    EXPECT_EQ(middle->halfedge, h);
    EXPECT_NEAR(middle->t, 0.25, 1e-15);
    // Both ends are vertices, the second one that of the next edge.
    const auto end = borderPointAt(surface, edgePoint(h, 1));
    ASSERT_TRUE(end);
    EXPECT_EQ(surface.tail(end->halfedge), surface.head(h));
    EXPECT_EQ(end->t, 0);
    EXPECT_EQ(places.loopOf(end->halfedge), places.loopOf(h));
    const Index count = static_cast<Index>(places.loops()[places.loopOf(h)].size());
    EXPECT_EQ(places.numberOf(end->halfedge), (places.numberOf(h) + 1) % count);
  }
  EXPECT_EQ(on, static_cast<Index>(places.loops()[0].size() + places.loops()[1].size()));
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_EQ(borderPointAt(surface, vertexPoint(surface, v)).has_value(),
              surface.isBoundaryVertex(v));
  }
  EXPECT_FALSE(borderPointAt(surface, {0, {0.3, 0.3, 0.4}}));
}

class Marks {
 public:
  Marks() : mesh_(meshOf(ring(6, 2, 3))), places_(mesh_) {}

  /// Between vertices of loops, an eighth of these apart.
  MatchLandmark mark(int loop, int from, int there, int to) const {
    const auto at = [&](int i, int eighths) {
      const std::vector<Index>& halfedges = places_.loops()[i];
      return edgePoint(halfedges[eighths * halfedges.size() / 8], 0.5);
    };
    return {at(loop, from), at(there, to), "mark"};
  }
  Status check(std::vector<MatchLandmark> marks) const {
    for (std::size_t i = 0; i < marks.size(); ++i) marks[i].name = std::to_string(i);
    return checkBorderOrder(places_, places_, mesh_.connectivity(), mesh_.connectivity(), marks);
  }
  std::vector<Index> loops(const std::vector<MatchLandmark>& marks) const {
    return loopsByLandmarks(places_, places_, mesh_.connectivity(), mesh_.connectivity(), marks);
  }

 private:
  TriangleMesh mesh_;
  BorderPlaces places_;
};

// By trying all orders of five; in order are those that go around once.
TEST(BorderLandmarks, RefusesAllOrdersButTheCyclicOnes) {
  const Marks marks;
  std::vector<int> order = {0, 1, 2, 3, 4};
  int good = 0;
  do {
    std::vector<MatchLandmark> landmarks;
    int descents = 0;
    for (int i = 0; i < 5; ++i) {
      landmarks.push_back(marks.mark(1, i, 0, order[i]));
      descents += order[(i + 1) % 5] < order[i];
    }
    // Whatever their order in the list.
    std::rotate(landmarks.begin(), landmarks.begin() + order[0], landmarks.end());
    EXPECT_EQ(marks.check(landmarks).ok(), descents == 1);
    good += descents == 1;
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(good, 5);
}

TEST(BorderLandmarks, NamesTheOneOutOfOrderAndOneThatItCrosses) {
  const Marks marks;
  std::vector<MatchLandmark> landmarks;
  for (int i = 0; i < 8; ++i) landmarks.push_back(marks.mark(0, i, 0, (i + 3) % 8));
  EXPECT_OK(marks.check(landmarks));
  // Mark 5 goes where mark 1 did, which is left out: it crosses 2, 3 and 4.
  landmarks[5] = marks.mark(0, 5, 0, 4);
  landmarks.erase(landmarks.begin() + 1);
  const Status status = marks.check(landmarks);
  EXPECT_EQ(status.reason(), Reason::kFoldedMap);
  EXPECT_THAT(status.message(), testing::HasSubstr("3 and 4 contradict each other"));
}

TEST(BorderLandmarks, OneLoopGoesToOneLoop) {
  const Marks marks;
  EXPECT_OK(marks.check({marks.mark(0, 0, 1, 0), marks.mark(1, 0, 0, 0)}));
  EXPECT_THAT(marks.check({marks.mark(0, 0, 1, 0), marks.mark(0, 1, 0, 0)}),
              FailsWith(Reason::kFoldedMap));
  EXPECT_THAT(marks.check({marks.mark(0, 0, 1, 0), marks.mark(1, 1, 1, 1)}),
              FailsWith(Reason::kFoldedMap));
  EXPECT_EQ(marks.loops({marks.mark(0, 0, 1, 0)}), (std::vector<Index>{1, kNone}));
  // The first one counts.
  EXPECT_EQ(marks.loops({marks.mark(1, 0, 1, 0), marks.mark(0, 0, 1, 0)}),
            (std::vector<Index>{kNone, 1}));
}

}  // namespace
}  // namespace moduli
