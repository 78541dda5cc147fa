#include "core/matching/same_triangulation.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace moduli {
namespace {

constexpr int kRings = 12;
constexpr std::size_t kMostTries = 64;

/// Mixes the bits of a number: the finalizer of splitmix64.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// A surface seen as it is, or in a mirror: there faces run the other way round, so that the next
/// halfedge is the one before.
class Sense {
 public:
  Sense(const Connectivity& surface, bool mirror) : surface_(surface), mirror_(mirror) {}
  Index next(Index h) const { return mirror_ ? surface_.previous(h) : surface_.next(h); }
  Index twin(Index h) const { return surface_.twin(h); }
  /// Where the halfedge starts, in that sense.
  Index origin(Index h) const { return mirror_ ? surface_.head(h) : surface_.tail(h); }
  Index vertexCount() const { return surface_.vertexCount(); }
  Index halfedgeCount() const { return surface_.halfedgeCount(); }

 private:
  const Connectivity& surface_;
  bool mirror_;
};

/// A number per halfedge made of what surrounds it, the same under any numbering.
std::vector<std::uint64_t> surroundings(const Sense& surface) {
  std::vector<std::uint64_t> degree(surface.vertexCount(), 0);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) ++degree[surface.origin(h)];
  std::vector<std::uint64_t> kind(surface.halfedgeCount());
  for (Index h = 0; h < surface.halfedgeCount(); ++h) kind[h] = degree[surface.origin(h)];
  std::vector<std::uint64_t> next(kind.size());
  for (int ring = 0; ring < kRings; ++ring) {
    for (Index h = 0; h < surface.halfedgeCount(); ++h) {
      const Index after = surface.next(h), before = surface.next(after), twin = surface.twin(h);
      // Around the origin, too: a step over the edge and along.
      const Index turned = twin == kNone ? kNone : surface.next(twin);
      std::uint64_t sum = mixed(kind[h]);
      sum = mixed(sum + kind[after]);
      sum = mixed(sum + kind[before]);
      sum = mixed(sum + (twin == kNone ? 7 : kind[twin]));
      next[h] = mixed(sum + (turned == kNone ? 11 : kind[turned]));
    }
    kind.swap(next);
  }
  return kind;
}

/// Follows both surfaces from a pair of halfedges that correspond. Per halfedge of a that of b, or
/// nothing where they part.
std::optional<std::vector<Index>> follow(const Sense& a, const Sense& b, Index from, Index to) {
  std::vector<Index> image(a.halfedgeCount(), kNone);
  std::vector<char> taken(image.size(), 0);
  std::vector<Index> open = {from};
  image[from] = to;
  taken[to] = 1;
  std::size_t met = 1;
  const auto agree = [&](Index h, Index k) {
    if (h == kNone || k == kNone) return h == k;
    if (image[h] != kNone || taken[k] != 0) return image[h] == k;
    image[h] = k;
    taken[k] = 1;
    ++met;
    open.push_back(h);
    return true;
  };
  while (!open.empty()) {
    const Index h = open.back();
    open.pop_back();
    if (!agree(a.next(h), b.next(image[h])) || !agree(a.twin(h), b.twin(image[h]))) return {};
  }
  if (met != image.size()) return {};
  return image;
}

/// The halfedges of the rarest kind, of a, and those of the same kind, of b; empty where the kinds
/// of both are not the same.
std::pair<std::vector<Index>, std::vector<Index>> rarest(const std::vector<std::uint64_t>& a,
                                                         const std::vector<std::uint64_t>& b) {
  std::vector<std::uint64_t> kinds = a, others = b;
  std::sort(kinds.begin(), kinds.end());
  std::sort(others.begin(), others.end());
  if (kinds != others) return {};
  std::size_t fewest = kinds.size() + 1;
  std::uint64_t chosen = 0;
  for (auto i = kinds.begin(); i != kinds.end();) {
    const auto end = std::upper_bound(i, kinds.end(), *i);
    const auto count = static_cast<std::size_t>(end - i);
    if (count < fewest) {
      fewest = count;
      chosen = *i;
    }
    i = end;
  }
  const auto those = [&](const std::vector<std::uint64_t>& all) {
    std::vector<Index> found;
    for (std::size_t h = 0; h < all.size(); ++h) {
      if (all[h] == chosen) found.push_back(static_cast<Index>(h));
    }
    return found;
  };
  return {those(a), those(b)};
}

}  // namespace

Result<std::vector<std::vector<Index>>> sameTriangulations(Context& context, const Connectivity& a,
                                                           const Connectivity& b, bool mirror) {
  std::vector<std::vector<Index>> found;
  if (a.vertexCount() != b.vertexCount() || a.faceCount() != b.faceCount()) return found;
  RETURN_IF_ERROR(context.check());
  const Sense from(a, false), to(b, mirror);
  const auto [starts, ends] = rarest(surroundings(from), surroundings(to));
  if (ends.size() > kMostTries) return found;
  for (const Index end : ends) {
    RETURN_IF_ERROR(context.check());
    const std::optional<std::vector<Index>> image = follow(from, to, starts.front(), end);
    if (!image) continue;
    std::vector<Index> vertices(a.vertexCount(), kNone);
    for (Index h = 0; h < a.halfedgeCount(); ++h) vertices[a.tail(h)] = to.origin((*image)[h]);
    found.push_back(std::move(vertices));
  }
  return found;
}

}  // namespace moduli
