#include "core/mesh/deflate.h"

#include "core/mesh/base64.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

Result<std::string> inflated(const std::string& bytes, std::size_t most = 1 << 30) {
  Context context;
  InflateAllowance allowance{std::size_t{1} << 26};
  return inflateBytes(context, bytes, most, allowance);
}

std::string unevenText(std::size_t size) {
  std::string text;
  std::uint32_t state = 1;
  while (text.size() < size) {
    state = state * 1664525U + 1013904223U;
    text += static_cast<char>(state >> 29U);
  }
  return text;
}

TEST(Deflate, BytesComeBack) {
  for (const std::size_t size : {0U, 1U, 1000U, 262144U, 262145U, 3000000U}) {
    const std::string bytes = unevenText(size);
    for (const std::string& packed : {deflateBytes(bytes), gzipBytes(bytes)}) {
      const auto back = inflated(packed);
      ASSERT_OK(back);
      EXPECT_TRUE(*back == bytes);
      EXPECT_TRUE(inflated(packed, size).ok());
    }
    EXPECT_TRUE(isGzip(gzipBytes(bytes)));
    EXPECT_FALSE(isGzip(deflateBytes(bytes)));
    EXPECT_EQ(inflateBeginning(gzipBytes(bytes), 10), bytes.substr(0, 10));
  }
}

TEST(Deflate, MoreThanIsWantedIsAnError) {
  const std::string packed = deflateBytes(unevenText(1000));
  EXPECT_THAT(inflated(packed, 999), FailsWith(Reason::kCountTooLarge));
  EXPECT_THAT(inflated(packed, 0), FailsWith(Reason::kCountTooLarge));
  EXPECT_OK(inflated(packed, 1000));
}

TEST(Deflate, TheAllowanceIsSharedByAllPartsOfAFile) {
  Context context;
  InflateAllowance allowance{1500};
  const std::string packed = deflateBytes(unevenText(1000));
  EXPECT_OK(inflateBytes(context, packed, 5000, allowance));
  EXPECT_EQ(allowance.left, 500U);
  EXPECT_THAT(inflateBytes(context, packed, 5000, allowance), FailsWith(Reason::kCountTooLarge));
}

TEST(Deflate, AFileCutAnywhereIsAnError) {
  for (const std::string& packed : {deflateBytes(unevenText(50)), gzipBytes(unevenText(50))}) {
    for (std::size_t size = 0; size < packed.size(); ++size) {
      EXPECT_FALSE(inflated(packed.substr(0, size)).ok()) << size;
    }
  }
}

TEST(Deflate, ChangedBytesAreSeen) {
  const std::string bytes = unevenText(200);
  const std::string packed = deflateBytes(bytes);
  for (std::size_t i = 0; i < packed.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string bad = packed;
      bad[i] = static_cast<char>(bad[i] ^ (1 << bit));
      const auto back = inflated(bad);
      // The check sum sees what the stream itself does not; the level in the second byte of the
      // header alone means nothing.
      EXPECT_TRUE(!back.ok() || *back == bytes) << i;
    }
  }
}

TEST(Base64, TheExamplesOfItsStandard) {
  const std::pair<std::string, std::string> examples[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : examples) {
    EXPECT_EQ(encodeBase64(bytes), text);
    const auto back = decodeBase64(text);
    ASSERT_OK(back);
    EXPECT_EQ(*back, bytes);
  }
}

TEST(Base64, EveryByteComesBack) {
  std::string bytes;
  for (int i = 0; i < 256 * 3; ++i) bytes += static_cast<char>(i * 7);
  EXPECT_EQ(*decodeBase64(encodeBase64(bytes)), bytes);
}

TEST(Base64, WrongPaddingAndOtherCharactersAreErrors) {
  for (const std::string cut : {"Z", "Zg", "Zg=", "Zm9"}) {
    EXPECT_THAT(decodeBase64(cut), FailsWith(Reason::kTruncatedFile)) << cut;
  }
  for (const std::string bad : {"Zg==Zg==", "Zg===", "Zm9v====", "Zm9_", "Zm9\x80", "Zm=v"}) {
    EXPECT_THAT(decodeBase64(bad), FailsWith(Reason::kSyntaxError)) << bad;
  }
  EXPECT_EQ(*decodeBase64(" Z\nm\t9\r\nv Zg = =\n"), "foof");
}

}  // namespace
}  // namespace moduli
