#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/retrieval/principal_axes.h"
#include "core/retrieval/vector_index.h"

namespace moduli {

/// Of every row of a set the first few principal coordinates and the length of the rest: a distance
/// of those bounds the distance of turned rows from below.
class LeadRows {
 public:
  /// As many coordinates as rule out nearly all rows and cost little memory beside the rows.
  static std::size_t few(std::size_t dimension);

  /// Row i of these is rows[i] of the set. leading: number of coordinates; all if there are fewer.
  LeadRows(const VectorSet& set, const PrincipalAxes& axes, std::span<const std::uint32_t> rows,
           std::size_t leading);

  std::size_t count() const { return values_.size() / columns(); }
  std::size_t columns() const { return leading_ + (leading_ < dimension_ ? 1 : 0); }
  /// columns() values.
  const float* row(std::size_t i) const { return values_.data() + i * columns(); }
  float* row(std::size_t i) { return values_.data() + i * columns(); }

  /// Keeps what leadOf() needs.
  void forgetRows() { std::vector<float>().swap(values_); }

  /// The columns() values of a vector as from PrincipalAxes::turn.
  std::vector<float> leadOf(std::span<const float> turned) const;

 private:
  void fill(std::span<const float> turned, float* lead) const;

  std::size_t dimension_;
  std::size_t leading_;
  std::vector<float> values_;
};

}  // namespace moduli
