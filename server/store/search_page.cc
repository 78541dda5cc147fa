#include "server/store/search_page.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "core/base/digest.h"
#include "server/store/pagination.h"
#include "server/store/shape_record.h"

namespace moduli {
namespace {

// What stands before the name: fingerprint of the state, bits of the distance, number of hits.
constexpr std::size_t kState = 16, kDistance = 16, kCount = 8;
constexpr std::size_t kBeforeName = kState + kDistance + kCount;

std::string stateOf(std::string_view state) {
  return sha256Hex(state).substr(0, kState);
}

std::optional<std::uint64_t> fromHex(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string listOf(std::string_view request) {
  return "search/" + std::string(request);
}

// The part of the token behind the request's fingerprint, split.
struct Content {
  std::string state;
  SearchPosition position;
};

std::optional<Content> split(const std::string& text) {
  if (text.size() <= kBeforeName) return std::nullopt;
  const std::string_view all(text);
  const auto bits = fromHex(all.substr(kState, kDistance));
  const auto count = fromHex(all.substr(kState + kDistance, kCount));
  if (!bits || !count || *count == 0) return std::nullopt;
  Content content{text.substr(0, kState),
                  {std::bit_cast<double>(*bits), text.substr(kBeforeName), *count}};
  const SearchPosition& position = content.position;
  if (!(position.distance >= 0) || !std::isfinite(position.distance)) return std::nullopt;
  if (!validateShapeName(position.name).ok()) return std::nullopt;
  return content;
}

Result<Content> read(std::string_view request, std::string_view token) {
  const Status not_ours(Reason::kInvalidPageToken, "this page token belongs to another search",
                        "pass next_page_token unchanged, with all other fields as they were");
  const Result<std::string> text = readPageToken(listOf(request), token);
  if (!text.ok()) return not_ours;
  std::optional<Content> content = split(*text);
  if (!content) return not_ours;
  return *std::move(content);
}

}  // namespace

std::string makeSearchToken(std::string_view request, std::string_view state,
                            const SearchPosition& position) {
  char numbers[kDistance + kCount + 1];
  std::snprintf(numbers, sizeof numbers, "%016llx%08llx",
                static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(position.distance)),
                static_cast<unsigned long long>(position.count));
  return makePageToken(listOf(request), stateOf(state) + numbers + position.name);
}

Status checkSearchToken(std::string_view request, std::string_view token) {
  return token.empty() ? Status() : read(request, token).status();
}

Result<SearchPosition> readSearchToken(std::string_view request, std::string_view state,
                                       std::string_view token) {
  ASSIGN_OR_RETURN(Content content, read(request, token));
  if (content.state != stateOf(state)) {
    return Status(Reason::kInvalidPageToken,
                  "the collection or the shape searched for is another one since this page token "
                  "was given",
                  "search again from the first page");
  }
  return std::move(content.position);
}

}  // namespace moduli
