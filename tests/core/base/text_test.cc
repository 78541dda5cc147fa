#include "core/base/text.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "core/base/digest.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(Text, ShortestDoubleReadsBackToTheLastBit) {
  std::mt19937_64 bits(7);
  for (int i = 0; i < 100000; ++i) {
    const double value = std::bit_cast<double>(bits());
    if (!std::isfinite(value)) continue;
    const auto back = parseDouble(shortestDouble(value));
    ASSERT_TRUE(back);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(*back), std::bit_cast<std::uint64_t>(value));
  }
  EXPECT_EQ(shortestDouble(0.1), "0.1");
}

TEST(Text, NumbersMustFillTheWholeText) {
  EXPECT_EQ(parseInteger("-12"), -12);
  EXPECT_EQ(parseInteger("+12"), 12);
  for (const char* bad : {"", " 1", "1 ", "1x", "0x10", "+-1", "1e3", "99999999999999999999"}) {
    EXPECT_FALSE(parseInteger(bad)) << bad;
  }
  EXPECT_EQ(parseDouble("+1.5e-3"), 1.5e-3);
  for (const char* bad : {"", "1,5", "1.5 ", "--1", "1e"}) EXPECT_FALSE(parseDouble(bad)) << bad;
}

TEST(Text, ListSomeCountsWhatItLeavesOut) {
  EXPECT_EQ(listSome({3, 5}, 2), "3, 5");
  EXPECT_EQ(listSome({1, 2, 3, 4, 5, 6}, 9, 3), "1, 2, 3 and 6 more");
  EXPECT_EQ(listSome({}, 0), "");
}

TEST(Text, PrintableUtf8RefusesControlsAndBrokenSequences) {
  EXPECT_TRUE(isPrintableUtf8("cup 7 – Tasse Ä 茶 🍵"));
  for (const char* bad : {"a\nb", "\x1b[31m", "\x7f", "\xc3", "\xc0\xaf", "\xed\xa0\x80",
                          "\xf4\x90\x80\x80", "\xc2\x85", "\xff"}) {
    EXPECT_FALSE(isPrintableUtf8(bad));
  }
}

TEST(Text, ForXmlHasNoTagsAndNoCarriageReturns) {
  EXPECT_EQ(xmlText("a < b && b > \"c\"\r\n"), "a &lt; b &amp;&amp; b &gt; \"c\"&#13;\n");
  EXPECT_EQ(xmlText(""), "");
}

TEST(Digest, Sha256OfKnownTexts) {
  EXPECT_EQ(sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  Sha256 pieces;
  pieces.update("a");
  pieces.update("bc");
  EXPECT_EQ(pieces.finish(), sha256Hex("abc"));
}

}  // namespace
}  // namespace moduli
