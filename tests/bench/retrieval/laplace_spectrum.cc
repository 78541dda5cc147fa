#include <Spectra/SymEigsSolver.h>

#include <cmath>
#include <optional>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/linalg/spd_solver.h"
#include "tests/bench/retrieval/descriptors.h"

namespace moduli {
namespace {

// x -> (D L D + shift)^-1 x with D = M^-1/2, in the form that Spectra wants.
class ShiftedInverse {
 public:
  using Scalar = double;

  ShiftedInverse(Context& context, const SpdSolver& solver, Index size)
      : context_(context), solver_(solver), size_(size) {}

  Eigen::Index rows() const { return size_; }
  Eigen::Index cols() const { return size_; }
  void perform_op(const double* in, double* out) const {
    if (!failure_.ok()) return;
    Result<Eigen::MatrixXd> x =
        solver_.solve(context_, Eigen::Map<const Eigen::VectorXd>(in, size_));
    if (x.ok()) {
      Eigen::Map<Eigen::VectorXd>(out, size_) = x->col(0);
    } else {
      failure_ = x.status();
      Eigen::Map<Eigen::VectorXd>(out, size_).setZero();
    }
  }
  const Status& failure() const { return failure_; }

 private:
  Context& context_;
  const SpdSolver& solver_;
  Eigen::Index size_;
  mutable Status failure_;
};

// Lower triangle of D L D + shift for masses that add up to 1.
SparseMatrix normalizedStiffness(const Connectivity& surface, const std::vector<double>& lengths,
                                 double shift) {
  SparseMatrix matrix = stiffnessMatrix(surface, cotanWeights(surface, lengths));
  std::vector<double> masses = vertexAreas(surface, lengths);
  double area = 0;
  for (const double mass : masses) area += mass;
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      entry.valueRef() *= area / std::sqrt(masses[entry.row()] * masses[column]);
      if (entry.row() == column) entry.valueRef() += shift;
    }
  }
  return matrix;
}

}  // namespace

Result<std::vector<double>> laplaceSpectrum(Context& context, const TriangleMesh& mesh, int count) {
  constexpr double kShift = 1;  // Eigenvalue k is about 4 pi k.
  const Connectivity& surface = mesh.connectivity();
  const int space = 2 * count + 20;  // Of Krylov vectors.
  if (surface.vertexCount() <= space) {
    return Status(Reason::kInvalidOption, "the mesh is too small for that many eigenvalues");
  }
  ASSIGN_OR_RETURN(const MollifiedLengths metric, mollify(surface, mesh.edgeLengths()));
  const SparseMatrix matrix = normalizedStiffness(surface, unitLengths(metric.lengths), kShift);
  ASSIGN_OR_RETURN(const SpdSolver solver, SpdSolver::make(context, matrix));
  ShiftedInverse inverse(context, solver, surface.vertexCount());
  Spectra::SymEigsSolver<ShiftedInverse> eigen(inverse, count + 1, space);
  eigen.init();
  eigen.compute(Spectra::SortRule::LargestMagn, 300, 1e-9);
  RETURN_IF_ERROR(inverse.failure());
  if (eigen.info() != Spectra::CompInfo::Successful) {
    return Status(Reason::kNoConvergence, "the eigenvalues do not converge");
  }
  std::vector<double> spectrum;
  const Eigen::VectorXd values = eigen.eigenvalues();  // Largest first; 1 / kShift is the constant.
  for (int k = 1; k <= count; ++k) spectrum.push_back(1 / values[k] - kShift);
  return spectrum;
}

}  // namespace moduli
