#pragma once

#include <vector>

/// Distributions as vectors of fixed length that are continuous in the values and in their weights:
/// what sampling and noise move a little changes them a little.
namespace moduli {

/// Means of the quantile function of a weighted sample over `count` equal parts of [0, 1],
/// ascending. The mean square difference of two such vectors is at most the square of the
/// Wasserstein distance W_2 of the distributions. values, weights: as many, weights >= 0 and not
/// all 0, finite. O(n log n).
std::vector<double> quantileMeans(const std::vector<double>& values,
                                  const std::vector<double>& weights, int count);

/// The same over kTailedParts parts that are finer at the ends, of which details such as limbs and
/// creases are: 1/8, 1/8, 1/4, 1/4, 1/8, 1/8.
inline constexpr int kTailedParts = 6;
std::vector<double> tailedQuantileMeans(const std::vector<double>& values,
                                        const std::vector<double>& weights);

/// A histogram over [0, highest] whose values share their weight between the two nearest of
/// `bins` equally spaced nodes, linearly. Values outside count at the end.
class SoftHistogram {
 public:
  /// highest > 0, bins >= 2.
  SoftHistogram(double highest, int bins);
  void add(double value, double weight);

  /// Weight of every node, sum 1. Something was added.
  std::vector<double> shares() const;
  /// quantileMeans of the nodes.
  std::vector<double> quantileMeans(int count) const;

 private:
  double highest_;
  std::vector<double> weights_;
};

}  // namespace moduli
