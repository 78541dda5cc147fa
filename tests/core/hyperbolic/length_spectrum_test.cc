#include "core/hyperbolic/length_spectrum.h"

#include <cmath>
#include <set>

#include "core/hyperbolic/axis.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/hyperbolic/sample_groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

std::vector<Su11> sampleGroup(const char* kind, Index root = 0) {
  const auto surface = makeIntrinsicSample(kind);
  EXPECT_OK(surface);
  return holonomyGenerators(*surface, root);
}

OrbitPolygon polygonOf(const std::vector<Su11>& generators, int genus) {
  Context context;
  auto polygon = orbitPolygon(context, generators, genus);
  EXPECT_OK(polygon);
  return polygon.ok() ? *polygon : OrbitPolygon{};
}

LengthSpectrum spectrumOf(const OrbitPolygon& polygon, double length) {
  Context context;
  auto spectrum = lengthSpectrum(context, polygon, length);
  EXPECT_OK(spectrum);
  return spectrum.ok() ? *spectrum : LengthSpectrum{};
}

/// Lengths that agree to 1e-8 as one, with how many there are.
std::vector<std::pair<double, int>> multiplicities(const LengthSpectrum& spectrum) {
  std::vector<std::pair<double, int>> result;
  for (const ClosedGeodesic& geodesic : spectrum.geodesics) {
    if (result.empty() || geodesic.length - result.back().first > 1e-8)
      result.emplace_back(geodesic.length, 0);
    ++result.back().second;
  }
  return result;
}

void expectEqualLengths(const LengthSpectrum& a, const LengthSpectrum& b, double tolerance) {
  ASSERT_EQ(a.geodesics.size(), b.geodesics.size());
  for (std::size_t i = 0; i < a.geodesics.size(); ++i)
    EXPECT_NEAR(a.geodesics[i].length, b.geodesics[i].length, tolerance) << i;
}

TEST(LengthSpectrum, OfBolzasSurface) {
  const auto found = multiplicities(spectrumOf(polygonOf(sampleGroup("bolza"), 2), 6.2));
  const double root = std::sqrt(2.0);
  // Twice the shortest, 6.114, is a power and no entry.
  ASSERT_EQ(found.size(), 3);
  EXPECT_NEAR(found[0].first, 2 * std::acosh(1 + root), 1e-10);
  EXPECT_NEAR(found[0].first, 3.05714183896200, 1e-10);
  EXPECT_NEAR(found[1].first, 2 * std::acosh(3 + 2 * root), 1e-10);
  EXPECT_NEAR(found[2].first, 2 * std::acosh(5 + 3 * root), 1e-10);
  EXPECT_EQ(found[0].second, 12);
  EXPECT_EQ(found[1].second, 12);
  EXPECT_EQ(found[2].second, 24);
}

TEST(LengthSpectrum, OfKleinsQuartic) {
  const auto found = multiplicities(spectrumOf(polygonOf(sampleGroup("klein"), 3), 5.3));
  const double eta = 2 * std::cos(2 * std::acos(-1.0) / 7);
  ASSERT_EQ(found.size(), 2);
  EXPECT_NEAR(found[0].first, 8 * std::acosh((1 + eta) / 2), 1e-10);
  EXPECT_NEAR(found[0].first, 3.93594624883033, 1e-10);
  EXPECT_EQ(found[0].second, 21);
  EXPECT_NEAR(found[1].first, 5.208017, 1e-6);
}

TEST(LengthSpectrum, OfARegularPolygonHasItsSidePairings) {
  // |trace| = 2 + 2 cos(pi / (2 g)) of the pairings, which are the shortest: 2 g of them.
  for (int genus = 2; genus <= 4; ++genus) {
    Context context;
    const auto shortest = systoles(context, polygonOf(regularPolygonGroup(genus), genus));
    ASSERT_OK(shortest);
    EXPECT_EQ(shortest->geodesics.size(), static_cast<std::size_t>(2 * genus));
    EXPECT_NEAR(shortest->geodesics[0].length,
                2 * std::acosh(1 + std::cos(std::acos(-1.0) / (2 * genus))), 1e-11);
  }
}

