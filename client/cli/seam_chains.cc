#include "client/cli/seam_chains.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "core/mesh/disjoint_sets.h"

namespace moduli::cli {
namespace {

using Pair = std::pair<int, int>;

// Dark enough for lines, told apart by most eyes (after Okabe and Ito).
constexpr std::array<Color, 8> kChainColors = {{{213, 94, 0},
                                                {0, 114, 178},
                                                {0, 140, 100},
                                                {190, 80, 150},
                                                {160, 110, 0},
                                                {70, 150, 220},
                                                {110, 60, 150},
                                                {150, 60, 50}}};

constexpr std::array<Color, 6> kIslandColors = {{{222, 229, 238},
                                                 {243, 231, 216},
                                                 {222, 238, 226},
                                                 {240, 224, 236},
                                                 {238, 237, 214},
                                                 {216, 235, 238}}};

Pair ends(const MapEdge& edge) {
  return std::minmax(edge.vertices[0], edge.vertices[1]);
}

}  // namespace

std::vector<EdgeGroup> seamChains(const MapDrawing& drawing) {
  // Seams of the surface, their drawn edges, and how many of them meet at a vertex.
  std::map<Pair, std::vector<int>> seams;
  std::set<int> on_boundary;
  for (std::size_t e = 0; e < drawing.edges.size(); ++e) {
    const MapEdge& edge = drawing.edges[e];
    if (edge.kind == MapEdge::Kind::kSeam) seams[ends(edge)].push_back(static_cast<int>(e));
    if (edge.kind == MapEdge::Kind::kBoundary) {
      on_boundary.insert(edge.vertices.begin(), edge.vertices.end());
    }
  }
  std::map<int, std::vector<int>> at;  // Numbers of seams, by vertex.
  int count = 0;
  for (const auto& [pair, edges] : seams) {
    at[pair.first].push_back(count);
    at[pair.second].push_back(count++);
  }
  DisjointSets chains(count);
  for (const auto& [vertex, numbers] : at) {
    if (numbers.size() == 2 && !on_boundary.contains(vertex)) chains.join(numbers[0], numbers[1]);
  }
  std::map<int, std::size_t> color_of;
  std::vector<EdgeGroup> groups(std::min<std::size_t>(kChainColors.size(), seams.size()));
  for (std::size_t i = 0; i < groups.size(); ++i) groups[i].color = kChainColors[i];
  int number = 0;
  for (const auto& [pair, edges] : seams) {
    const auto [found, is_new] = color_of.try_emplace(chains.root(number++), color_of.size());
    std::vector<int>& group = groups[found->second % kChainColors.size()].edges;
    group.insert(group.end(), edges.begin(), edges.end());
  }
  return groups;
}

std::vector<int> findIslands(const MapDrawing& drawing) {
  DisjointSets sets(static_cast<int>(drawing.points.size()));
  for (const int f : drawing.mapped) {
    sets.join(drawing.corners[f][0], drawing.corners[f][1]);
    sets.join(drawing.corners[f][0], drawing.corners[f][2]);
  }
  std::vector<int> number(drawing.points.size(), -1), islands(drawing.faces.size(), -1);
  int count = 0;
  for (std::size_t f = 0; f < islands.size(); ++f) {
    if (!drawing.isMapped(static_cast<int>(f))) continue;
    int& island = number[static_cast<std::size_t>(sets.root(drawing.corners[f][0]))];
    if (island < 0) island = count++;
    islands[f] = island;
  }
  return islands;
}

Color islandColor(int island) {
  return island < 0 ? Color{205, 214, 224}
                    : kIslandColors[std::size_t(island) % kIslandColors.size()];
}

}  // namespace moduli::cli
