#include "core/mesh/edge_groups.h"

#include <algorithm>
#include <cstdint>

namespace moduli {
namespace {

// The other end of a halfedge above its number: one integer that sorts by end, then by halfedge.
struct Entry {
  std::uint64_t key;

  Entry() = default;
  Entry(Index end, Index halfedge)
      : key((static_cast<std::uint64_t>(end) << 32) | static_cast<std::uint32_t>(halfedge)) {}
  Index end() const { return static_cast<Index>(key >> 32); }
  Index halfedge() const { return static_cast<Index>(key & 0xFFFFFFFFU); }
};

template <typename Visit>
void forEachHalfedge(const std::vector<Triangle>& faces, Visit visit) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (repeatsVertex(faces[f])) continue;
    for (int c = 0; c < 3; ++c) {
      const Index a = faces[f][c];
      const Index b = faces[f][(c + 1) % 3];
      visit(std::min(a, b), std::max(a, b), static_cast<Index>(3 * f + c));
    }
  }
}

// Buckets are a handful of entries at all but a few vertices.
void sortBucket(Entry* begin, Entry* end) {
  constexpr std::ptrdiff_t kSmall = 24;
  if (end - begin > kSmall) {
    std::sort(begin, end, [](Entry a, Entry b) { return a.key < b.key; });
    return;
  }
  for (Entry* i = begin; i < end; ++i) {
    const Entry moved = *i;
    Entry* hole = i;
    for (; hole > begin && (hole - 1)->key > moved.key; --hole) *hole = *(hole - 1);
    *hole = moved;
  }
}

}  // namespace

EdgeGroups groupEdges(Index vertex_count, const std::vector<Triangle>& faces) {
  std::vector<Index> bucket(vertex_count + 1, 0);
  forEachHalfedge(faces, [&](Index low, Index, Index) { ++bucket[low + 1]; });
  for (Index v = 0; v < vertex_count; ++v) bucket[v + 1] += bucket[v];

  std::vector<Entry> entries(bucket[vertex_count]);
  std::vector<Index> cursor(bucket.begin(), bucket.end() - 1);
  forEachHalfedge(faces,
                  [&](Index low, Index high, Index h) { entries[cursor[low]++] = Entry(high, h); });

  EdgeGroups groups;
  groups.halfedges.resize(entries.size());
  groups.first.reserve(entries.size() / 2 + 2);
  for (Index v = 0; v < vertex_count; ++v) {
    sortBucket(entries.data() + bucket[v], entries.data() + bucket[v + 1]);
    for (Index i = bucket[v]; i < bucket[v + 1]; ++i) {
      if (i == bucket[v] || entries[i].end() != entries[i - 1].end()) groups.first.push_back(i);
      groups.halfedges[i] = entries[i].halfedge();
    }
  }
  groups.first.push_back(bucket[vertex_count]);
  return groups;
}

}  // namespace moduli
