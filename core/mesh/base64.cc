#include "core/mesh/base64.h"

#include <array>
#include <cstdint>

#include "core/mesh/scanner.h"

namespace moduli {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNoDigit = 0xFF;

constexpr std::array<std::uint8_t, 256> digitValues() {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNoDigit);
  for (std::size_t i = 0; i < kDigits.size(); ++i) {
    values[static_cast<unsigned char>(kDigits[i])] = static_cast<std::uint8_t>(i);
  }
  return values;
}
constexpr std::array<std::uint8_t, 256> kValues = digitValues();

constexpr std::string_view kHint = "the file is damaged; export it again";

// What may stand from the first '=' on: as many as the last group lacks.
Status checkPadding(std::string_view rest, std::size_t digits) {
  std::size_t signs = 0;
  for (const char c : rest) {
    if (isSpace(c)) continue;
    if (c != '=') {
      return {Reason::kSyntaxError, quoted({&c, 1}) + " stands behind the padding of base64 text",
              std::string(kHint)};
    }
    ++signs;
  }
  if ((digits + signs) % 4 == 0 && signs < 3) return {};
  if (signs < 3 && signs + digits % 4 < 4) {
    return {Reason::kTruncatedFile, "base64 text ends within a group of four characters",
            "the file was cut off; copy or export it again"};
  }
  return {Reason::kSyntaxError, "base64 text has wrong padding", std::string(kHint)};
}

}  // namespace

std::string encodeBase64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

Result<std::string> decodeBase64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t group = 0;
  std::size_t digits = 0;
  std::size_t at = 0;
  for (; at < text.size() && text[at] != '='; ++at) {
    const std::uint8_t value = kValues[static_cast<unsigned char>(text[at])];
    if (value == kNoDigit) {
      if (isSpace(text[at])) continue;
      return Status(Reason::kSyntaxError,
                    quoted(text.substr(at, 1)) + " stands where base64 text should be",
                    std::string(kHint));
    }
    group = group << 6 | value;
    // The first digit of a group of four gives no whole byte, each of the others one.
    if (const std::size_t k = digits++ % 4; k > 0) {
      bytes += static_cast<char>(group >> (6 - 2 * k) & 0xFFU);
    }
  }
  RETURN_IF_ERROR(checkPadding(text.substr(at), digits));
  return bytes;
}

}  // namespace moduli
