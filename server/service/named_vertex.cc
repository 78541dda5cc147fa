#include "server/service/named_vertex.h"

namespace moduli {

Result<Index> namedVertex(const std::string& what, Index vertex, const VertexPlaces& places) {
  const auto refuse = [&](const std::string& why, const std::string& hint) {
    return Status{Reason::kInvalidOption, what + " at vertex " + std::to_string(vertex) + why,
                  hint};
  };
  const auto count = static_cast<Index>(places.place.size());
  if (vertex < 0 || vertex >= count) {
    return refuse(", but the mesh has vertices 0 to " + std::to_string(count - 1),
                  "vertices are counted from 0 in the file's order");
  }
  const Index place = places.place[vertex];
  if (place == VertexPlaces::kSeveral) {
    return refuse(", where repair has split the surface into several vertices",
                  "put it at a vertex that is not pinched");
  }
  if (place != kNone) return place;
  if (!places.used[vertex]) {
    return refuse(", which no face uses", "put it at a vertex of the surface");
  }
  return refuse(
      ", whose faces are in another component, or were dropped by repair",
      "take its component with --component, or put " +
          (what.find(' ') == std::string::npos ? what : "the" + what.substr(what.find(' '))) +
          " elsewhere");
}

}  // namespace moduli
