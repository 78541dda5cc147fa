#include "core/matching/ring_mesh.h"

#include <algorithm>
#include <string>
#include <unordered_set>

namespace moduli {
namespace {

using Ring = std::vector<Index>;

Ring::iterator placeOf(Ring& ring, Index v) {
  return std::find(ring.begin(), ring.end(), v);
}

void rotateToFront(Ring& ring, Index v) {
  std::rotate(ring.begin(), placeOf(ring, v), ring.end());
}

Status checkRing(const Ring& ring, Index v) {
  Ring sorted = ring;
  std::sort(sorted.begin(), sorted.end());
  const bool twice = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  if (ring.size() >= 3 && !twice && std::find(ring.begin(), ring.end(), v) == ring.end()) return {};
  return {Reason::kUnsupportedTopology,
          "vertex " + std::to_string(v) +
              " has fewer than three neighbours, or is joined to one by two edges"};
}

/// On a disk two vertices of the rim are joined along the rim alone: by an edge of a cap's face.
Status checkRim(const RingMesh& mesh, Index v) {
  const auto joined = std::count_if(mesh.ring(v).begin(), mesh.ring(v).end(),
                                    [&](Index w) { return mesh.isRim(w); });
  if (joined == 2) return {};
  return {Reason::kUnsupportedTopology, "an edge inside joins boundary vertex " +
                                            std::to_string(v) + " to another boundary vertex"};
}

}  // namespace

Result<RingMesh> RingMesh::make(const Connectivity& surface, Index pole) {
  RingMesh mesh;
  mesh.count_ = surface.vertexCount();
  mesh.pole_ = pole;
  mesh.present_.assign(mesh.count_, 1);
  mesh.held_.assign(mesh.count_, 0);
  mesh.rings_.resize(mesh.count_);
  for (Index v = 0; v < mesh.count_; ++v) {
    if (surface.isBoundaryVertex(v)) {
      return Status(Reason::kUnsupportedTopology, "rings need a closed surface");
    }
    Index h = surface.outgoing(v);
    do {
      mesh.rings_[v].push_back(surface.head(h));
      h = surface.rotate(h);
    } while (h != surface.outgoing(v));
    RETURN_IF_ERROR(checkRing(mesh.rings_[v], v));
  }
  if (pole == kNone) return mesh;
  mesh.held_[pole] = 1;
  mesh.is_rim_.assign(mesh.count_, 0);
  for (const Index v : mesh.rings_[pole]) mesh.is_rim_[v] = 1;
  for (const Index v : mesh.rings_[pole]) RETURN_IF_ERROR(checkRim(mesh, v));
  return mesh;
}

bool RingMesh::keepsDisk(Index removed, Index kept) const {
  if (kept == pole_) return false;
  if (isRim(removed)) return isRim(kept);
  if (!isRim(kept)) return true;
  // A neighbour on the rim must be joined to `kept` already; the last vertex inside stays.
  const Ring& ring = rings_[removed];
  const bool alone = std::all_of(ring.begin(), ring.end(), [&](Index w) { return isRim(w); });
  return !alone && std::all_of(ring.begin(), ring.end(), [&](Index w) {
    return w == kept || !isRim(w) ||
           std::find(rings_[kept].begin(), rings_[kept].end(), w) != rings_[kept].end();
  });
}

bool RingMesh::canCollapse(Index removed, Index kept) const {
  if (count_ <= 4 || held_[removed] != 0) return false;
  if (pole_ != kNone && !keepsDisk(removed, kept)) return false;
  int common = 0;
  for (const Index w : rings_[removed]) {
    if (std::find(rings_[kept].begin(), rings_[kept].end(), w) == rings_[kept].end()) continue;
    ++common;
    if (rings_[w].size() <= 3) return false;
  }
  return common == 2;
}

void RingMesh::collapse(Index removed, Index kept) {
  Ring& ring = rings_[removed];
  rotateToFront(ring, kept);
  // Around `kept` the ring's first and last remain, and between them what lies behind `removed`.
  Ring& around = rings_[kept];
  const auto gap = around.erase(placeOf(around, removed));
  around.insert(gap, ring.begin() + 2, ring.end() - 1);
  for (std::size_t i = 1; i < ring.size(); ++i) {
    Ring& other = rings_[ring[i]];
    if (i == 1 || i + 1 == ring.size()) {
      other.erase(placeOf(other, removed));
    } else {
      *placeOf(other, removed) = kept;
    }
  }
  present_[removed] = 0;
  --count_;
  removed_.push_back({removed, kept});
}

RingMesh::Collapse RingMesh::restore() {
  const Collapse last = removed_.back();
  removed_.pop_back();
  const Ring& ring = rings_[last.removed];  // As collapse() left it: `kept` first.
  Ring& around = rings_[last.kept];
  rotateToFront(around, ring[1]);
  around.erase(around.begin() + 1, around.begin() + static_cast<std::ptrdiff_t>(ring.size()) - 2);
  around.insert(around.begin() + 1, last.removed);
  for (std::size_t i = 2; i + 1 < ring.size(); ++i) {
    *placeOf(rings_[ring[i]], last.kept) = last.removed;
  }
  Ring& first = rings_[ring[1]];
  first.insert(placeOf(first, last.kept), last.removed);
  Ring& final = rings_[ring.back()];
  final.insert(placeOf(final, last.kept) + 1, last.removed);
  present_[last.removed] = 1;
  ++count_;
  return last;
}

std::vector<RingMesh::Collapse> restoreSeparated(RingMesh& mesh, Index most) {
  std::vector<RingMesh::Collapse> restored;
  std::unordered_set<Index> back;
  while (static_cast<Index>(restored.size()) < most && !mesh.collapses().empty()) {
    const Ring& ring = mesh.ring(mesh.collapses().back().removed);
    if (std::any_of(ring.begin(), ring.end(), [&](Index w) { return back.count(w) > 0; })) break;
    restored.push_back(mesh.restore());
    back.insert(restored.back().removed);
  }
  return restored;
}

std::vector<std::vector<Index>> separatedSets(const RingMesh& mesh,
                                              const std::vector<Index>& vertices) {
  if (vertices.empty()) return {};
  const std::size_t none = vertices.size();
  const Index last = *std::max_element(vertices.begin(), vertices.end());
  std::vector<std::size_t> set_of(static_cast<std::size_t>(last) + 1, none);
  std::vector<std::vector<Index>> sets;
  std::vector<char> taken;
  for (const Index v : vertices) {
    taken.assign(sets.size() + 1, 0);
    for (const Index w : mesh.ring(v)) {
      if (w <= last && set_of[w] != none) taken[set_of[w]] = 1;
    }
    const auto free = std::find(taken.begin(), taken.end(), 0);
    set_of[v] = static_cast<std::size_t>(free - taken.begin());
    if (set_of[v] == sets.size()) sets.emplace_back();
    sets[set_of[v]].push_back(v);
  }
  return sets;
}

}  // namespace moduli
