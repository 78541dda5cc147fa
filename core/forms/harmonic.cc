#include "core/forms/harmonic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/forms/cotan.h"
#include "core/forms/flat_triangle.h"
#include "core/linalg/spd_solver.h"

namespace moduli {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// -d0^T W cochain, without the row of vertex 0.
void addDivergence(const Connectivity& surface, const std::vector<double>& weights,
                   const std::vector<int>& cochain, Eigen::Ref<Eigen::VectorXd> b) {
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (cochain[e] == 0) continue;
    const double flow = weights[e] * cochain[e];
    const Index h = surface.halfedge(e);
    if (surface.tail(h) > 0) b[surface.tail(h) - 1] += flow;
    if (surface.head(h) > 0) b[surface.head(h) - 1] -= flow;
  }
}

/// A sum whose rounding error does not grow with the number of terms (Neumaier).
class ExactSum {
 public:
  void add(double x) {
    const double sum = sum_ + x;
    lost_ += std::abs(sum_) >= std::abs(x) ? (sum_ - sum) + x : (x - sum) + sum_;
    sum_ = sum;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0;
  double lost_ = 0;
};

}  // namespace

ClosedForm combine(double a, const ClosedForm& x, double b, const ClosedForm& y) {
  ClosedForm result = x;
  for (std::size_t e = 0; e < result.cochain.size(); ++e) {
    result.cochain[e] = a * x.cochain[e] + b * y.cochain[e];
  }
  for (std::size_t v = 0; v < result.potential.size(); ++v) {
    result.potential[v] = a * x.potential[v] + b * y.potential[v];
  }
  return result;
}

Result<HarmonicForms> harmonicForms(Context& context, const Connectivity& surface,
                                    const std::vector<double>& weights,
                                    const std::vector<std::vector<int>>& cochains) {
  ASSIGN_OR_RETURN(const SpdSolver solver,
                   SpdSolver::make(context, pinnedStiffness(surface, weights, 0)));
  const auto count = static_cast<Eigen::Index>(cochains.size());
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(surface.vertexCount() - 1, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    addDivergence(surface, weights, cochains[a], b.col(a));
  }
  ASSIGN_OR_RETURN(const Eigen::MatrixXd f, solver.solve(context, b));
  HarmonicForms result;
  result.solver_residual = solver.largestResidual();
  for (Eigen::Index a = 0; a < count; ++a) {
    ClosedForm form;
    form.cochain.assign(cochains[a].begin(), cochains[a].end());
    form.potential.assign(surface.vertexCount(), 0.0);
    std::copy(f.col(a).begin(), f.col(a).end(), form.potential.begin() + 1);
    result.forms.push_back(std::move(form));
  }
  return result;
}

EnergyForm energyForm(const Connectivity& surface, const std::vector<double>& lengths,
                      const std::vector<ClosedForm>& forms) {
  const std::size_t count = forms.size();
  std::vector<ExactSum> sums(count * count);
  std::vector<double> defects(count, 0.0);
  std::vector<Eigen::Vector2d> gradients(count);
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const std::array<Index, 3> edges{surface.edge(3 * f), surface.edge(3 * f + 1),
                                     surface.edge(3 * f + 2)};
    const TriangleFrame frame({lengths[edges[0]], lengths[edges[1]], lengths[edges[2]]});
    for (std::size_t a = 0; a < count; ++a) {
      std::array<double, 3> along{};
      double size = 0;  // Of the numbers whose rounding enters the gradient.
      for (int c = 0; c < 3; ++c) {
        const double value = forms[a].onEdge(surface, edges[c]);
        along[c] = surface.sign(3 * f + c) * value;
        size = std::max(size, std::abs(value) + 2 * std::abs(forms[a].cochain[edges[c]]));
      }
      gradients[a] = frame.gradient(along);
      // Rounding moves the gradient by a few units of |gradient| along the longest side and of
      // size / height across it.
      const double defect = 8 * kEpsilon * (gradients[a].norm() + size / frame.height());
      defects[a] += frame.area() * defect * defect;
      for (std::size_t b = 0; b <= a; ++b) {
        sums[a * count + b].add(frame.area() * gradients[a].dot(gradients[b]));
      }
    }
  }
  EnergyForm result;
  result.energy.resize(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const auto i = static_cast<Eigen::Index>(a);
      const auto j = static_cast<Eigen::Index>(b);
      result.energy(i, j) = result.energy(j, i) = sums[a * count + b].value();
    }
  }
  // |<x + dx, y + dy> - <x, y>| <= |dx| |y| + |x| |dy| to first order, by Cauchy and Schwarz; the
  // areas and the sums add some units in the last place.
  for (std::size_t a = 0; a < count; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    const double relative = std::sqrt(defects[a] / result.energy(i, i));
    result.rounding = std::max(result.rounding, 2 * relative + 16 * kEpsilon);
  }
  return result;
}

}  // namespace moduli
