#include "client/cli/side_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "client/cpp/mesh_bytes.h"
#include "core/base/text.h"

namespace moduli::cli {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBetweenWords = " \t\r\v\f,";
constexpr const char* kConeHint = "write 'vertex curvature' on each line, in radians";

std::vector<std::string> wordsOf(std::string_view line) {
  line = line.substr(0, line.find('#'));
  std::vector<std::string> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(kBetweenWords);
    if (begin == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(kBetweenWords, begin), line.size());
    words.emplace_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

std::string quoted(const std::string& word) {
  constexpr std::size_t kShown = 40;
  return "'" + (word.size() <= kShown ? word : word.substr(0, kShown) + "...") + "'";
}

Result<int> vertexOf(const std::string& word, const std::string& place, const char* hint) {
  const auto vertex = parseInteger(word);
  if (!vertex) {
    return Status(Reason::kSyntaxError, place + ": " + quoted(word) + " is not a vertex's number",
                  hint);
  }
  if (*vertex < 0 || *vertex > std::numeric_limits<int>::max()) {
    return Status(Reason::kIndexOutOfRange, place + ": there is no vertex " + quoted(word), hint);
  }
  return static_cast<int>(*vertex);
}

Result<ConeLine> coneOf(const SideLine& line, const std::string& place) {
  const auto wrong = [&](Reason reason, const std::string& what) {
    return Status(reason, place + ": " + what, kConeHint);
  };
  if (line.words.size() != 2) {
    return wrong(Reason::kSyntaxError, "has " + std::to_string(line.words.size()) +
                                           (line.words.size() == 1 ? " word" : " words") +
                                           " instead of a vertex and a curvature");
  }
  ASSIGN_OR_RETURN(const int vertex, vertexOf(line.words[0], place, kConeHint));
  const auto curvature = parseDouble(line.words[1]);
  if (!curvature || !std::isfinite(*curvature)) {
    return wrong(Reason::kSyntaxError, quoted(line.words[1]) + " is not a curvature");
  }
  return ConeLine{vertex, *curvature, place};
}

}  // namespace

Result<std::vector<SideLine>> readSideFile(const std::string& path) {
  ASSIGN_OR_RETURN(const MeshBytes file, MeshBytes::ofFile(path));
  ASSIGN_OR_RETURN(const std::string bytes, file.read(0, file.size()));
  std::string_view text = bytes;
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<SideLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::vector<std::string> words = wordsOf(text.substr(0, end));
    if (!words.empty()) lines.push_back({number, std::move(words)});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

Result<std::vector<ConeLine>> readCones(const std::string& path) {
  ASSIGN_OR_RETURN(const std::vector<SideLine> lines, readSideFile(path));
  std::vector<ConeLine> cones;
  for (const SideLine& line : lines) {
    ASSIGN_OR_RETURN(cones.emplace_back(), coneOf(line, path + ":" + std::to_string(line.number)));
  }
  return cones;
}

Result<std::vector<std::vector<int>>> readSeams(const std::string& path) {
  constexpr const char* kHint = "write the vertices along a seam on one line";
  ASSIGN_OR_RETURN(const std::vector<SideLine> lines, readSideFile(path));
  std::vector<std::vector<int>> seams;
  for (const SideLine& line : lines) {
    const std::string place = path + ":" + std::to_string(line.number);
    if (line.words.size() < 2) {
      return Status(Reason::kSyntaxError, place + ": a seam has two vertices at least", kHint);
    }
    std::vector<int>& seam = seams.emplace_back();
    for (const std::string& word : line.words) {
      ASSIGN_OR_RETURN(const int vertex, vertexOf(word, place, kHint));
      seam.push_back(vertex);
    }
  }
  return seams;
}

Status checkDistinct(const std::vector<ConeLine>& cones) {
  std::map<int, const ConeLine*> seen;
  for (const ConeLine& cone : cones) {
    const auto [first, is_new] = seen.emplace(cone.vertex, &cone);
    if (is_new) continue;
    return {Reason::kInvalidOption,
            cone.place + ": vertex " + std::to_string(cone.vertex) + " has a curvature in " +
                first->second->place + " already",
            "give each vertex one curvature"};
  }
  return {};
}

}  // namespace moduli::cli
