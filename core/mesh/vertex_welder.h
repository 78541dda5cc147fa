#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_soup.h"

namespace moduli {

/// Gives equal points the same number, counted by first use. Equal means equal coordinates:
/// 0.0 and -0.0 are (the first spelling stays), NaN equals nothing. Expected O(1) per point; the
/// hash is keyed at random, so that no file can be made to be slow, and numbers do not depend on
/// it.
class VertexWelder {
 public:
  VertexWelder();
  Index add(const Eigen::Vector3d& position);
  std::vector<Eigen::Vector3d> vertices() && { return std::move(vertices_); }

 private:
  std::uint64_t hash(const Eigen::Vector3d& position) const;
  void grow();

  std::uint64_t key_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Index> slots_;  // Open addressing; a power of two, at most half full.
};

}  // namespace moduli
