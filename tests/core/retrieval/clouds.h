#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "core/retrieval/vector_index.h"

namespace moduli {

enum class Shape { kUniform, kFamilies, kLattice, kEqual, kTiny, kHuge };

inline constexpr Shape kShapes[] = {Shape::kUniform, Shape::kFamilies, Shape::kLattice,
                                    Shape::kEqual,   Shape::kTiny,     Shape::kHuge};

/// Of `count` vectors; families lie around 40 centres, and both decay from axis to axis.
inline std::vector<std::vector<float>> shapedVectors(Shape shape, std::size_t count,
                                                     std::size_t dimension, unsigned seed) {
  std::mt19937 random(seed), fixed(99);
  std::normal_distribution<float> normal;
  std::vector<std::vector<float>> centres(40, std::vector<float>(dimension)), vectors;
  for (auto& centre : centres) {
    for (std::size_t i = 0; i < dimension; ++i) {
      centre[i] = normal(fixed) / static_cast<float>(i + 1);
    }
  }
  for (std::size_t row = 0; row < count; ++row) {
    std::vector<float> vector(dimension);
    const auto& centre = centres[random() % centres.size()];
    for (std::size_t i = 0; i < dimension; ++i) {
      const float value = normal(random);
      switch (shape) {
        case Shape::kUniform:
          vector[i] = value;
          break;
        case Shape::kFamilies:
          vector[i] = centre[i] + 0.3F * value / static_cast<float>(i + 1);
          break;
        case Shape::kLattice:
          vector[i] = std::round(value);
          break;
        case Shape::kEqual:
          vector[i] = 0.25F;
          break;
        case Shape::kTiny:
          vector[i] = 1e-30F * value;
          break;
        case Shape::kHuge:
          vector[i] = 1e37F * value;
          break;
      }
    }
    vectors.push_back(std::move(vector));
  }
  return vectors;
}

/// Ids run backwards and with gaps, so that none can mistake rows for ids.
inline VectorSet setOf(const std::vector<std::vector<float>>& vectors) {
  VectorSet set{vectors.empty() ? 0 : vectors[0].size(), {}, {}};
  for (const std::vector<float>& vector : vectors) {
    set.ids.push_back(static_cast<std::int64_t>(7 * (vectors.size() - set.ids.size())));
    set.values.insert(set.values.end(), vector.begin(), vector.end());
  }
  return set;
}

/// The same rows with their ids, in another order.
inline VectorSet shuffled(const VectorSet& set, unsigned seed) {
  std::vector<std::size_t> order(set.ids.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  VectorSet result{set.dimension, {}, {}};
  for (const std::size_t row : order) {
    result.ids.push_back(set.ids[row]);
    const auto begin = set.values.begin() + static_cast<std::ptrdiff_t>(row * set.dimension);
    result.values.insert(result.values.end(), begin,
                         begin + static_cast<std::ptrdiff_t>(set.dimension));
  }
  return result;
}

}  // namespace moduli
