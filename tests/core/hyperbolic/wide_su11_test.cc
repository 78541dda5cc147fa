#include "core/hyperbolic/wide_su11.h"

#include <cmath>
#include <random>

#include "core/hyperbolic/fuchsian_group.h"
#include "tests/core/hyperbolic/groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

std::vector<Su11> disturbed(std::vector<Su11> group, double size, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> angle(-3, 3);
  for (Su11& g : group) {
    const double direction = angle(engine);
    g = g * rotation(direction) * translation(size) * rotation(-direction);
  }
  return group;
}

TEST(WideSu11, AgreesWithDoublesAndBeyond) {
  const std::vector<Su11> group = polygonGroup(2);
  std::vector<WideSu11> letters;
  for (const Su11& g : group) letters.push_back(widened(g));
  const Word word = {1, 2, -3, 4, 4, -1};
  const Su11 wide = rounded(evaluate(letters, word));
  const Su11 narrow = evaluateWord(group, word);
  EXPECT_LE(distanceUpToSign(wide, narrow), 1e-13 * std::abs(wide.a));
  // Times its inverse it is 1 to 113 bits less those of |a|^2.
  Word there_and_back = word;
  const Word back = inverseWord(word);
  there_and_back.insert(there_and_back.end(), back.begin(), back.end());
  EXPECT_LE(relationResidual(letters, there_and_back), 1e-30 * std::norm(wide.a));
}

TEST(CorrectRelation, MovesNoFurtherThanTheDisturbance) {
  for (const int genus : {2, 3, 5}) {
    const std::size_t letters = 2 * static_cast<std::size_t>(genus);
    const Word relation = canonicalRelation(letters / 2);
    for (const double size : {1e-12, 1e-9}) {
      const auto corrected = correctRelation(disturbed(polygonGroup(genus), size, 1), relation);
      ASSERT_OK(corrected);
      EXPECT_GT(corrected->residual_before, size);
      EXPECT_LE(corrected->residual, 1e-25);
      // Undoing all disturbances is a solution; the smallest one is no longer as a vector. The
      // group itself is rounded, by some 1e-16 times |a|^2.
      const double rounding = 1e-15 * std::exp(2 * polygonRadius(genus));
      EXPECT_LE(corrected->moved,
                std::sqrt(static_cast<double>(letters)) * size * (1 + 1e-3) + rounding);
      EXPECT_GT(corrected->moved, 0);
    }
  }
}

TEST(CorrectRelation, LeavesAGroupAlone) {
  const auto once = correctRelation(polygonGroup(3), canonicalRelation(3));
  ASSERT_OK(once);
  std::vector<Su11> letters;
  for (const WideSu11& g : once->letters) letters.push_back(rounded(g));
  const auto again = correctRelation(letters, canonicalRelation(3));
  ASSERT_OK(again);
  EXPECT_LE(again->moved, 1e-14);
}

TEST(CorrectRelation, RefusesWhatIsNoGroup) {
  const Word relation = canonicalRelation(2);
  EXPECT_THAT(correctRelation(disturbed(polygonGroup(2), 0.5, 2), relation),
              FailsWith(Reason::kResidualTooLarge));
  EXPECT_THAT(correctRelation(disturbed(polygonGroup(2), 1e-5, 2), relation),
              FailsWith(Reason::kNoConvergence));
}

}  // namespace
}  // namespace moduli
