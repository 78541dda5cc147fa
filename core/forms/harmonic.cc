#include "core/forms/harmonic.h"

#include <algorithm>
#include <utility>

#include "core/forms/cotan.h"
#include "core/linalg/spd_solver.h"

namespace moduli {
namespace {

/// Right-hand sides solved together: enough for the dense kernels, few enough that the solver's
/// copies stay small beside the factor.
constexpr Eigen::Index kColumnsAtOnce = 4;

/// -d0^T W cochain at every vertex.
void addDivergence(const Connectivity& surface, const std::vector<double>& weights,
                   const Cochain& cochain, Eigen::Ref<Eigen::VectorXd> b) {
  for (const CochainTerm& term : cochain) {
    const double flow = weights[term.edge] * static_cast<double>(term.value);
    const Index h = surface.halfedge(term.edge);
    b[surface.tail(h)] += flow;
    b[surface.head(h)] -= flow;
  }
}

/// Systems of the stiffness matrix in which one vertex is pinned to 0.
class PinnedSystem {
 public:
  static Result<PinnedSystem> make(Context& context, const Connectivity& surface,
                                   const std::vector<double>& weights, Index pinned) {
    SparseMatrix matrix = pinnedStiffness(surface, weights, pinned);
    ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, matrix));
    return PinnedSystem(std::move(matrix), std::move(solver), pinned);
  }

  /// Keeps further vertices fixed, on the symbolic analysis that is there: their rows and columns
  /// become those of a multiple of the identity.
  Status fix(Context& context, const std::vector<bool>& fixed) {
    const double unit = matrix_.diagonal().sum() / static_cast<double>(matrix_.rows());
    fixed_.assign(matrix_.rows(), false);
    for (Eigen::Index row = 0; row < matrix_.rows(); ++row) fixed_[row] = fixed[vertex(row)];
    for (Eigen::Index column = 0; column < matrix_.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator it(matrix_, column); it; ++it) {
        if (!fixed_[it.row()] && !fixed_[column]) continue;
        it.valueRef() = it.row() == column ? unit : 0;
      }
    }
    return solver_.refactorize(context, matrix_);
  }

  /// Adds to `potential` (V x k) the solutions for right-hand sides given by fill(column, b), b
  /// being zero at first; 0 at fixed vertices, whatever stands there in b.
  template <typename Fill>
  Status solve(Context& context, const Fill& fill, RowMajorMatrix& potential) const {
    Eigen::VectorXd full(potential.rows());
    for (Eigen::Index first = 0; first < potential.cols(); first += kColumnsAtOnce) {
      const Eigen::Index count = std::min(kColumnsAtOnce, potential.cols() - first);
      Eigen::MatrixXd b(matrix_.rows(), count);
      for (Eigen::Index k = 0; k < count; ++k) {
        full.setZero();
        fill(first + k, full);
        for (Eigen::Index row = 0; row < b.rows(); ++row) {
          b(row, k) = !fixed_.empty() && fixed_[row] ? 0 : full[vertex(row)];
        }
      }
      ASSIGN_OR_RETURN(const Eigen::MatrixXd x, solver_.solve(context, b));
      for (Eigen::Index row = 0; row < x.rows(); ++row) {
        potential.row(vertex(row)).segment(first, count) += x.row(row);
      }
    }
    return {};
  }

  double largestResidual() const { return solver_.largestResidual(); }

 private:
  PinnedSystem(SparseMatrix matrix, SpdSolver solver, Index pinned)
      : matrix_(std::move(matrix)), solver_(std::move(solver)), pinned_(pinned) {}
  Eigen::Index vertex(Eigen::Index row) const { return row < pinned_ ? row : row + 1; }

  SparseMatrix matrix_;
  SpdSolver solver_;
  Index pinned_;
  std::vector<bool> fixed_;  ///< Per row; empty: none.
};

/// Solves for the potentials that make the forms of cochains harmonic.
Status makeHarmonic(Context& context, const Connectivity& surface,
                    const std::vector<double>& weights, const std::vector<Cochain>& cochains,
                    const PinnedSystem& system, FormBasis& forms) {
  return system.solve(
      context,
      [&](Eigen::Index k, Eigen::VectorXd& b) { addDivergence(surface, weights, cochains[k], b); },
      forms.potential);
}

/// The functions that are 1 on one of the loops 1, 2, ... and 0 elsewhere, V x (b - 1).
RowMajorMatrix loopIndicators(const Connectivity& surface,
                              const std::vector<std::vector<Index>>& loops) {
  RowMajorMatrix values =
      RowMajorMatrix::Zero(surface.vertexCount(), static_cast<Eigen::Index>(loops.size()) - 1);
  for (std::size_t k = 1; k < loops.size(); ++k) {
    for (const Index h : loops[k]) {
      values(surface.tail(h), static_cast<Eigen::Index>(k) - 1) = 1;
    }
  }
  return values;
}

