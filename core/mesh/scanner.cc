#include "core/mesh/scanner.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace moduli {

void Scanner::skipByteOrderMark() {
  if (at_ == begin_ && std::string_view(at_, left()).starts_with("\xEF\xBB\xBF")) at_ += 3;
}

bool Scanner::skipNumber() {
  constexpr std::string_view kFirst = "0123456789+-.nNiI";
  if (at_ == end_ || kFirst.find(*at_) == std::string_view::npos) return false;
  // One runtime library writes "1.#QNAN": that '#' begins no comment.
  while (!endsToken(at_) || (at_ != end_ && *at_ == '#' && at_[-1] == '.')) ++at_;
  return true;
}

// from_chars tells "out of range" for too large and too small alike. The decimal exponent of the
// first significant digit tells them apart.
bool Scanner::underflows(const char* start, const char* stop) {
  std::int64_t exponent = 0;
  bool significant = false;
  bool fraction = false;
  for (const char* c = start; c != stop; ++c) {
    if (*c == '-') continue;
    if (*c == '.') {
      fraction = true;
    } else if (*c == 'e' || *c == 'E') {
      const char* digits = c + 1 != stop && c[1] == '+' ? c + 2 : c + 1;
      std::int32_t written = 0;
      if (std::from_chars(digits, stop, written).ec != std::errc()) return *digits == '-';
      exponent += written;
      break;
    } else {
      significant = significant || *c != '0';
      if (significant && !fraction) ++exponent;
      if (!significant && fraction) --exponent;
    }
  }
  return exponent <= 0;
}

Status Scanner::textError(Reason reason, const char* place, std::string_view message,
                          std::string_view hint) const {
  std::size_t line = 1;
  for (const char* c = begin_; c != place; ++c) {
    const bool pair = *c == '\r' && c + 1 != end_ && c[1] == '\n';
    if (isLineEnd(*c) && !pair) ++line;
  }
  std::string text(name_);
  text.append(":").append(std::to_string(line)).append(": ").append(message);
  return {reason, std::move(text), std::string(hint)};
}

Status Scanner::byteError(Reason reason, const char* place, std::string_view message,
                          std::string_view hint) const {
  std::string text(name_);
  text.append(": byte ").append(std::to_string(place - begin_)).append(": ").append(message);
  return {reason, std::move(text), std::string(hint)};
}

std::string Scanner::found() const {
  if (at_ == end_) return "the end of the file";
  if (isLineEnd(*at_)) return "the end of the line";
  const char* stop = at_;
  while (stop != end_ && !isSpace(*stop)) ++stop;
  return quoted({at_, static_cast<std::size_t>(stop - at_)});
}

Reason Scanner::roomFor(std::uint64_t count, std::uint64_t bytes_each) const {
  if (bytes_each == 0 || count <= left() / bytes_each) return Reason::kOk;
  const bool plausible = count <= std::uint64_t{16} * size() / bytes_each;
  return plausible ? Reason::kTruncatedFile : Reason::kCountTooLarge;
}

bool looksLikeText(std::string_view bytes) {
  constexpr std::size_t kSample = 1024;
  return std::ranges::all_of(bytes.substr(0, kSample), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= 0x20 && byte != 0x7F) || isSpace(c);
  });
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte >= 0x20 && byte < 0x7F ? c : '?';
  }
  return result + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace moduli
