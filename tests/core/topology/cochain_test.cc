#include "core/topology/cochain.h"

#include "core/topology/tree_cotree.h"
#include "tests/core/topology/surfaces.h"

namespace moduli {
namespace {

/// Face by face, with values on all edges: the dull way.
Integer denseIntersection(const Connectivity& surface, const Cochain& a, const Cochain& b) {
  const auto dense = [&](const Cochain& cochain) {
    std::vector<Integer> values(surface.edgeCount(), 0);
    for (const CochainTerm& term : cochain) values[term.edge] = term.value;
    return values;
  };
  const std::vector<Integer> x = dense(a);
  const std::vector<Integer> y = dense(b);
  Integer twice = 0;
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    const auto along12 = [&](const std::vector<Integer>& v) {
      return surface.sign(h) * v[surface.edge(h)];
    };
    const auto along13 = [&](const std::vector<Integer>& v) {
      return -surface.sign(h + 2) * v[surface.edge(h + 2)];
    };
    twice += along12(x) * along13(y) - along13(x) * along12(y);
  }
  EXPECT_EQ(twice % 2, 0);
  return twice / 2;
}

void expectDenseTwin(const Connectivity& surface, const std::vector<Cochain>& a,
                     const std::vector<Cochain>& b) {
  const IntegerMatrix matrix = intersectionMatrix(surface, a, b);
  ASSERT_EQ(matrix.rows(), a.size());
  ASSERT_EQ(matrix.cols(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      EXPECT_EQ(matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)),
                denseIntersection(surface, a[i], b[k]));
    }
  }
}

/// Random combinations of cochains, so that values other than -1, 0 and 1 occur.
std::vector<Cochain> mixed(const std::vector<Cochain>& cochains, std::mt19937& random) {
  IntegerMatrix coefficients(3, cochains.size());
  for (Integer& x : coefficients.reshaped()) x = static_cast<Integer>(random() % 9) - 4;
  std::vector<Cochain> result;
  for (Eigen::Index row = 0; row < 3; ++row) {
    auto combined = combineCochains(cochains, coefficients, row);
    EXPECT_OK(combined);
    result.push_back(*std::move(combined));
  }
  return result;
}

TEST(Cochain, GatheringSortsAddsAndDropsZeros) {
  EXPECT_EQ(gatherTerms({}), Cochain{});
  EXPECT_EQ(gatherTerms({{4, 1}, {2, 3}, {4, 2}}), (Cochain{{2, 3}, {4, 3}}));
  EXPECT_EQ(gatherTerms({{4, 1}, {2, 3}, {4, -1}}), (Cochain{{2, 3}}));
  EXPECT_EQ(gatherTerms({{2, 3}, {4, 1}, {2, -3}}), (Cochain{{4, 1}}));
  EXPECT_EQ(gatherTerms({{5, 1}, {5, -1}, {5, 0}, {1, 0}, {3, 0}}), Cochain{});
}

TEST(Cochain, CombinationsAreLinear) {
  const std::vector<Cochain> cochains = {{{0, 1}, {3, -1}}, {{3, 2}, {5, 7}}};
  IntegerMatrix coefficients(3, 2);
  coefficients << 2, 1, 0, 0, -1, 3;
  const auto first = combineCochains(cochains, coefficients, 0);
  ASSERT_OK(first);
  EXPECT_EQ(*first, (Cochain{{0, 2}, {5, 7}}));
  const auto second = combineCochains(cochains, coefficients, 1);
  ASSERT_OK(second);
  EXPECT_EQ(*second, Cochain{});
  const auto third = combineCochains(cochains, coefficients, 2);
  ASSERT_OK(third);
  EXPECT_EQ(*third, (Cochain{{0, -1}, {3, 7}, {5, 21}}));
}

TEST(Cochain, CombinationsNoticeOverflow) {
  const std::vector<Cochain> cochains = {{{0, 4}}, {{0, 4}}};
  constexpr Integer kLarge = kLargestCochainValue;
  constexpr Integer kHuge = Integer{1} << 62;
  IntegerMatrix coefficients(5, 2);
  // A product, two sums of products, a sum that is too large, and what still fits.
  coefficients << kHuge, 0, kHuge / 4, kHuge / 4, -kHuge / 4, -kHuge / 4, kLarge / 4, 1, kLarge / 8,
      kLarge / 8;
  for (Eigen::Index row = 0; row < 4; ++row) {
    EXPECT_THAT(combineCochains(cochains, coefficients, row), FailsWith(Reason::kOverflow)) << row;
  }
  const auto largest = combineCochains(cochains, coefficients, 4);
  ASSERT_OK(largest);
  EXPECT_EQ(*largest, (Cochain{{0, kLarge}}));
}

TEST(Cochain, IntersectionsAreThoseOfTheDenseWedge) {
  std::mt19937 random(4);
  for (const auto& [name, surface] : surfaces::closed()) {
    SCOPED_TRACE(name);
    const auto trees = computeTreeCotree(surface);
    ASSERT_OK(trees);
    const std::vector<Cochain> basis = cohomologyBasis(surface, *trees);
    if (basis.empty()) continue;
    expectDenseTwin(surface, basis, basis);
    expectDenseTwin(surface, mixed(basis, random), mixed(basis, random));
  }
}

TEST(Cochain, IntersectionsWithRelativeCochainsAreThoseOfTheDenseWedge) {
  std::mt19937 random(4);
  for (const auto& [name, surface] : surfaces::bordered()) {
    SCOPED_TRACE(name);
    const auto absolute = computeTreeCotree(surface);
    const auto relative = computeRelativeTreeCotree(surface);
    ASSERT_OK(absolute);
    ASSERT_OK(relative);
    const std::vector<Cochain> free = cohomologyBasis(surface, *absolute);
    const std::vector<Cochain> fixed = cohomologyBasis(surface, *relative);
    if (free.empty()) continue;
    expectDenseTwin(surface, fixed, free);
    expectDenseTwin(surface, free, fixed);
    expectDenseTwin(surface, mixed(fixed, random), mixed(free, random));
  }
}

TEST(Cochain, IntersectionsOfNothingAreEmpty) {
  const Connectivity surface = surfaces::connect(shapes::tetrahedron());
  EXPECT_EQ(intersectionMatrix(surface, {}, {}).size(), 0);
  EXPECT_EQ(intersectionMatrix(surface, {{}}, {{}, {}}), IntegerMatrix::Zero(1, 2));
}

}  // namespace
}  // namespace moduli