TEST(LengthSpectrum, SystolesAreTheFirstOfTheSpectrum) {
  Context context;
  for (const auto& [kind, genus, count] :
       {std::tuple("bolza", 2, 12), std::tuple("klein", 3, 21)}) {
    const auto shortest = systoles(context, polygonOf(sampleGroup(kind), genus));
    ASSERT_OK(shortest);
    EXPECT_EQ(shortest->geodesics.size(), static_cast<std::size_t>(count));
  }
}

TEST(LengthSpectrum, OtherGeneratorsKeepIt) {
  for (const auto& [kind, genus] : {std::pair("bolza", 2), std::pair("klein", 3)}) {
    const LengthSpectrum spectrum = spectrumOf(polygonOf(sampleGroup(kind), genus), 5.9);
    // Generators that move 0 by 10 are right to 1e-14; expressing short elements by three of them
    // multiplies that by some 1e4.
    for (const Index root : {3, 8})
      expectEqualLengths(spectrumOf(polygonOf(sampleGroup(kind, root), genus), 5.9), spectrum,
                         1e-9);
    expectEqualLengths(spectrumOf(polygonOf(otherGenerators(sampleGroup(kind), 7), genus), 5.9),
                       spectrum, 1e-9);
  }
}

TEST(LengthSpectrum, ConjugationOfTheGroupKeepsIt) {
  const std::vector<Su11> generators = regularPolygonGroup(3);
  const LengthSpectrum spectrum = spectrumOf(polygonOf(generators, 3), 5.8);
  EXPECT_GT(spectrum.geodesics.size(), 20);
  for (const Su11& move : {rotation(1.2), translationTo({0.3, 0.6}), translationTo({0.1, -0.9})})
    expectEqualLengths(spectrumOf(polygonOf(conjugated(generators, move), 3), 5.8), spectrum, 1e-9);
}

TEST(LengthSpectrum, MirrorImageKeepsIt) {
  std::vector<Su11> mirrored = sampleGroup("klein");
  for (Su11& g : mirrored) g = {std::conj(g.a), std::conj(g.b)};
  expectEqualLengths(spectrumOf(polygonOf(mirrored, 3), 5.5),
                     spectrumOf(polygonOf(sampleGroup("klein"), 3), 5.5), 1e-9);
}

/// What conjugation and inversion leave: the length, and the homology class up to sign.
using Class = std::pair<long, std::vector<int>>;

Class classOf(double length, const Word& word, std::size_t generators) {
  std::vector<int> homology(generators, 0);
  for (const int letter : word) homology[std::abs(letter) - 1] += letter > 0 ? 1 : -1;
  std::vector<int> opposite = homology;
  for (int& x : opposite) x = -x;
  return {std::lround(length * 1e6), std::max(homology, opposite)};
}

TEST(LengthSpectrum, HasTheClassesThatAllWordsHave) {
  // Brute force: every word of up to 7 letters. The generators of the regular polygons are a basis
  // of homology, so that classes of different homology are different; powers are told by a word
  // that repeats.
  const std::vector<Su11> generators = regularPolygonGroup(2);
  constexpr double kLength = 5;
  std::set<Class> found, expected;
  for (const ClosedGeodesic& geodesic : spectrumOf(polygonOf(generators, 2), kLength).geodesics)
    found.insert(classOf(geodesic.length, geodesic.word, 4));
  std::vector<std::pair<Su11, Word>> words{{Su11{}, {}}};
  for (std::size_t first = 0; first < words.size(); ++first) {
    const auto [element, word] = words[first];
    const double length = translationLength(element);
    bool power = false;
    for (std::size_t period = 1; 2 * period <= word.size(); ++period)
      power =
          power || (word.size() % period == 0 &&
                    std::equal(word.begin() + static_cast<long>(period), word.end(), word.begin()));
    if (!power && !word.empty() && word.front() != -word.back() && length < kLength &&
        length > 1e-6)
      expected.insert(classOf(length, word, 4));
    if (word.size() == 7) continue;
    for (int letter = -4; letter <= 4; ++letter) {
      if (letter == 0 || (!word.empty() && word.back() == -letter)) continue;
      const Su11& g = generators[std::abs(letter) - 1];
      Word longer = word;
      longer.push_back(letter);
      words.emplace_back(renormalized(element * (letter > 0 ? g : inverse(g))), longer);
    }
  }
  EXPECT_GT(found.size(), 15);
  EXPECT_EQ(found, expected);
}