/// -L u at every vertex.
void addLaplacian(const Connectivity& surface, const std::vector<double>& weights,
                  const RowMajorMatrix& values, Eigen::Index column, Eigen::VectorXd& b) {
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    const double flow =
        weights[e] * (values(surface.head(h), column) - values(surface.tail(h), column));
    b[surface.tail(h)] += flow;
    b[surface.head(h)] -= flow;
  }
}

}  // namespace

Result<HarmonicForms> harmonicForms(Context& context, const Connectivity& surface,
                                    const std::vector<double>& weights,
                                    const std::vector<Cochain>& cochains) {
  HarmonicForms result{cochainForms(surface, cochains), 0};
  ASSIGN_OR_RETURN(const PinnedSystem system, PinnedSystem::make(context, surface, weights, 0));
  RETURN_IF_ERROR(makeHarmonic(context, surface, weights, cochains, system, result.forms));
  result.solver_residual = system.largestResidual();
  return result;
}

Eigen::MatrixXd fluxEnergy(const Connectivity& surface, const std::vector<double>& weights,
                           const std::vector<Cochain>& cochains, const FormBasis& forms) {
  const Eigen::Index count = forms.count();
  Eigen::MatrixXd energy = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (const CochainTerm& term : cochains[a]) {
      const double flow = weights[term.edge] * static_cast<double>(term.value);
      const Index h = surface.halfedge(term.edge);
      energy.row(a) +=
          flow * (forms.potential.row(surface.head(h)) - forms.potential.row(surface.tail(h)) +
                  forms.jumps.row(forms.seam[term.edge]));
    }
  }
  return (energy + energy.transpose()) / 2;
}

Result<RowMajorMatrix> harmonicFunctions(Context& context, const Connectivity& surface,
                                         const std::vector<double>& weights,
                                         const std::vector<bool>& fixed, RowMajorMatrix values) {
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    if (!fixed[v]) values.row(v).setZero();
  }
  const auto pinned = std::find(fixed.begin(), fixed.end(), true) - fixed.begin();
  ASSIGN_OR_RETURN(PinnedSystem system,
                   PinnedSystem::make(context, surface, weights, static_cast<Index>(pinned)));
  RETURN_IF_ERROR(system.fix(context, fixed));
  const RowMajorMatrix given = values;
  RETURN_IF_ERROR(system.solve(
      context,
      [&](Eigen::Index k, Eigen::VectorXd& b) { addLaplacian(surface, weights, given, k, b); },
      values));
  return values;
}

Result<BorderedForms> borderedHarmonicForms(Context& context, const Connectivity& surface,
                                            const std::vector<double>& weights,
                                            const BorderedCohomology& cohomology,
                                            const std::vector<std::vector<Index>>& boundary_loops) {
  const auto handles = static_cast<Eigen::Index>(cohomology.handles.size());
  const auto loops = static_cast<Eigen::Index>(cohomology.loops.size());
  std::vector<Cochain> tangential = cohomology.handles;
  tangential.insert(tangential.end(), cohomology.loops.begin(), cohomology.loops.end());
  // A pinned vertex on the boundary serves both kinds.
  const Index pinned = surface.tail(boundary_loops[0][0]);
  ASSIGN_OR_RETURN(PinnedSystem system, PinnedSystem::make(context, surface, weights, pinned));
  BorderedForms result{cochainForms(surface, tangential), {}, 0};
  RETURN_IF_ERROR(makeHarmonic(context, surface, weights, tangential, system, result.tangential));

  std::vector<Cochain> normal = cohomology.handles;
  normal.resize(handles + loops);  // The functions u_k have no jumps.
  result.normal = cochainForms(surface, normal);
  const RowMajorMatrix indicators = loopIndicators(surface, boundary_loops);
  result.normal.potential.rightCols(loops) = indicators;
  std::vector<bool> fixed(surface.vertexCount());
  for (Index v = 0; v < surface.vertexCount(); ++v) fixed[v] = surface.isBoundaryVertex(v);
  RETURN_IF_ERROR(system.fix(context, fixed));
  RETURN_IF_ERROR(system.solve(
      context,
      [&](Eigen::Index k, Eigen::VectorXd& b) {
        if (k < handles) {
          addDivergence(surface, weights, normal[k], b);
        } else {
          addLaplacian(surface, weights, indicators, k - handles, b);
        }
      },
      result.normal.potential));
  result.solver_residual = system.largestResidual();
  return result;
}

}  // namespace moduli
