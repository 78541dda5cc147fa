#include "client/cli/textured_obj.h"

#include <array>
#include <charconv>
#include <string>

namespace moduli::cli {
namespace {

constexpr std::size_t kPiece = 1 << 20;

/// Text on its way to the sink.
class Lines {
 public:
  explicit Lines(const std::function<Status(std::string_view)>& sink) : sink_(sink) {}

  template <typename Number>
  void number(Number value) {
    std::array<char, 32> buffer;
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    text_.append(buffer.data(), end);
  }
  void word(std::string_view text) { text_ += text; }

  /// Ends a line.
  Status end() {
    text_ += '\n';
    return text_.size() < kPiece ? Status() : flush();
  }
  Status flush() {
    const Status status = sink_(text_);
    text_.clear();
    return status;
  }

 private:
  const std::function<Status(std::string_view)>& sink_;
  std::string text_;
};

// "v x y z" for each `columns` numbers.
Status writeRows(Lines& lines, std::string_view keyword, const std::vector<double>& numbers,
                 std::size_t columns) {
  for (std::size_t i = 0; i < numbers.size(); i += columns) {
    lines.word(keyword);
    for (std::size_t k = 0; k < columns; ++k) {
      lines.word(" ");
      lines.number(numbers[i + k]);
    }
    RETURN_IF_ERROR(lines.end());
  }
  return {};
}

}  // namespace

Status writeTexturedObj(const ParameterizedMesh& mesh,
                        const std::function<Status(std::string_view)>& sink) {
  Lines lines(sink);
  RETURN_IF_ERROR(writeRows(lines, "v", mesh.positions, 3));
  RETURN_IF_ERROR(writeRows(lines, "vt", mesh.points, 2));
  for (std::size_t i = 0; i < mesh.faces.size(); i += 3) {
    lines.word("f");
    for (std::size_t k = i; k < i + 3; ++k) {
      lines.word(" ");
      lines.number(mesh.faces[k] + 1);
      if (mesh.corners[k] < 0) continue;
      lines.word("/");
      lines.number(mesh.corners[k] + 1);
    }
    RETURN_IF_ERROR(lines.end());
  }
  return lines.flush();
}

}  // namespace moduli::cli
