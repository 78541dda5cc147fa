#pragma once

#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "tests/core/testing.h"

/// The list of the real meshes with what is known of each.
namespace moduli::manifest {

/// One file: column name to text, empty where unknown.
class Row {
 public:
  explicit Row(std::map<std::string, std::string> cells) : cells_(std::move(cells)) {}

  const std::string& text(const std::string& column) const { return cells_.at(column); }
  std::optional<long long> number(const std::string& column) const {
    return parseInteger(text(column));
  }
  bool isTrue(const std::string& column) const { return text(column) == "True"; }

  /// A number of the JSON object that describes the mesh after welding.
  std::optional<long long> welded(const std::string& key) const {
    const std::string mark = "\"" + key + "\": ";
    const std::size_t at = text("welded").find(mark);
    if (at == std::string::npos) return std::nullopt;
    const std::size_t begin = at + mark.size();
    return parseInteger(
        text("welded").substr(begin, text("welded").find_first_of(",}", begin) - begin));
  }

 private:
  std::map<std::string, std::string> cells_;
};

/// Cells of CSV text, line by line; a cell in quotes may hold commas and doubled quotes.
inline std::vector<std::vector<std::string>> parseCsv(const std::string& text) {
  std::vector<std::vector<std::string>> lines(1, {""});
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"') {
      lines.back().back() += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      lines.back().emplace_back();
    } else if (c == '\n' && !quoted) {
      lines.push_back({""});
    } else if (c != '\r') {
      lines.back().back() += c;
    }
  }
  return lines;
}

inline std::vector<Row> read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto lines = parseCsv(text);
  std::vector<Row> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].size() != lines[0].size()) continue;
    std::map<std::string, std::string> cells;
    for (std::size_t c = 0; c < lines[0].size(); ++c) cells[lines[0][c]] = lines[i][c];
    rows.emplace_back(std::move(cells));
  }
  return rows;
}

}  // namespace moduli::manifest
