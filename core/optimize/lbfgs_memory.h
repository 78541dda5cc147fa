#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>

namespace moduli {

/// The inverse Hessian as the last steps and changes of the gradient tell it (Nocedal's two loops).
class LbfgsMemory {
 public:
  /// pairs: at least 1, how many are kept.
  explicit LbfgsMemory(int pairs) : pairs_(static_cast<std::size_t>(pairs)) {}

  bool empty() const { return kept_.empty(); }
  void clear() { kept_.clear(); }

  /// Takes in a step and the change of the gradient over it, unless the curvature between them is
  /// not positive, which would make the inverse indefinite.
  void add(const Eigen::VectorXd& step, const Eigen::VectorXd& change);

  /// The inverse times the gradient; the gradient itself while empty. O(n pairs).
  Eigen::VectorXd apply(const Eigen::VectorXd& gradient) const;

 private:
  struct Pair {
    Eigen::VectorXd step, change;
    double curvature;
  };
  std::size_t pairs_;
  std::deque<Pair> kept_;
};

}  // namespace moduli
