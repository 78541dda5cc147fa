#include "core/topology/homotopy_basis.h"

#include <Eigen/LU>
#include <cstdlib>

#include "core/topology/tree_cotree.h"
#include "tests/core/topology/surfaces.h"

namespace moduli {
namespace {

using surfaces::Named;
using surfaces::treesOf;

HomotopyBasis basisOf(const Connectivity& surface, const TreeCotree& trees) {
  auto basis = canonicalHomotopyBasis(surface, trees);
  EXPECT_OK(basis);
  return *std::move(basis);
}

std::vector<Named> surfacesWithHandles() {
  std::vector<Named> list;
  for (Named& named : surfaces::closed()) {
    if (surfaces::genusOf(named.surface) > 0) list.push_back(std::move(named));
  }
  return list;
}

/// a_1 b_1 a_1^-1 b_1^-1 .., freely reduced.
Word productOfCommutators(const HomotopyBasis& basis) {
  Word product;
  for (std::size_t i = 0; i < basis.a.size(); ++i) {
    for (const Word& factor :
         {basis.a[i], basis.b[i], inverseWord(basis.a[i]), inverseWord(basis.b[i])}) {
      product.insert(product.end(), factor.begin(), factor.end());
    }
  }
  return reduceWord(product);
}

/// a_1 .. a_g, b_1 .. b_g as walks.
std::vector<Walk> walksOf(const Connectivity& surface, const TreeCotree& trees,
                          const HomotopyBasis& basis) {
  std::vector<Walk> walks;
  for (const Word& word : basis.a) walks.push_back(walkOfWord(surface, trees, word));
  for (const Word& word : basis.b) walks.push_back(walkOfWord(surface, trees, word));
  return walks;
}

/// Intersection numbers of loops. With a basis of cochains, their J and their periods P(k, l) on
/// loop l, the Poincare dual of the loop, whose wedge with a form integrates to the form's period,
/// is the combination of cochains with the coefficients J^-1 P; the wedge of two such duals
/// integrates to P^T J^-T P.
IntegerMatrix intersections(const Connectivity& surface, const TreeCotree& trees,
                            const std::vector<Walk>& loops) {
  const std::vector<Cochain> cochains = cohomologyBasis(surface, trees);
  const Eigen::MatrixXd j = intersectionMatrix(surface, cochains, cochains).cast<double>();
  const Eigen::MatrixXd p = surfaces::periods(cochains, loops).cast<double>();
  const Eigen::MatrixXd result = p.transpose() * j.transpose().partialPivLu().solve(p);
  const Eigen::MatrixXd rounded = result.array().round();
  EXPECT_LT((result - rounded).norm(), 1e-6);
  return rounded.cast<Integer>();
}

IntegerMatrix standardForm(const HomotopyBasis& basis) {
  return standardSymplecticForm(static_cast<Eigen::Index>(basis.a.size()));
}

/// The word of the polygon that grows from face 0 when the other faces are glued to it one by one,
/// across the edges of their tree: the dull way.
Word polygonByGluing(const Connectivity& surface, const TreeCotree& trees) {
  std::vector<Index> sides = {0, 1, 2};
  for (std::size_t at = 0; at < sides.size();) {
    const Index beyond = surface.twin(sides[at]);
    if (trees.face_parent[beyond / 3] != beyond) {
      ++at;
      continue;
    }
    sides[at] = Connectivity::next(beyond);
    sides.insert(sides.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                 Connectivity::previous(beyond));
  }
  Word word;
  for (const Index h : sides) {
    const auto& edges = trees.leftover;
    const auto found = std::find(edges.begin(), edges.end(), surface.edge(h));
    if (found != edges.end()) {
      word.push_back(surface.sign(h) * static_cast<int>(found - edges.begin() + 1));
    }
  }
  return word;
}

TEST(Words, ReduceToTheShortest) {
  EXPECT_EQ(reduceWord({}), Word{});
  EXPECT_EQ(reduceWord({1, 2, -2, 3}), (Word{1, 3}));
  EXPECT_EQ(reduceWord({1, 2, 3, -3, -2, -1}), Word{});
  EXPECT_EQ(reduceWord({1, 2, -1}), (Word{1, 2, -1}));
}

TEST(Words, AWordTimesItsInverseIsNothing) {
  const Word word = {3, -1, 2, 2, -3};
  Word product = word;
  for (const int x : inverseWord(word)) product.push_back(x);
  EXPECT_EQ(reduceWord(product), Word{});
  EXPECT_EQ(inverseWord({1, -2}), (Word{2, -1}));
}

TEST(PolygonWord, HasEachLetterOncePerSign) {
  for (const auto& [name, surface] : surfaces::closed()) {
    SCOPED_TRACE(name);
    const Word word = polygonWord(surface, treesOf(surface));
    const int genus = surfaces::genusOf(surface);
    ASSERT_EQ(word.size(), 4 * genus);
    for (int x = 1; x <= 2 * genus; ++x) {
      EXPECT_EQ(std::count(word.begin(), word.end(), x), 1) << x;
      EXPECT_EQ(std::count(word.begin(), word.end(), -x), 1) << -x;
    }
    EXPECT_TRUE(word.empty() || word[0] == 1);
  }
}

TEST(PolygonWord, IsThePolygonGluedFaceByFace) {
  for (const auto& [name, surface] : surfacesWithHandles()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    Word dull = polygonByGluing(surface, trees);
    std::rotate(dull.begin(), std::find(dull.begin(), dull.end(), 1), dull.end());
    EXPECT_EQ(polygonWord(surface, trees), dull);
  }
}

TEST(PolygonWord, OfASquareIsACommutator) {
  const Connectivity surface = surfaces::gluedPolygon({1, 2, -1, -2});
  const Word word = polygonWord(surface, treesOf(surface));
  ASSERT_EQ(word.size(), 4);
  EXPECT_EQ(word[2], -word[0]);
  EXPECT_EQ(word[3], -word[1]);
}

TEST(HomotopyBasis, CommutatorsMultiplyToThePolygonInTheFreeGroup) {
  for (const auto& [name, surface] : surfacesWithHandles()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    const HomotopyBasis basis = basisOf(surface, trees);
    EXPECT_EQ(basis.a.size(), surfaces::genusOf(surface));
    EXPECT_EQ(basis.b.size(), basis.a.size());
    EXPECT_EQ(productOfCommutators(basis), polygonWord(surface, trees));
  }
}

TEST(HomotopyBasis, IsSymplecticInHomology) {
  for (const auto& [name, surface] : surfacesWithHandles()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    const HomotopyBasis basis = basisOf(surface, trees);
    EXPECT_EQ(intersections(surface, trees, walksOf(surface, trees, basis)), standardForm(basis));
  }
}

TEST(HomotopyBasis, SurvivesRenumbering) {
  std::mt19937 random(5);
  const Connectivity original = surfaces::connect(shapes::chainOfTori(3));
  for (int trial = 0; trial < 20; ++trial) {
    const Connectivity surface = surfaces::renumbered(original, random);
    const TreeCotree trees = treesOf(surface);
    const HomotopyBasis basis = basisOf(surface, trees);
    EXPECT_EQ(productOfCommutators(basis), polygonWord(surface, trees));
    EXPECT_EQ(intersections(surface, trees, walksOf(surface, trees, basis)), standardForm(basis));
  }
}

TEST(HomotopyBasis, WalksAreClosedPathsFromTheRoot) {
  for (const auto& [name, surface] : surfacesWithHandles()) {
    SCOPED_TRACE(name);
    const TreeCotree trees = treesOf(surface);
    for (const Walk& walk : walksOf(surface, trees, basisOf(surface, trees))) {
      ASSERT_FALSE(walk.empty());
      surfaces::expectPath(surface, walk);
      EXPECT_EQ(surfaces::startOf(surface, walk.front()), 0);
      EXPECT_EQ(surfaces::endOf(surface, walk.back()), 0);
    }
  }
}

TEST(HomotopyBasis, PeriodsCountTheLettersOfAWord) {
  std::mt19937 random(8);
  const Connectivity surface = surfaces::connect(shapes::chainOfTori(3));
  const TreeCotree trees = treesOf(surface);
  const std::vector<Cochain> cochains = cohomologyBasis(surface, trees);
  for (int trial = 0; trial < 20; ++trial) {
    Word word;
    for (int i = 0; i < 30; ++i) {
      const int x = 1 + static_cast<int>(random() % 6);
      word.push_back(random() % 2 == 0 ? x : -x);
    }
    const Walk walk = walkOfWord(surface, trees, word);
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(integrate(cochains[k], walk), std::count(word.begin(), word.end(), k + 1) -
                                                  std::count(word.begin(), word.end(), -(k + 1)));
    }
  }
  EXPECT_TRUE(walkOfWord(surface, trees, {1, 4, -4, -1}).empty());
}

TEST(HomotopyBasis, OnTheTorusBPassesAFromRightToLeft) {
  // The grid's directions u, v are an oriented chart: loops with (p, q) and (r, s) turns meet
  // p s - q r times.
  constexpr Index kM = 7;
  constexpr Index kN = 5;
  const Connectivity surface = surfaces::connect(shapes::torusGrid(kM, kN));
  const auto turns = [&](const Walk& walk, Index divisor, Index n) {
    Index steps = 0;
    for (const Step& step : walk) {
      const Index from = surfaces::startOf(surface, step) / divisor % n;
      const Index to = surfaces::endOf(surface, step) / divisor % n;
      const Index d = (to - from + n) % n;
      steps += d == n - 1 ? -1 : d;
    }
    EXPECT_EQ(steps % n, 0);
    return steps / n;
  };
  const TreeCotree trees = treesOf(surface);
  const HomotopyBasis basis = basisOf(surface, trees);
  const Walk a = walkOfWord(surface, trees, basis.a[0]);
  const Walk b = walkOfWord(surface, trees, basis.b[0]);
  EXPECT_EQ(turns(a, kN, kM) * turns(b, 1, kN) - turns(a, 1, kN) * turns(b, kN, kM), 1);
}

TEST(HomotopyBasis, TheWordReadClockwiseHasTheOppositeIntersections) {
  const Connectivity surface = surfaces::connect(shapes::chainOfTori(3));
  const TreeCotree trees = treesOf(surface);
  const auto basis = canonicalBasisOfPolygon(inverseWord(polygonWord(surface, trees)));
  ASSERT_OK(basis);
  EXPECT_EQ(intersections(surface, trees, walksOf(surface, trees, *basis)), -standardForm(*basis));
}

TEST(HomotopyBasis, WrongConventionsAreSeen) {
  for (int genus = 1; genus <= 4; ++genus) {
    const Connectivity surface = surfaces::connect(shapes::chainOfTori(genus));
    const TreeCotree trees = treesOf(surface);
    const HomotopyBasis basis = basisOf(surface, trees);
    HomotopyBasis swapped = {basis.b, basis.a};
    HomotopyBasis turned = basis;
    for (Word& word : turned.b) word = inverseWord(word);
    for (const HomotopyBasis& wrong : {swapped, turned}) {
      EXPECT_NE(productOfCommutators(wrong), polygonWord(surface, trees));
      EXPECT_EQ(intersections(surface, trees, walksOf(surface, trees, wrong)),
                -standardForm(basis));
    }
  }
}

TEST(CanonicalBasisOfPolygon, SucceedsExactlyWhereAllCornersMeetAtOnePoint) {
  std::mt19937 random(13);
  int succeeded = 0;
  int failed = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Word polygon = surfaces::randomSides(2 + trial % 11, 0, random);
    const auto basis = canonicalBasisOfPolygon(polygon);
    const bool one_corner = surfaces::gluedPolygon(polygon).vertexCount() == 1;
    ASSERT_EQ(basis.ok(), one_corner);
    if (basis.ok()) {
      ++succeeded;
      ASSERT_EQ(productOfCommutators(*basis), polygon);
    } else {
      ++failed;
      ASSERT_THAT(basis, FailsWith(Reason::kInvalidOption));
    }
  }
  EXPECT_GT(succeeded, 100);
  EXPECT_GT(failed, 100);
}