TEST(LengthSpectrum, WordsGiveTheElements) {
  const std::vector<Su11> generators = sampleGroup("klein", 5);
  const OrbitPolygon polygon = polygonOf(generators, 3);
  for (const ClosedGeodesic& geodesic : spectrumOf(polygon, 5.5).geodesics) {
    const Su11 product = elementOfWord(generators, geodesic.word);
    EXPECT_LT(distanceUpToSign(product, inGivenCoordinates(polygon, geodesic.element)), 1e-7);
    EXPECT_NEAR(translationLength(product), geodesic.length, 1e-8);
    EXPECT_NEAR(translationLength(geodesic.element), geodesic.length, 1e-12);
  }
}

TEST(LengthSpectrum, EntriesAreNotConjugateToOneAnother) {
  const OrbitPolygon polygon = polygonOf(regularPolygonGroup(2), 2);
  const LengthSpectrum spectrum = spectrumOf(polygon, 5.5);
  // No axis through the polygon lies over two of them.
  std::vector<std::pair<Axis, std::size_t>> axes;
  for (std::size_t i = 0; i < spectrum.geodesics.size(); ++i)
    for (const Su11& g : conjugatesAcross(polygon, spectrum.geodesics[i].element, 0.01))
      axes.emplace_back(axisOf(g), i);
  for (const auto& [axis, i] : axes)
    for (const auto& [other, k] : axes)
      EXPECT_TRUE(i >= k || std::abs(std::abs(product(axis, other)) - 1) > 1e-9) << i << " " << k;
}

TEST(LengthSpectrum, TracesOfProductsAddUp) {
  // tr(A B) + tr(A B^-1) = tr A tr B, relative to the size of the entries.
  const LengthSpectrum spectrum = spectrumOf(polygonOf(sampleGroup("bolza"), 2), 5);
  for (const ClosedGeodesic& x : spectrum.geodesics)
    for (const ClosedGeodesic& y : spectrum.geodesics) {
      const Su11& a = x.element;
      const Su11& b = y.element;
      EXPECT_NEAR(trace(a * b) + trace(a * inverse(b)), trace(a) * trace(b),
                  1e-12 * std::abs(a.a * b.a));
    }
}

TEST(LengthSpectrum, SaysWhatIsCompleteWithinABudget) {
  const OrbitPolygon polygon = polygonOf(sampleGroup("bolza"), 2);
  Context context;
  const auto part = lengthSpectrum(context, polygon, 6.2, {.most_elements = 600});
  ASSERT_OK(part);
  EXPECT_LT(part->complete_to, 6.2);
  EXPECT_GT(part->complete_to, 4.9);
  std::size_t within = 0;
  for (const ClosedGeodesic& geodesic : spectrumOf(polygon, 6.2).geodesics)
    within += geodesic.length <= part->complete_to ? 1 : 0;
  EXPECT_EQ(part->geodesics.size(), within);
  EXPECT_THAT(systoles(context, polygon, {.most_elements = 5}), FailsWith(Reason::kNoConvergence));
}

TEST(LengthSpectrum, NeedsAPositiveLength) {
  const OrbitPolygon polygon = polygonOf(sampleGroup("bolza"), 2);
  Context context;
  EXPECT_THAT(lengthSpectrum(context, polygon, 0), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(lengthSpectrum(context, polygon, std::nan("")), FailsWith(Reason::kInvalidOption));
}

TEST(LengthSpectrum, EndsWhenCancelled) {
  const OrbitPolygon polygon = polygonOf(sampleGroup("bolza"), 2);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(lengthSpectrum(context, polygon, 5), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
