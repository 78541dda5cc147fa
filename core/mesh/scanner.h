#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/status.h"

/// The cursor under all readers of mesh files. Text readers ask for numbers and words, binary
/// readers for raw bytes; every failure is a Status that names the file and the place. A line
/// number is counted only when an error needs it, so reading pays nothing for it.
namespace moduli {

inline bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
inline bool isLineEnd(char c) {
  return c == '\n' || c == '\r';
}
inline bool isSpace(char c) {
  return isBlank(c) || isLineEnd(c);
}

class Scanner {
 public:
  /// Keeps views of both arguments; they must outlive the scanner.
  Scanner(std::string_view name, std::string_view bytes)
      : name_(name), begin_(bytes.data()), at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  std::string_view name() const { return name_; }
  const char* at() const { return at_; }
  const char* end() const { return end_; }
  bool atEnd() const { return at_ == end_; }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  char peek() const { return *at_; }
  void advance(std::size_t count) { at_ += count; }
  void moveTo(const char* place) { at_ = place; }

  /// Steps over a UTF-8 byte order mark at the beginning.
  void skipByteOrderMark();

  void skipBlanks() {
    while (at_ != end_ && isBlank(*at_)) ++at_;
  }
  void skipSpace() {
    while (at_ != end_ && isSpace(*at_)) ++at_;
  }
  /// Blanks, line ends and comments from '#' to the end of the line.
  void skipSpaceAndComments() {
    for (skipSpace(); at_ != end_ && *at_ == '#'; skipSpace()) skipToLineEnd();
  }
  /// To the line end (not over it) or the end of the file.
  void skipToLineEnd() {
    while (at_ != end_ && !isLineEnd(*at_)) ++at_;
  }
  /// Over one line end: "\n", "\r\n" or a lone "\r".
  void skipLineEnd() {
    if (at_ != end_ && *at_ == '\r') ++at_;
    if (at_ != end_ && *at_ == '\n') ++at_;
  }

  /// The characters up to the next space; empty at a space or at the end.
  std::string_view word() {
    const char* start = at_;
    while (at_ != end_ && !isSpace(*at_)) ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }

  /// Reads a decimal number, correctly rounded, up to a space, '#', '\\' or the end. "nan" and
  /// "inf" are numbers; a finite text beyond the range of double is not, one below it becomes zero.
  /// On failure returns false and stays where it was.
  bool number(double& value) {
    const char* start = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
    if (start != at_ && start != end_ && (*start == '-' || *start == '+')) return false;
    const auto [stop, problem] = std::from_chars(start, end_, value);
    if (stop == start || !endsToken(stop)) return false;
    if (problem != std::errc()) {
      if (!underflows(start, stop)) return false;
      value = *start == '-' ? -0.0 : 0.0;
    }
    at_ = stop;
    return true;
  }

  /// Reads a decimal integer in the same way; false also if it exceeds 64 bits.
  bool integer(std::int64_t& value) {
    const char* stop = integerPrefix(value);
    if (stop == nullptr || !endsToken(stop)) return false;
    at_ = stop;
    return true;
  }

  /// Where a decimal integer that begins at the cursor ends; nullptr if none does.
  const char* integerPrefix(std::int64_t& value) const {
    const char* start = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
    if (start != at_ && start != end_ && *start == '-') return nullptr;
    const auto [stop, problem] = std::from_chars(start, end_, value);
    return problem == std::errc() ? stop : nullptr;
  }

  /// Steps over a word that can pass for a number whose value nobody needs (a colour, a normal),
  /// however a program spelled "not a number". False, without moving, if it cannot.
  bool skipNumber();

  /// A failure at a place of a text file: "name:LINE: message".
  Status textError(Reason reason, const char* place, std::string_view message,
                   std::string_view hint = {}) const;
  /// A failure at a place of a binary file: "name: byte N: message".
  Status byteError(Reason reason, const char* place, std::string_view message,
                   std::string_view hint = {}) const;
  /// What stands at the cursor, quoted for a message; "the end of the file" or "the end of the
  /// line".
  std::string found() const;

  /// Why `count` items of at least `bytes_each` cannot follow: the reason for the error, or kOk if
  /// they can. A file that misses up to fifteen sixteenths passes for truncated; beyond that it is
  /// the count which is wrong.
  Reason roomFor(std::uint64_t count, std::uint64_t bytes_each) const;

 private:
  bool endsToken(const char* place) const {
    return place == end_ || isSpace(*place) || *place == '#' || *place == '\\';
  }
  static bool underflows(const char* start, const char* stop);

  std::string_view name_;
  const char* begin_;
  const char* at_;
  const char* end_;
};

/// True if the first kilobyte has no control characters but spaces.
bool looksLikeText(std::string_view bytes);

/// Text for a message: quoted, without control characters, at most 40 characters.
std::string quoted(std::string_view text);

}  // namespace moduli
