#include "core/spherical/landmark_chart.h"

#include <Eigen/Dense>
#include <cmath>
#include <utility>

namespace moduli::spherical {
namespace {

using Complex = std::complex<double>;

/// Coefficients are kept this far inside the unit disk.
constexpr double kInside = 0.999;

/// The stereographic chart around a pole.
class Chart {
 public:
  explicit Chart(const Eigen::Vector3d& pole) : pole_(pole) {
    const Eigen::Vector3d helper =
        std::abs(pole.x()) < 0.6 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    x_ = pole.cross(helper).normalized();
    y_ = pole.cross(x_);
  }

  Complex project(const Eigen::Vector3d& point) const {
    // 1 + p.n, without cancellation near the centre of projection.
    const double denominator = 0.5 * (point + pole_).squaredNorm();
    return Complex(point.dot(x_), point.dot(y_)) / denominator;
  }

  Eigen::Vector3d lift(Complex w) const {
    return (2 * w.real() * x_ + 2 * w.imag() * y_ + (1 - std::norm(w)) * pole_).normalized();
  }

 private:
  Eigen::Vector3d pole_, x_, y_;
};

class ChartSolve {
 public:
  ChartSolve(const ChartProblem& problem, const Points3& points, const Eigen::Vector3d& pole,
             double reach)
      : problem_(problem), surface_(problem.surface), chart_(pole), pole_(pole), points_(points) {
    row_.assign(points.size(), kNone);
    near_.assign(points.size(), kNone);
    for (const Eigen::Vector3d& p : points) images_.push_back(chart_.project(p));
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      if (!(std::abs(images_[v]) < reach)) continue;
      row_[v] = static_cast<Index>(moving_.size());
      moving_.push_back(v);
    }
    for (const Triangle& face : surface_.faces()) {
      if (isNear(face)) {
        for (const Index v : face) {
          if (near_[v] == kNone) near_[v] = near_count_++;
        }
      }
    }
  }

  /// Neither all nor next to nothing moves.
  bool isSound() const { return moving_.size() >= 3 && moving_.size() + 3 <= points_.size(); }

