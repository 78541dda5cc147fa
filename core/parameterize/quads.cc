#include "core/parameterize/quads.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/forms/holomorphic.h"
#include "core/forms/lattice_reduction.h"
#include "core/forms/period_matrix.h"
#include "core/intrinsic/mollify.h"
#include "core/parameterize/layout.h"
#include "core/parameterize/overlaps.h"
#include "core/parameterize/seams.h"
#include "core/parameterize/torus_lattice.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Beyond it the imaginary part has little to do with the real one.
constexpr double kLargestMisfit = 0.5;

/// Classes of the real and the imaginary part, in the basis alpha_1 .. beta_g.
struct WholeClasses {
  Eigen::VectorXd u, v;
  double squares = 0;  ///< Area of the image, a whole number.
  double misfit = 0;   ///< As QuadDomain::misfit.
};

Eigen::MatrixXd intersectionForm(Eigen::Index g) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(2 * g, 2 * g);
  j.topRightCorner(g, g).setIdentity();
  j.bottomLeftCorner(g, g) = -Eigen::MatrixXd::Identity(g, g);
  return j;
}

/// The choice of classes for a surface's forms.
class ClassSearch {
 public:
  ClassSearch(const ClosedPeriods& closed, double most_squares)
      : energy_(closed.periods.energy),
        form_energy_(closed.energy),
        intersection_(intersectionForm(energy_.rows() / 2)),
        // *h_a has the coefficients of row a of E J.
        star_((energy_ * intersection_).transpose()),
        most_squares_(most_squares) {}

  std::optional<WholeClasses> run() {
    const Eigen::Index n = energy_.rows();
    for (double weight = 1; weight <= 16 * most_squares_ * most_squares_; weight *= 4) {
      Eigen::MatrixXd gram(2 * n, 2 * n);
      gram.topLeftCorner(n, n) = energy_ + weight * star_.transpose() * energy_ * star_;
      gram.topRightCorner(n, n) = -weight * star_.transpose() * energy_;
      gram.bottomLeftCorner(n, n) = gram.topRightCorner(n, n).transpose();
      gram.bottomRightCorner(n, n) = weight * energy_;
      gram = ((gram + gram.transpose()) / 2).eval();
      const Result<ReducedLattice> lattice = reduceLattice(gram);
      // Weights beyond what doubles hold add nothing.
      if (!lattice.ok()) break;
      tryPairs(lattice->transform.cast<double>());
    }
    return std::move(best_);
  }

 private:
  /// The rows of a short basis, their sums and differences.
  void tryPairs(const Eigen::MatrixXd& rows) {
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      consider(rows.row(i));
      for (Eigen::Index k = 0; k < i; ++k) {
        consider(rows.row(i) + rows.row(k));
        consider(rows.row(i) - rows.row(k));
      }
    }
  }

  /// Takes the pair that is nearest to a holomorphic form; of nearly equal ones that of fewer
  /// squares.
  void consider(const Eigen::RowVectorXd& pair) {
    constexpr double kEqual = 1e-7;
    const Eigen::Index n = energy_.rows();
    const Eigen::VectorXd u = pair.head(n).transpose(), v = pair.tail(n).transpose();
    const double area = std::round(u.dot(intersection_ * v));
    if (!(area >= 1) || area > most_squares_) return;
    const double energy = (u.dot(form_energy_ * u) + v.dot(form_energy_ * v)) / 2;
    const double misfit = std::sqrt(std::max(0.0, 2 * (energy / area - 1)));
    const bool better = !best_ || misfit < best_->misfit - kEqual ||
                        (misfit < best_->misfit + kEqual && area < best_->squares);
    if (better) best_ = WholeClasses{u, v, area, misfit};
  }

  const Eigen::MatrixXd &energy_, &form_energy_;
  Eigen::MatrixXd intersection_, star_;
  double most_squares_;
  std::optional<WholeClasses> best_;
};

Status checkSurface(const SurfaceTopology& topology) {
  if (topology.components == 1 && topology.boundary_loops.empty() && topology.genus >= 1) return {};
  return {Reason::kUnsupportedTopology,
          topology.genus == 0
              ? "a surface of genus 0 has no holomorphic forms, and no squares from "
                "their periods"
              : "forms with whole periods are those of a closed connected surface",
          topology.genus == 0 ? "--to polycube makes squares of it" : "--fill-holes closes it"};
}

