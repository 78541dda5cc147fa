#include "server/store/pagination.h"

#include <algorithm>
#include <optional>

#include "core/base/digest.h"

namespace moduli {
namespace {

// A token is hexadecimal text: format version, fingerprint of the query, then what came last.
constexpr char kVersion = '1';
constexpr std::size_t kFingerprint = 16;

std::string fingerprint(std::string_view query) {
  return sha256Hex(query).substr(0, kFingerprint);
}

std::string toHex(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

int digitValue(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

std::optional<std::string> fromHex(std::string_view text) {
  if (text.size() % 2 != 0) return std::nullopt;
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const int high = digitValue(text[i]);
    const int low = digitValue(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes += static_cast<char>(high * 16 + low);
  }
  return bytes;
}

}  // namespace

Result<std::size_t> effectivePageSize(const PageRequest& page) {
  if (page.size < 0) return Status(Reason::kInvalidRequest, "page_size is negative");
  if (page.size == 0) return static_cast<std::size_t>(kDefaultPageSize);
  return static_cast<std::size_t>(std::min(page.size, kMaxPageSize));
}

std::string makePageToken(std::string_view query, std::string_view last) {
  std::string token(1, kVersion);
  token += fingerprint(query);
  token += toHex(last);
  return token;
}

Result<std::string> readPageToken(std::string_view query, std::string_view token) {
  if (token.empty()) return std::string();
  const Status not_ours(Reason::kInvalidPageToken, "this page token belongs to no such list",
                        "pass next_page_token unchanged, with the same parent and filter");
  if (!token.starts_with(kVersion) || token.size() < 1 + kFingerprint) return not_ours;
  token.remove_prefix(1);
  if (token.substr(0, kFingerprint) != fingerprint(query)) return not_ours;
  const std::optional<std::string> last = fromHex(token.substr(kFingerprint));
  if (!last || last->empty()) return not_ours;
  return *last;
}

}  // namespace moduli
