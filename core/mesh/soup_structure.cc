#include "core/mesh/soup_structure.h"

#include "core/mesh/connectivity.h"
#include "core/mesh/disjoint_sets.h"

namespace moduli {
namespace {

Index tail(const std::vector<Triangle>& faces, Index h) {
  return faces[h / 3][h % 3];
}

void linkPartners(std::size_t face_count, SoupStructure& structure) {
  structure.partner.assign(3 * face_count, kNone);
  for (std::size_t k = 0; k < structure.edges.count(); ++k) {
    const auto group = structure.edges.group(k);
    for (std::size_t i = 0; i < group.size(); ++i) {
      structure.partner[group[i]] = group[i + 1 == group.size() ? 0 : i + 1];
    }
  }
}

// Walks one sheet from its lowest face, turning each face to agree with the one it came from.
void walkSheet(const std::vector<Triangle>& faces, Index seed, std::vector<Index>& open,
               SoupStructure& structure) {
  const Index sheet = structure.sheets;
  structure.sheet[seed] = sheet;
  open.push_back(seed);
  while (!open.empty()) {
    const Index f = open.back();
    open.pop_back();
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (!structure.isPaired(h)) continue;
      const Index other = structure.partner[h];
      const Index g = other / 3;
      const bool clash = tail(faces, h) == tail(faces, other);
      if (clash) structure.inconsistent[sheet] = true;
      const bool against = structure.against[f] != clash;
      if (structure.sheet[g] == kNone) {
        structure.sheet[g] = sheet;
        structure.against[g] = against;
        open.push_back(g);
      } else if (structure.against[g] != against) {
        structure.one_sided[sheet] = true;
      }
    }
  }
}

void labelSheets(const std::vector<Triangle>& faces, SoupStructure& structure) {
  structure.sheet.assign(faces.size(), kNone);
  structure.against.assign(faces.size(), false);
  std::vector<Index> open;
  for (Index f = 0; f < static_cast<Index>(faces.size()); ++f) {
    if (structure.sheet[f] != kNone || structure.partner[3 * f] == kNone) continue;
    structure.one_sided.push_back(false);
    structure.inconsistent.push_back(false);
    walkSheet(faces, f, open, structure);
    ++structure.sheets;
  }
}

// Joins the sheets that meet at crowded edges.
void labelComponents(SoupStructure& structure) {
  DisjointSets joined(structure.sheets);
  for (std::size_t k = 0; k < structure.edges.count(); ++k) {
    const auto group = structure.edges.group(k);
    if (group.size() < 3) continue;
    for (const Index h : group) joined.join(structure.sheet[group[0] / 3], structure.sheet[h / 3]);
  }
  std::vector<Index> number(structure.sheets, kNone);
  for (Index s = 0; s < structure.sheets; ++s) {
    Index& of_root = number[joined.root(s)];
    if (of_root == kNone) of_root = structure.components++;
    number[s] = of_root;
  }
  structure.component = structure.sheet;
  for (Index& c : structure.component) {
    if (c != kNone) c = number[c];
  }
}

// Turns around the vertex of `seed` as long as faces agree and edges have two of them; returns the
// corner where that ended, `seed` itself after a full turn.
Index turnAround(const std::vector<Triangle>& faces, Index seed, SoupStructure& structure) {
  const Index v = tail(faces, seed);
  Index corner = seed;
  do {
    const Index side = Connectivity::previous(corner);
    const Index other = structure.partner[side];
    if (!structure.isPaired(side) || tail(faces, other) != v) return corner;
    corner = other;
    structure.fan[corner] = structure.fans;
  } while (corner != seed);
  return seed;
}

void walkFan(const std::vector<Triangle>& faces, Index seed, std::vector<Index>& open,
             SoupStructure& structure) {
  structure.fan[seed] = structure.fans;
  const Index end = turnAround(faces, seed, structure);
  const Index v = tail(faces, seed);
  const auto visit = [&](Index h) {
    const Index other = structure.partner[h];
    const Index corner = tail(faces, other) == v ? other : Connectivity::next(other);
    if (structure.fan[corner] != kNone) return;
    structure.fan[corner] = structure.fans;
    open.push_back(corner);
  };
  open.push_back(seed);
  if (end != seed) open.push_back(end);
  while (!open.empty()) {
    const Index corner = open.back();
    open.pop_back();
    visit(corner);
    visit(Connectivity::previous(corner));
  }
}

void labelFans(const std::vector<Triangle>& faces, SoupStructure& structure) {
  structure.fan.assign(3 * faces.size(), kNone);
  std::vector<Index> open;
  for (Index k = 0; k < static_cast<Index>(structure.fan.size()); ++k) {
    if (structure.fan[k] != kNone || structure.partner[k] == kNone) continue;
    walkFan(faces, k, open, structure);
    ++structure.fans;
  }
}

}  // namespace

SoupStructure analyseSoup(Index vertex_count, const std::vector<Triangle>& faces) {
  SoupStructure structure;
  structure.edges = groupEdges(vertex_count, faces);
  linkPartners(faces.size(), structure);
  labelSheets(faces, structure);
  labelComponents(structure);
  labelFans(faces, structure);
  return structure;
}

std::vector<ComponentCounts> countComponents(const SoupStructure& structure) {
  std::vector<ComponentCounts> counts(structure.components);
  const auto of = [&](Index h) -> ComponentCounts& { return counts[structure.component[h / 3]]; };
  for (auto f = static_cast<Index>(structure.component.size()) - 1; f >= 0; --f) {
    if (structure.component[f] == kNone) continue;
    of(3 * f).first_face = f;
    ++of(3 * f).faces;
  }
  Index fans_seen = 0;
  for (Index k = 0; k < static_cast<Index>(structure.fan.size()); ++k) {
    if (structure.fan[k] != fans_seen) continue;
    ++fans_seen;
    ++of(k).vertices;
  }
  // A loop is a connected piece of the graph of boundary edges: its vertices less its joins.
  DisjointSets joined(structure.fans);
  std::vector<bool> on_boundary(structure.fans, false);
  for (std::size_t k = 0; k < structure.edges.count(); ++k) {
    const Index h = structure.edges.group(k)[0];
    ++of(h).edges;
    if (structure.partner[h] != h) continue;
    const Index a = structure.fan[h];
    const Index b = structure.fan[Connectivity::next(h)];
    for (const Index fan : {a, b}) {
      if (!on_boundary[fan]) ++of(h).boundary_loops;
      on_boundary[fan] = true;
    }
    if (joined.join(a, b)) --of(h).boundary_loops;
  }
  return counts;
}

}  // namespace moduli
