#include "core/optimize/lbfgs_memory.h"

#include <vector>

namespace moduli {

void LbfgsMemory::add(const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
  const double curvature = step.dot(change);
  if (!(curvature > 1e-14 * step.norm() * change.norm())) return;
  if (kept_.size() == pairs_) kept_.pop_front();
  kept_.push_back({step, change, curvature});
}

Eigen::VectorXd LbfgsMemory::apply(const Eigen::VectorXd& gradient) const {
  Eigen::VectorXd d = gradient;
  if (kept_.empty()) return d;
  std::vector<double> along(kept_.size());
  for (std::size_t k = kept_.size(); k-- > 0;) {
    along[k] = kept_[k].step.dot(d) / kept_[k].curvature;
    d -= along[k] * kept_[k].change;
  }
  d *= kept_.back().curvature / kept_.back().change.squaredNorm();
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    d += (along[k] - kept_[k].change.dot(d) / kept_[k].curvature) * kept_[k].step;
  }
  return d;
}

}  // namespace moduli
