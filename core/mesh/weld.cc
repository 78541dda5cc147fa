#include "core/mesh/weld.h"

#include <algorithm>
#include <numeric>

#include "core/mesh/equal_vertices.h"
#include "core/mesh/soup_structure.h"

namespace moduli {
namespace {

// Keeping vertices apart can only bring new trouble where it brings back a face that was welded to
// a line; that seldom happens twice in a row. Past this many rounds nothing is welded at all.
constexpr int kMostRounds = 16;

std::vector<Triangle> renumber(std::vector<Triangle> faces, const std::vector<Index>& target) {
  for (Triangle& face : faces) {
    for (Index& v : face) v = target[v];
  }
  return faces;
}

// Sets of equal vertices, by their lowest, that must stay apart.
class WeldJudge {
 public:
  WeldJudge(const TriangleSoup& soup, const std::vector<Index>& target)
      : soup_(soup),
        target_(target),
        apart_(soup.vertices.size(), false),
        welded_(renumber(soup.faces, target)),
        structure_(analyseSoup(static_cast<Index>(soup.vertices.size()), welded_)) {}

  std::vector<bool> run() {
    judgeEdges();
    judgeSheets();
    return apart_;
  }

  bool objected() const { return objected_; }

 private:
  // An edge with too many faces is the weld's fault unless all of them shared it before.
  void judgeEdges() {
    for (std::size_t k = 0; k < structure_.edges.count(); ++k) {
      const auto group = structure_.edges.group(k);
      if (group.size() < 3) continue;
      const auto before = edgeBefore(group[0]);
      const bool was_there =
          std::all_of(group.begin(), group.end(), [&](Index h) { return edgeBefore(h) == before; });
      if (was_there) continue;
      keepApart(welded_[group[0] / 3][group[0] % 3]);
      keepApart(welded_[group[0] / 3][(group[0] % 3 + 1) % 3]);
    }
  }

  void judgeSheets() {
    for (std::size_t f = 0; f < welded_.size(); ++f) {
      const Index sheet = structure_.sheet[f];
      if (sheet == kNone || !structure_.one_sided[sheet]) continue;
      for (int c = 0; c < 3; ++c) {
        if (isShared(welded_[f][c])) keepApart(welded_[f][c]);
      }
    }
  }

  std::pair<Index, Index> edgeBefore(Index h) const {
    const Index a = soup_.faces[h / 3][h % 3];
    const Index b = soup_.faces[h / 3][(h % 3 + 1) % 3];
    return {std::min(a, b), std::max(a, b)};
  }

  bool isShared(Index lowest) {
    if (sharers_.empty()) {
      sharers_.assign(target_.size(), 0);
      for (const Index v : target_) ++sharers_[v];
    }
    return sharers_[lowest] > 1;
  }

  void keepApart(Index lowest) {
    apart_[lowest] = true;
    objected_ = true;
  }

  const TriangleSoup& soup_;
  const std::vector<Index>& target_;
  std::vector<bool> apart_;
  std::vector<Triangle> welded_;
  SoupStructure structure_;
  std::vector<Index> sharers_;
  bool objected_ = false;
};

bool weldsNothing(const std::vector<Index>& target) {
  for (std::size_t v = 0; v < target.size(); ++v) {
    if (target[v] != static_cast<Index>(v)) return false;
  }
  return true;
}

}  // namespace

Result<std::vector<Index>> planWeld(Context& context, const TriangleSoup& soup) {
  std::vector<Index> target = lowestEqualVertices(soup.vertices);
  for (int round = 0; round < kMostRounds; ++round) {
    if (weldsNothing(target)) return target;
    RETURN_IF_ERROR(context.check());
    WeldJudge judge(soup, target);
    const std::vector<bool> apart = judge.run();
    if (!judge.objected()) return target;
    for (std::size_t v = 0; v < target.size(); ++v) {
      if (apart[target[v]]) target[v] = static_cast<Index>(v);
    }
  }
  std::iota(target.begin(), target.end(), 0);
  return target;
}

}  // namespace moduli
