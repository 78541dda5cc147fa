#include "core/mesh/obj_statements.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <utility>

#include "core/mesh/scanner.h"

namespace moduli {
namespace {

bool takesName(std::string_view keyword) {
  return keyword == "o" || keyword == "g" || keyword == "usemtl" || keyword == "mtllib";
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && isSpace(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view firstWord(std::string_view text) {
  return text.substr(
      0, static_cast<std::size_t>(std::find_if(text.begin(), text.end(), isSpace) - text.begin()));
}

/// Corners of a polygon: a row of texture points and of normals each.
struct Corner {
  Index texture = kNone, normal = kNone;
};

class StatementReader {
 public:
  explicit StatementReader(std::string_view bytes) : rest_(bytes) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  ObjStatements read() && {
    while (!rest_.empty()) take(nextStatement());
    resolve();
    return std::move(result_);
  }

 private:
  std::string_view nextLine() {
    const auto end = static_cast<std::size_t>(std::find_if(rest_.begin(), rest_.end(), isLineEnd) -
                                              rest_.begin());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(
        std::min(rest_.size(), rest_.substr(end).starts_with("\r\n") ? end + 2 : end + 1));
    return line;
  }

  // A line with those that a backslash joins to it; a view that is good until the next call.
  std::string_view nextStatement() {
    const std::string_view line = nextLine();
    const bool joins = line.ends_with('\\') && line.find('#') == std::string_view::npos &&
                       !takesName(firstWord(trimmed(line)));
    if (!joins) return trimmed(line);
    joined_ = line;
    while (joined_.ends_with('\\') && !rest_.empty()) {
      joined_.back() = ' ';
      joined_ += nextLine();
    }
    return trimmed(joined_);
  }

  void take(std::string_view statement) {
    const std::string_view keyword = firstWord(statement);
    if (takesName(keyword) || keyword == "s" || keyword == "mg") {
      result_.statements.push_back(
          {static_cast<Index>(result_.texture.size()), std::string(statement)});
      return;
    }
    const std::string_view said = statement.substr(0, statement.find('#'));
    const std::string_view numbers = trimmed(said.substr(std::min(said.size(), keyword.size())));
    if (keyword == "vt") result_.texture_points.emplace_back(numbers);
    if (keyword == "vn") result_.normals.emplace_back(numbers);
    if (keyword == "f" || keyword == "fo") face(numbers);
  }

  // The row that an index of a corner names, to be judged when all rows are there.
  static Index row(std::string_view text, std::size_t defined) {
    std::int64_t index = 0;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return kNone;
    const std::int64_t at = index > 0 ? index - 1 : static_cast<std::int64_t>(defined) + index;
    return index == 0 || at < 0 || at > INT32_MAX ? kNone : static_cast<Index>(at);
  }

  Corner corner(std::string_view word) const {
    Corner corner;
    const std::size_t first = word.find('/');
    if (first == std::string_view::npos) return corner;
    const std::size_t second = std::min(word.find('/', first + 1), word.size());
    corner.texture = row(word.substr(first + 1, second - first - 1), result_.texture_points.size());
    if (second < word.size()) corner.normal = row(word.substr(second + 1), result_.normals.size());
    return corner;
  }

  void face(std::string_view words) {
    polygon_.clear();
    for (; !words.empty(); words = trimmed(words)) {
      const std::string_view word = firstWord(words);
      polygon_.push_back(corner(word));
      words.remove_prefix(word.size());
    }
    for (std::size_t k = 2; k < polygon_.size(); ++k) {
      const Corner &a = polygon_[0], &b = polygon_[k - 1], &c = polygon_[k];
      result_.texture.push_back({a.texture, b.texture, c.texture});
      result_.normal.push_back({a.normal, b.normal, c.normal});
    }
  }

  void resolve() {
    const auto judge = [](std::vector<Triangle>& triangles, std::size_t count) {
      for (Triangle& triangle : triangles) {
        const bool whole = std::all_of(triangle.begin(), triangle.end(), [count](Index i) {
          return i != kNone && static_cast<std::size_t>(i) < count;
        });
        if (!whole) triangle = {kNone, kNone, kNone};
      }
    };
    judge(result_.texture, result_.texture_points.size());
    judge(result_.normal, result_.normals.size());
  }

  std::string_view rest_;
  std::string joined_;
  std::vector<Corner> polygon_;
  ObjStatements result_;
};

}  // namespace

ObjStatements readObjStatements(std::string_view bytes) {
  return StatementReader(bytes).read();
}

}  // namespace moduli