TEST(CanonicalBasisOfPolygon, WordsGrowWithTheGenusOnly) {
  for (const int genus : {1, 10, 100}) {
    const auto basis = canonicalBasisOfPolygon(surfaces::oppositeSides(genus));
    ASSERT_OK(basis);
    EXPECT_EQ(productOfCommutators(*basis), surfaces::oppositeSides(genus));
    for (const Word& word : basis->a) EXPECT_LE(word.size(), 4 * genus);
    for (const Word& word : basis->b) EXPECT_LE(word.size(), 8 * genus);
  }
}

TEST(CanonicalBasisOfPolygon, KeepsACanonicalWord) {
  const auto basis = canonicalBasisOfPolygon({1, 2, -1, -2, 3, 4, -3, -4});
  ASSERT_OK(basis);
  EXPECT_EQ(basis->a, (std::vector<Word>{{1}, {3}}));
  EXPECT_EQ(basis->b, (std::vector<Word>{{2}, {4}}));
}

TEST(CanonicalBasisOfPolygon, RefusesWhatIsNoGluing) {
  for (const Word& word : {Word{1}, Word{1, 1}, Word{1, -1, 2}, Word{0, 0}, Word{2, -2},
                           Word{1, 2, -1, -3}, Word{1, 2, -1, 2}, Word{1, -1}}) {
    EXPECT_THAT(canonicalBasisOfPolygon(word), FailsWith(Reason::kInvalidOption));
  }
}

TEST(HomotopyBasis, RefusesSpheresAndBoundary) {
  const Connectivity sphere = surfaces::connect(shapes::octahedron());
  EXPECT_THAT(canonicalHomotopyBasis(sphere, treesOf(sphere)),
              FailsWith(Reason::kUnsupportedTopology));
  const Connectivity annulus = surfaces::connect(shapes::annulus());
  EXPECT_THAT(canonicalHomotopyBasis(annulus, treesOf(annulus)),
              FailsWith(Reason::kUnsupportedTopology));
}

}  // namespace
}  // namespace moduli
