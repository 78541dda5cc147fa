#include "core/mesh/vertex_welder.h"

#include <bit>
#include <random>

namespace moduli {
namespace {

// One step of a keyed multiply-and-fold hash.
std::uint64_t fold(std::uint64_t a, std::uint64_t b) {
  __extension__ using Wide = unsigned __int128;
  const Wide product = static_cast<Wide>(a) * b;
  return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
}

}  // namespace

VertexWelder::VertexWelder() : slots_(1024, kNone) {
  std::random_device source;
  key_ = static_cast<std::uint64_t>(source()) << 32 | source();
}

std::uint64_t VertexWelder::hash(const Eigen::Vector3d& position) const {
  std::uint64_t result = key_;
  for (int i = 0; i < 3; ++i) {
    // Adding zero turns -0.0 into 0.0.
    const auto bits = std::bit_cast<std::uint64_t>(position[i] + 0.0);
    result = fold(bits ^ result ^ 0x9E3779B97F4A7C15U, key_ | 1U) + std::rotl(bits, 29);
  }
  return fold(result, 0xD6E8FEB86659FD93U);
}

Index VertexWelder::add(const Eigen::Vector3d& position) {
  if (2 * vertices_.size() >= slots_.size()) grow();
  const auto next = static_cast<Index>(vertices_.size());
  const bool comparable = position == position;
  if (comparable) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash(position) & mask;
    for (; slots_[slot] != kNone; slot = (slot + 1) & mask) {
      if (vertices_[slots_[slot]] == position) return slots_[slot];
    }
    slots_[slot] = next;
  }
  vertices_.push_back(position);
  return next;
}

void VertexWelder::grow() {
  slots_.assign(2 * slots_.size(), kNone);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    if (vertices_[v] != vertices_[v]) continue;
    std::size_t slot = hash(vertices_[v]) & mask;
    while (slots_[slot] != kNone) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<Index>(v);
  }
}

}  // namespace moduli