class QuadLayout {
 public:
  QuadLayout(const Connectivity& surface, const ClosedPeriods& closed, const WholeClasses& classes)
      : surface_(surface), closed_(closed), classes_(classes) {}

  Result<Parameterization> run(const std::vector<double>& lengths, bool cut_overlaps) {
    findForm();
    const std::vector<bool> seam = chooseSeams(surface_, seamCosts(surface_, lengths), {}, {});
    const auto lift = liftFaces(surface_, form_.shift, seam);
    if (!lift) return Status(Reason::kInternal, "a surface cut along its cut graph is no disk");
    std::vector<Complex> placed(surface_.halfedgeCount());
    LatticeVector shift;
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      shift = h % 3 == 0 ? (*lift)[Connectivity::faceOf(h)] : shift + form_.shift[h - 1];
      placed[h] = form_.place[surface_.tail(h)] + form_.at(shift);
    }
    PlanarLayout layout = sewCorners(surface_, seam, placed);
    Parameterization result;
    result.points = std::move(layout.points);
    result.corner = std::move(layout.corner);
    result.certificate.islands =
        cut_overlaps ? cutOverlaps(surface_, result.points, result.corner, kIslandMargin, 1) : 1;
    result.certificate.holonomy_residual = periodResidual(result);
    QuadDomain& quads = result.quads.emplace();
    quads.zeros = zerosOfForm(surface_, realParts());
    quads.squares = classes_.squares;
    quads.misfit = classes_.misfit;
    for (Eigen::Index k = 0; k < classes_.u.size(); ++k) {
      quads.periods.emplace_back(classes_.u[k], classes_.v[k]);
    }
    return result;
  }

 private:
  /// a + i b: differences of values at the vertices, and whole jumps across a seam.
  void findForm() {
    const FormBasis& forms = closed_.harmonic;
    form_.generators = {1.0, Complex(0, 1)};
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      form_.place.emplace_back(forms.potential.row(v).dot(classes_.u),
                               forms.potential.row(v).dot(classes_.v));
    }
    form_.shift.resize(surface_.halfedgeCount());
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      const Index row = forms.seam[surface_.edge(h)];
      if (row == kNone) continue;
      const int sign = surface_.sign(h);
      form_.shift[h] = {sign * static_cast<int>(std::lround(forms.jumps.row(row).dot(classes_.u))),
                        sign * static_cast<int>(std::lround(forms.jumps.row(row).dot(classes_.v)))};
    }
  }

  std::vector<double> realParts() const {
    std::vector<double> values;
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      values.push_back(form_.along(surface_, surface_.halfedge(e)).real());
    }
    return values;
  }

  /// The largest distance of a translation between two sides of a cut from a Gaussian integer.
  double periodResidual(const Parameterization& map) const {
    double largest = 0;
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      const Index twin = surface_.twin(h);
      for (const auto& [a, b] :
           {std::array{h, Connectivity::next(twin)}, std::array{Connectivity::next(h), twin}}) {
        const Complex jump = map.points[map.corner[a]] - map.points[map.corner[b]];
        largest = std::max({largest, std::abs(jump.real() - std::round(jump.real())),
                            std::abs(jump.imag() - std::round(jump.imag()))});
      }
    }
    return largest;
  }

  const Connectivity& surface_;
  const ClosedPeriods& closed_;
  const WholeClasses& classes_;
  TorusLattice form_;
};

}  // namespace

Result<Parameterization> parameterizeQuads(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const QuadOptions& options) {
  RETURN_IF_ERROR(checkSurface(computeTopology(surface)));
  if (!(options.most_squares >= 1)) {
    return Status(Reason::kInvalidOption, "a layout of squares takes one square at least");
  }
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, lengths));
  ASSIGN_OR_RETURN(const ClosedPeriods closed, computePeriods(context, surface, mollified.lengths));
  const std::optional<WholeClasses> classes = ClassSearch(closed, options.most_squares).run();
  if (!classes || !(classes->misfit <= kLargestMisfit)) {
    return Status(Reason::kInvalidOption,
                  "no form with whole periods is nearly holomorphic and covers as few as " +
                      shortestDouble(options.most_squares) + " squares",
                  "allow more squares");
  }
  const Context::Stage stage(context, "layout");
  ASSIGN_OR_RETURN(
      Parameterization result,
      QuadLayout(surface, closed, *classes).run(mollified.lengths, options.cut_overlaps));
  result.certificate.quality =
      measurePlaneMap(surface, mollified.lengths, result.points, result.corner);
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

}  // namespace moduli
