#include "core/hyperbolic/side_pairings.h"

#include <algorithm>
#include <cstdint>

#include "core/mesh/disjoint_sets.h"

namespace moduli {
namespace {

/// What the layout and the vertices' tree make of an edge.
enum class EdgeKind : std::uint8_t { kCrossed, kTree, kLetter };

Su11 pairing(const Connectivity& surface, const Development& development, Index h) {
  const Su11& here = development.placed[Connectivity::faceOf(h)];
  const Su11& beyond = development.placed[Connectivity::faceOf(surface.twin(h))];
  return renormalized(here * development.crossing[h] * inverse(beyond));
}

std::vector<EdgeKind> kindsOfEdges(const Connectivity& surface, const Development& development) {
  std::vector<EdgeKind> kind(surface.edgeCount(), EdgeKind::kLetter);
  for (const Index h : development.entry) {
    if (h != kNone) kind[surface.edge(h)] = EdgeKind::kCrossed;
  }
  struct Candidate {
    double displacement = 0;
    Index edge = 0;
  };
  std::vector<Candidate> uncrossed;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (kind[e] == EdgeKind::kCrossed) continue;
    uncrossed.push_back({displacement(pairing(surface, development, surface.halfedge(e))), e});
  }
  std::sort(uncrossed.begin(), uncrossed.end(), [](const Candidate& x, const Candidate& y) {
    return x.displacement != y.displacement ? x.displacement > y.displacement : x.edge < y.edge;
  });
  DisjointSets joined(surface.vertexCount());
  for (const Candidate& candidate : uncrossed) {
    const Index h = surface.halfedge(candidate.edge);
    if (joined.join(surface.tail(h), surface.head(h))) kind[candidate.edge] = EdgeKind::kTree;
  }
  return kind;
}

/// Walks once around the vertices' tree with the tree on its left, and back.
Word relationAround(const Connectivity& surface, const std::vector<EdgeKind>& kind,
                    const std::vector<int>& letter, Index first) {
  Word word;
  Index h = first;  // It leaves the vertex at whose corner in the face of h the walk stands.
  do {
    const Index side = Connectivity::previous(h);
    const Index e = surface.edge(side);
    if (kind[e] == EdgeKind::kTree) {
      h = side;
      continue;
    }
    if (kind[e] == EdgeKind::kLetter) word.push_back(surface.sign(side) * letter[e]);
    h = surface.twin(side);
  } while (h != first);
  return inverseWord(word);
}

}  // namespace

SidePairings findSidePairings(const Connectivity& surface, const Development& development) {
  SidePairings pairings;
  const std::vector<EdgeKind> kind = kindsOfEdges(surface, development);
  std::vector<int> letter(surface.edgeCount(), 0);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (kind[e] != EdgeKind::kLetter) continue;
    pairings.edges.push_back(e);
    pairings.letters.push_back(pairing(surface, development, surface.halfedge(e)));
    pairings.longest = std::max(pairings.longest, displacement(pairings.letters.back()));
    letter[e] = static_cast<int>(pairings.edges.size());
  }
  pairings.relation = relationAround(surface, kind, letter, surface.halfedge(pairings.edges[0]));
  return pairings;
}

}  // namespace moduli
