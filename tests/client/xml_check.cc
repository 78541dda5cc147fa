#include "tests/client/xml_check.h"

#include <cctype>
#include <set>
#include <vector>

namespace moduli {
namespace {

class Checker {
 public:
  explicit Checker(std::string_view text) : text_(text) {}

  std::string fault() {
    if (text_.starts_with("<?xml ")) at_ = text_.find("?>") + 2;
    bool any = false;
    while (true) {
      skipText();
      if (!fault_.empty() || at_ >= text_.size()) break;
      if (any && open_.empty()) return "something behind the root element" + place();
      any = true;
      element();
    }
    if (fault_.empty() && !any) return "no element";
    if (fault_.empty() && !open_.empty()) return "<" + open_.back() + "> is never closed";
    return fault_;
  }

 private:
  std::string place() const { return " at byte " + std::to_string(at_); }
  void fail(const std::string& what) {
    if (fault_.empty()) fault_ = what + place();
    at_ = text_.size();
  }
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skipBlanks() {
    while (std::isspace(static_cast<unsigned char>(peek()))) ++at_;
  }

  // Up to one of the ends, which are not part of it.
  void characters(std::string_view ends, bool blanks_only) {
    while (at_ < text_.size() && ends.find(peek()) == std::string_view::npos) {
      const char c = peek();
      const bool blank = std::isspace(static_cast<unsigned char>(c));
      if (blanks_only && !blank) return fail("text outside the root element");
      if (static_cast<unsigned char>(c) < 32 && !blank) return fail("a control character");
      if (c == '<' || (c == '&' && !entity())) return fail("an unescaped character");
      ++at_;
    }
  }
  bool entity() const {
    for (const char* name : {"&lt;", "&gt;", "&amp;", "&quot;", "&apos;"}) {
      if (text_.substr(at_).starts_with(name)) return true;
    }
    return false;
  }
  void skipText() { characters("<", open_.empty()); }

  std::string name() {
    const std::size_t start = at_;
    while (std::isalnum(static_cast<unsigned char>(peek())) || peek() == '-' || peek() == ':')
      ++at_;
    if (at_ == start) fail("no name");
    return std::string(text_.substr(start, at_ - start));
  }

  void element() {
    ++at_;
    if (peek() == '/') {
      ++at_;
      const std::string closed = name();
      if (open_.empty() || open_.back() != closed) return fail("</" + closed + "> closes nothing");
      open_.pop_back();
    } else {
      open_.push_back(name());
      attributes();
      if (peek() == '/') {
        ++at_;
        open_.pop_back();
      }
    }
    skipBlanks();
    if (peek() != '>') return fail("no end of a tag");
    ++at_;
  }

  void attributes() {
    std::set<std::string> seen;
    while (true) {
      const std::size_t before = at_;
      skipBlanks();
      if (at_ >= text_.size() || peek() == '>' || peek() == '/') return;
      if (at_ == before) return fail("no blank before an attribute");
      if (!seen.insert(name()).second) return fail("an attribute twice");
      if (text_.substr(at_, 2) != "=\"") return fail("no quoted value");
      at_ += 2;
      characters("\"", false);
      if (peek() != '"') return fail("a value without an end");
      ++at_;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<std::string> open_;
  std::string fault_;
};

}  // namespace

std::string xmlFault(std::string_view text) {
  return Checker(text).fault();
}

}  // namespace moduli
