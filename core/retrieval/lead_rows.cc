#include "core/retrieval/lead_rows.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace moduli {
namespace {

constexpr std::size_t kTurnedRows = 4096;

}  // namespace

std::size_t LeadRows::few(std::size_t dimension) {
  return std::min(dimension, std::clamp<std::size_t>(dimension / 4 + 2, 12, 18));
}

LeadRows::LeadRows(const VectorSet& set, const PrincipalAxes& axes,
                   std::span<const std::uint32_t> rows, std::size_t leading)
    : dimension_(set.dimension), leading_(std::min(leading, set.dimension)) {
  values_.resize(rows.size() * columns());
  parallelBlocks(rows.size(), kTurnedRows, [&](std::size_t begin, std::size_t end) {
    std::vector<float> turned((end - begin) * dimension_);
    axes.turnRows(set, rows.subspan(begin, end - begin), turned.data());
    for (std::size_t i = 0; i < end - begin; ++i) {
      fill(std::span(turned).subspan(i * dimension_, dimension_), row(begin + i));
    }
  });
}

void LeadRows::fill(std::span<const float> turned, float* lead) const {
  std::copy_n(turned.begin(), leading_, lead);
  if (leading_ == dimension_) return;
  double rest = 0;
  for (std::size_t i = leading_; i < dimension_; ++i) {
    rest += static_cast<double>(turned[i]) * turned[i];
  }
  lead[leading_] = static_cast<float>(std::sqrt(rest));
}

std::vector<float> LeadRows::leadOf(std::span<const float> turned) const {
  std::vector<float> lead(columns());
  fill(turned, lead.data());
  return lead;
}

}  // namespace moduli
