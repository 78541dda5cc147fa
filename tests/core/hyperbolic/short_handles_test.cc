#include "core/hyperbolic/short_handles.h"

#include <cmath>
#include <random>

#include "core/hyperbolic/side_pairings.h"
#include "tests/core/hyperbolic/groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

/// Elements without any relation: what holds for them holds in the free group.
std::vector<WideSu11> freeLetters(int count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0.5, 3);
  std::vector<WideSu11> letters;
  for (int k = 0; k < count; ++k) {
    letters.push_back(widened(rotation(2 * uniform(engine)) * translation(uniform(engine)) *
                              rotation(2 * uniform(engine))));
  }
  return letters;
}

WideSu11 productOfCommutators(const std::vector<GroupHandle>& handles) {
  WideSu11 product;
  for (const GroupHandle& h : handles) {
    product = product * h.a * h.b * inverse(h.a) * inverse(h.b);
  }
  return product;
}

double relativeDistance(const WideSu11& g, const WideSu11& h) {
  const WideSu11 difference = {g.a - h.a, g.b - h.b};
  return std::hypot(std::abs(rounded(difference).a), std::abs(rounded(difference).b)) /
         std::abs(rounded(g).a);
}

const std::vector<Word> kPolygons = {{1, 2, -1, -2},
                                     {1, 2, 3, 4, -1, -2, -3, -4},
                                     {1, 2, -1, 3, -2, 4, -3, -4},
                                     {1, 2, 3, 4, 5, 6, -1, -2, -3, -4, -5, -6}};

TEST(SplitIntoHandles, GivesTheWordInTheFreeGroup) {
  for (const Word& word : kPolygons) {
    const std::vector<WideSu11> letters = freeLetters(static_cast<int>(word.size() / 2), 1);
    const auto handles = splitIntoHandles(letters, word);
    ASSERT_OK(handles);
    EXPECT_EQ(handles->size(), word.size() / 4);
    // Both with their signs: no lift is lost. 113 bits less what long words take.
    EXPECT_LE(relativeDistance(evaluate(letters, word), productOfCommutators(*handles)), 1e-15);
  }
}

TEST(SplitIntoHandles, RefusesPolygonsOfSeveralPoints) {
  EXPECT_THAT(splitIntoHandles(freeLetters(2, 1), {1, -1, 2, -2}),
              FailsWith(Reason::kInvalidOption));
}

TEST(ShortenHandles, KeepsTheTraceOfTheProductInTheFreeGroup) {
  for (const Word& word : kPolygons) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      const auto handles =
          splitIntoHandles(freeLetters(static_cast<int>(word.size() / 2), seed), word);
      ASSERT_OK(handles);
      // Every move is the best one for some of these.
      const double weight = 0.5 * (seed % 4);
      Context context;
      const auto shorter = shortenHandles(context, *handles, weight);
      ASSERT_OK(shorter);
      const double before = trace(rounded(productOfCommutators(*handles)));
      const double after = trace(rounded(productOfCommutators(shorter->handles)));
      EXPECT_NEAR(after / before, 1, 1e-12);
      const WideSu11 back =
          shorter->base * productOfCommutators(shorter->handles) * inverse(shorter->base);
      EXPECT_LT(distanceUpToSign(rounded(back), rounded(productOfCommutators(*handles))),
                1e-12 * std::abs(before));
    }
  }
}

TEST(ShortenHandles, UndoesTwistsThatMakeGeneratorsLong) {
  std::vector<GroupHandle> handles;
  const std::vector<Su11> group = polygonGroup(3);
  for (std::size_t k = 0; k < group.size(); k += 2) {
    handles.push_back({widened(group[k]), inverse(widened(group[k + 1]))});
  }
  std::vector<GroupHandle> twisted = handles;
  for (int times = 0; times < 4; ++times) {
    twisted[0].a = twisted[0].a * twisted[0].b;
    twisted[1].b = twisted[1].b * twisted[1].a;
  }
  Context context;
  const auto shorter = shortenHandles(context, twisted, 0.5);
  ASSERT_OK(shorter);
  EXPECT_GT(roundingGrowth(twisted), 1e3 * roundingGrowth(handles));
  EXPECT_LE(roundingGrowth(shorter->handles), 3 * roundingGrowth(handles));
}

/// g h = (g h g^-1) g = h (h^-1 g h) for the commutators of two neighbours.
TEST(ShortenHandles, UndoesExchangesThatMakeGeneratorsLong) {
  std::vector<GroupHandle> handles;
  const std::vector<WideSu11> letters = freeLetters(6, 3);
  for (std::size_t k = 0; k < letters.size(); k += 2) {
    handles.push_back({letters[k], letters[k + 1]});
  }
  const auto conjugated = [](const WideSu11& by, const GroupHandle& h) {
    return GroupHandle{by * h.a * inverse(by), by * h.b * inverse(by)};
  };
  for (const bool leftwards : {true, false}) {
    std::vector<GroupHandle> exchanged = handles;
    for (int times = 0; times < 3; ++times) {
      const GroupHandle g = exchanged[0];
      const GroupHandle h = exchanged[1];
      exchanged[0] = leftwards ? conjugated(productOfCommutators({g}), h) : h;
      exchanged[1] = leftwards ? g : conjugated(inverse(productOfCommutators({h})), g);
    }
    Context context;
    const auto shorter = shortenHandles(context, exchanged, 0);
    ASSERT_OK(shorter);
    EXPECT_LT(roundingGrowth(shorter->handles), 1e-3 * roundingGrowth(exchanged));
    EXPECT_NEAR(trace(rounded(productOfCommutators(shorter->handles))) /
                    trace(rounded(productOfCommutators(handles))),
                1, 1e-12);
  }
}

TEST(FindShortHandles, StopsWhenCancelled) {
  CancelToken token;
  token.cancel();
  Context context;
  context.setCancelToken(token);
  EXPECT_THAT(findShortHandles(context, freeLetters(4, 1), kPolygons[1]),
              FailsWith(Reason::kCancelled));
}

TEST(SidePairings, CarryTheEdgesOfThePlacedFacesToOneAnother) {
  for (const char* kind : {"bolza", "klein"}) {
    const HyperbolicTriangles triangles = regularSample(kind);
    const Connectivity& surface = triangles.surface;
    Context context;
    const auto development = develop(context, triangles);
    ASSERT_OK(development);
    const SidePairings pairings = findSidePairings(surface, *development);
    ASSERT_EQ(static_cast<Index>(pairings.letters.size()), 2 - surface.eulerCharacteristic());
    const auto corner = [&](Index h) {
      const Su11& placed = development->placed[Connectivity::faceOf(h)];
      return imageOf(placed * cornerFrame(triangles, h), 0.0);
    };
    for (std::size_t k = 0; k < pairings.letters.size(); ++k) {
      const Index h = surface.halfedge(pairings.edges[k]);
      const Index twin = surface.twin(h);
      const Su11& g = pairings.letters[k];
      EXPECT_LE(std::abs(imageOf(g, corner(twin)) - corner(Connectivity::next(h))), 1e-12);
      EXPECT_LE(std::abs(imageOf(g, corner(Connectivity::next(twin))) - corner(h)), 1e-12);
    }
    EXPECT_EQ(pairings.relation.size(), 2 * pairings.letters.size());
    EXPECT_LE(distanceToUnit(evaluateWord(pairings.letters, pairings.relation)), 1e-9);
    EXPECT_OK(canonicalBasisOfPolygon(pairings.relation));
  }
}

}  // namespace
}  // namespace moduli
