#include "core/topology/homotopy_basis.h"

#include <cstddef>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

namespace moduli {
namespace {

Word slice(const Word& word, std::size_t from, std::size_t to) {
  return {word.begin() + static_cast<std::ptrdiff_t>(from),
          word.begin() + static_cast<std::ptrdiff_t>(to)};
}

Word product(std::initializer_list<Word> factors) {
  Word result;
  for (const Word& factor : factors) result.insert(result.end(), factor.begin(), factor.end());
  return result;
}

/// What the sides of a face are to the polygon: kNone inside it, 0 on the tree, k + 1 on leftover
/// edge k.
std::vector<int> lettersOfEdges(const Connectivity& surface, const TreeCotree& trees) {
  std::vector<int> letter(surface.edgeCount(), kNone);
  for (const Index h : trees.vertex_parent) {
    if (h != kNone) letter[surface.edge(h)] = 0;
  }
  int count = 0;
  for (const Index e : trees.leftover) letter[e] = ++count;
  return letter;
}

/// The side of the polygon after h: turns clockwise around the head of h through the faces inside.
Index nextSide(const Connectivity& surface, const std::vector<int>& letter, Index h) {
  h = Connectivity::next(h);
  while (letter[surface.edge(h)] == kNone) h = Connectivity::next(surface.twin(h));
  return h;
}

/// Whether each of 1 .. n occurs once with either sign.
bool isGluing(const Word& word) {
  const auto letters = static_cast<int>(word.size() / 2);
  std::vector<bool> seen(2 * static_cast<std::size_t>(letters) + 1, false);
  for (const int x : word) {
    if (x == 0 || x < -letters || x > letters || seen[letters + x]) return false;
    seen[letters + x] = true;
  }
  return word.size() % 2 == 0;
}

/// Per place of a word the place of the inverse letter. letters: their number, of all words.
std::vector<std::size_t> gluedPlaces(const Word& word, std::size_t letters) {
  std::vector<std::size_t> first(letters + 1, word.size());
  std::vector<std::size_t> glued(word.size());
  for (std::size_t i = 0; i < word.size(); ++i) {
    std::size_t& earlier = first[std::abs(word[i])];
    if (earlier == word.size()) {
      earlier = i;
    } else {
      glued[i] = earlier;
      glued[earlier] = i;
    }
  }
  return glued;
}

/// The places at which a word a P b Q a^-1 R b^-1 S is cut, where a is its first letter.
struct Link {
  std::size_t b = 0;
  std::size_t a_inverse = 0;
  std::size_t b_inverse = 0;
};

/// A letter between a and a^-1 whose inverse is not, of either sign; of these one with short Q and
/// R. There is one if all corners meet at one point: loops cross only at the base point, where two
/// of them do if and only if their letters are linked, so that the links of the letters are, up to
/// signs, the matrix of the intersection form, which is unimodular and has no row of zeros.
std::optional<Link> findLink(const Word& word, std::size_t letters) {
  const std::vector<std::size_t> glued = gluedPlaces(word, letters);
  std::optional<Link> best;
  std::size_t best_cost = 0;
  for (std::size_t b = 1; b < glued[0]; ++b) {
    if (glued[b] < glued[0]) continue;
    const std::size_t cost = glued[0] - b + 3 * (glued[b] - glued[0]);
    if (best && cost >= best_cost) continue;
    best = Link{b, glued[0], glued[b]};
    best_cost = cost;
  }
  return best;
}

/// A word as [a, b] rest.
struct Handle {
  Word a, b, rest;
};

/// With A = a Q^-1 R^-1 and B = R Q P b R^-1, the word a P b Q a^-1 R b^-1 S is A B A^-1 B^-1 R Q P
/// S as it stands, in the free group. The rest has each of its letters twice and is the polygon
/// that remains when the handle is taken off the surface: all its corners meet at one point again.
Handle splitOffHandle(const Word& word, const Link& link) {
  const Word p = slice(word, 1, link.b);
  const Word q = slice(word, link.b + 1, link.a_inverse);
  const Word r = slice(word, link.a_inverse + 1, link.b_inverse);
  const Word s = slice(word, link.b_inverse + 1, word.size());
  return {reduceWord(product({{word[0]}, inverseWord(q), inverseWord(r)})),
          reduceWord(product({r, q, p, {word[link.b]}, inverseWord(r)})), product({r, q, p, s})};
}

}  // namespace

Word inverseWord(const Word& word) {
  Word inverse(word.rbegin(), word.rend());
  for (int& x : inverse) x = -x;
  return inverse;
}

Word reduceWord(const Word& word) {
  Word reduced;
  for (const int x : word) {
    if (!reduced.empty() && reduced.back() == -x) {
      reduced.pop_back();
    } else {
      reduced.push_back(x);
    }
  }
  return reduced;
}

Word polygonWord(const Connectivity& surface, const TreeCotree& trees) {
  Word word;
  if (trees.leftover.empty()) return word;
  const std::vector<int> letter = lettersOfEdges(surface, trees);
  const Index first = surface.halfedge(trees.leftover[0]);
  Index h = first;
  do {
    const int x = letter[surface.edge(h)];
    if (x > 0) word.push_back(surface.sign(h) * x);
    h = nextSide(surface, letter, h);
  } while (h != first);
  return word;
}

Result<HomotopyBasis> canonicalBasisOfPolygon(const Word& polygon) {
  if (!isGluing(polygon)) {
    return Status(Reason::kInvalidOption,
                  "a polygon's word must have each letter once with either sign");
  }
  HomotopyBasis basis;
  Word word = polygon;
  while (!word.empty()) {
    const auto link = findLink(word, polygon.size() / 2);
    if (!link) {
      return Status(Reason::kInvalidOption,
                    "the polygon's corners do not meet at one point: no letter is linked with " +
                        std::to_string(word[0]));
    }
    Handle handle = splitOffHandle(word, *link);
    basis.a.push_back(std::move(handle.a));
    basis.b.push_back(std::move(handle.b));
    word = std::move(handle.rest);
  }
  return basis;
}

Result<HomotopyBasis> canonicalHomotopyBasis(const Connectivity& surface, const TreeCotree& trees) {
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (!surface.isBoundaryEdge(e)) continue;
    return Status(Reason::kUnsupportedTopology,
                  "the surface has a boundary, at face " +
                      std::to_string(Connectivity::faceOf(surface.halfedge(e))));
  }
  if (trees.leftover.empty()) {
    return Status(Reason::kUnsupportedTopology,
                  "the surface is a sphere, on which every loop shrinks to a point");
  }
  return canonicalBasisOfPolygon(polygonWord(surface, trees));
}

Walk walkOfWord(const Connectivity& surface, const TreeCotree& trees, const Word& word) {
  Walk walk;
  for (const int x : word) {
    const Walk loop = basedLoop(surface, trees, static_cast<std::size_t>(std::abs(x)) - 1);
    for (const Step& step : x > 0 ? loop : inverseWalk(loop)) {
      if (!walk.empty() && walk.back() == Step{step.edge, -step.sign}) {
        walk.pop_back();
      } else {
        walk.push_back(step);
      }
    }
  }
  return walk;
}

}  // namespace moduli