  Result<Points3> solve(Context& context) {
    assemble();
    const auto count = static_cast<Eigen::Index>(moving_.size());
    const auto [pins, pin_values] = pinRows();
    Eigen::MatrixXd b(count, 2 + pins.rows());
    b.leftCols(2) = load_;
    b.rightCols(pins.rows()) = pins.transpose();
    ASSIGN_OR_RETURN(const SpdSolver solver, SpdSolver::make(context, energy_));
    ASSIGN_OR_RETURN(const Eigen::MatrixXd x, solver.solve(context, b));
    Eigen::MatrixXd w = x.leftCols(2);
    if (pins.rows() > 0) {
      const Eigen::MatrixXd pull = x.rightCols(pins.rows());
      const Eigen::MatrixXd compliance = pins * pull;
      const Eigen::LLT<Eigen::MatrixXd> factor(compliance);
      if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-13)) {
        return Status(Reason::kInvalidOption, "the landmarks contradict each other",
                      "leave at most three landmarks in a face");
      }
      w += pull * factor.solve(pin_values - pins * w);
    }
    Points3 result = points_;
    for (Eigen::Index i = 0; i < count; ++i) {
      result[moving_[i]] = chart_.lift({w(i, 0), w(i, 1)});
    }
    return result;
  }

 private:
  bool isNear(const Triangle& face) const {
    return row_[face[0]] != kNone || row_[face[1]] != kNone || row_[face[2]] != kNone;
  }

  /// The coefficient wanted of a face, plus what a flat face of the chart differs from one of the
  /// sphere.
  Complex coefficient(Index f) const {
    const auto& [a, b, c] = surface_.face(f);
    const Complex flat = FaceMap::between(problem_.field.frames()[f], images_[b] - images_[a],
                                          images_[c] - images_[a])
                             .beltrami();
    const Complex wanted = problem_.nu[f] + flat - problem_.mu[f];
    if (!std::isfinite(std::norm(wanted))) return 0;
    return wanted * std::min(1.0, kInside / std::max(std::abs(wanted), kInside));
  }

  /// Energy, and the load of the held vertices.
  void assemble() {
    std::vector<Eigen::Triplet<double>> entries;  // Rows: near vertices. Columns: moving ones.
    Eigen::MatrixXd held = Eigen::MatrixXd::Zero(near_count_, 2);
    Eigen::VectorXd area = Eigen::VectorXd::Zero(near_count_);
    for (Index f = 0; f < surface_.faceCount(); ++f) {
      const Triangle& face = surface_.face(f);
      if (near_[face[0]] == kNone && near_[face[1]] == kNone && near_[face[2]] == kNone) continue;
      const FaceFrame& frame = problem_.field.frames()[f];
      const std::array<double, 3> weights = bentWeights(frame, coefficient(f));
      for (int c = 0; c < 3; ++c) {
        if (near_[face[c]] != kNone) area[near_[face[c]]] += frame.area() / 3;
        addEdge(face[c], face[(c + 1) % 3], weights[c], entries, held);
        addEdge(face[(c + 1) % 3], face[c], weights[c], entries, held);
      }
    }
    const auto count = static_cast<Eigen::Index>(moving_.size());
    SparseMatrix laplace(near_count_, count);
    laplace.setFromTriplets(entries.begin(), entries.end());
    const double s2 = problem_.stiffness * problem_.stiffness;
    const SparseMatrix weighted = (s2 * area.cwiseInverse()).asDiagonal() * laplace;
    Eigen::MatrixXd direct(count, 2);
    std::vector<Eigen::Triplet<double>> restricted;
    for (Eigen::Index i = 0; i < count; ++i) {
      direct.row(i) = held.row(near_[moving_[i]]);
      restricted.emplace_back(near_[moving_[i]], static_cast<int>(i), 1.0);
    }
    SparseMatrix restriction(near_count_, count);
    restriction.setFromTriplets(restricted.begin(), restricted.end());
    const SparseMatrix full = SparseMatrix(restriction.transpose()) * laplace +
                              SparseMatrix(laplace.transpose()) * weighted;
    energy_ = full.triangularView<Eigen::Lower>();
    load_ = -direct - weighted.transpose() * held;
  }

  /// weight * (value(v) - value(other)) in the row of v.
  void addEdge(Index v, Index other, double weight, std::vector<Eigen::Triplet<double>>& entries,
               Eigen::MatrixXd& held) const {
    if (near_[v] == kNone) return;
    for (const auto& [end, sign] : {std::pair(v, 1.0), std::pair(other, -1.0)}) {
      if (row_[end] != kNone) {
        entries.emplace_back(near_[v], row_[end], sign * weight);
      } else {
        held(near_[v], 0) += sign * weight * images_[end].real();
        held(near_[v], 1) += sign * weight * images_[end].imag();
      }
    }
  }

  /// The pins in the moving part: a row each over the moving vertices, and the two values wanted.
  std::pair<Eigen::MatrixXd, Eigen::MatrixXd> pinRows() const {
    std::vector<const Pin*> here;
    for (const Pin& pin : problem_.pins) {
      for (int c = 0; c < 3; ++c) {
        const Index v = surface_.face(pin.point.face)[c];
        if (pin.point.barycentric[c] > 0 && row_[v] != kNone) {
          here.push_back(&pin);
          break;
        }
      }
    }
    const auto count = static_cast<Eigen::Index>(here.size());
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(moving_.size()));
    Eigen::MatrixXd values(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const SurfacePoint& point = here[i]->point;
      const Eigen::Vector3d now = spherePoint(surface_, points_, point);
      const bool mine = here[i]->target.dot(pole_) >= 0;
      // The image of a face in the chart is flat, on the sphere it is not: the combination of the
      // corners' images is aimed past the target by as much as it misses its point now.
      Complex value = chart_.project(mine ? here[i]->target : now) - chart_.project(now);
      for (int c = 0; c < 3; ++c) {
        const Index v = surface_.face(point.face)[c];
        const double weight = point.barycentric[c];
        if (weight == 0) continue;
        if (row_[v] != kNone) {
          rows(i, row_[v]) = weight;
          value += weight * images_[v];
        }
      }
      values(i, 0) = value.real();
      values(i, 1) = value.imag();
    }
    return {rows, values};
  }

  const ChartProblem& problem_;
  const Connectivity& surface_;
  Chart chart_;
  Eigen::Vector3d pole_;
  const Points3& points_;
  std::vector<Complex> images_;
  std::vector<Index> row_;     ///< Per vertex its unknown, kNone if it is held.
  std::vector<Index> near_;    ///< Per vertex its row, for moving ones and their neighbours.
  std::vector<Index> moving_;  ///< Per unknown its vertex.
  Index near_count_ = 0;
  SparseMatrix energy_;
  Eigen::MatrixXd load_;
};

}  // namespace

Result<Points3> relaxChart(Context& context, const ChartProblem& problem, Points3 points,
                           const Eigen::Vector3d& pole, double reach) {
  ChartSolve solve(problem, points, pole, reach);
  if (!solve.isSound()) return points;
  return solve.solve(context);
}

}  // namespace moduli::spherical
