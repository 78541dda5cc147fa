#include "core/mesh/equal_vertices.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <tuple>

namespace moduli {
namespace {

std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 32)) * 0xD6E8FEB86659FD93U;
  x = (x ^ (x >> 32)) * 0xD6E8FEB86659FD93U;
  return x ^ (x >> 32);
}

// Adding zero makes minus zero plain zero.
std::uint64_t hashOf(const Eigen::Vector3d& p) {
  std::uint64_t hash = 0;
  for (int i = 0; i < 3; ++i) hash = mix(hash + std::bit_cast<std::uint64_t>(p[i] + 0.0));
  return hash;
}

}  // namespace

std::vector<Index> lowestEqualVertices(const std::vector<Eigen::Vector3d>& vertices) {
  const auto count = static_cast<Index>(vertices.size());
  const std::uint64_t mask = std::bit_ceil(vertices.size() + 1) - 1;
  std::vector<std::uint32_t> bucket_of(count);
  std::vector<Index> first(mask + 2, 0);
  for (Index v = 0; v < count; ++v) {
    bucket_of[v] = static_cast<std::uint32_t>(hashOf(vertices[v]) & mask);
    ++first[bucket_of[v] + 1];
  }
  for (std::size_t b = 0; b <= mask; ++b) first[b + 1] += first[b];
  std::vector<Index> order(count);
  std::vector<Index> cursor(first.begin(), first.end() - 1);
  for (Index v = 0; v < count; ++v) order[cursor[bucket_of[v]]++] = v;

  std::vector<Index> lowest(count);
  for (Index v = 0; v < count; ++v) lowest[v] = v;
  for (std::size_t b = 0; b <= mask; ++b) {
    if (first[b + 1] - first[b] < 2) continue;
    const auto begin = order.begin() + first[b];
    const auto end = std::remove_if(begin, order.begin() + first[b + 1],
                                    [&](Index v) { return !vertices[v].allFinite(); });
    std::sort(begin, end, [&](Index v, Index w) {
      const Eigen::Vector3d& p = vertices[v];
      const Eigen::Vector3d& q = vertices[w];
      return std::tie(p[0], p[1], p[2], v) < std::tie(q[0], q[1], q[2], w);
    });
    for (auto it = begin; it + 1 < end; ++it) {
      if (vertices[*it] == vertices[*(it + 1)]) lowest[*(it + 1)] = lowest[*it];
    }
  }
  return lowest;
}

}  // namespace moduli
