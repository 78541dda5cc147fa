#include "client/cli/vertex_map_file.h"

#include <string>

#include "core/base/text.h"

namespace moduli::cli {
namespace {

constexpr std::size_t kPiece = 1 << 20;

}  // namespace

Status writeVertexMap(const VertexMap& map, const std::function<Status(std::string_view)>& sink) {
  std::string text = "vertex,face,b0,b1,b2\n";
  for (std::size_t v = 0; v < map.faces.size(); ++v) {
    text += std::to_string(v) + "," + std::to_string(map.faces[v]);
    for (std::size_t c = 0; c < 3; ++c) text += "," + shortestDouble(map.weights[3 * v + c]);
    text += '\n';
    if (text.size() < kPiece) continue;
    RETURN_IF_ERROR(sink(text));
    text.clear();
  }
  return sink(text);
}

}  // namespace moduli::cli
