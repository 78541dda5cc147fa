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
#include "core/parameterize/torus_lattice.h"
#include "core/topology/cut_graph.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;

/// Beyond it the imaginary part has little to do with the real one.
constexpr double kLargestMisfit = 0.5;

/// Classes of the real and the imaginary part, in the basis alpha_1 .. beta_g.
struct WholeClasses {
  Eigen::VectorXd u, v;
  double squares = 0;  ///< Area of the image, for the conjugate of u.
  double misfit = 0;   ///< |v - *u| / |u| in the norm of the energy.
};

/// The star of closed forms: the column of a class to that of its conjugate. *h_a has the
/// coefficients of row a of E J.
Eigen::MatrixXd starOfClasses(const Eigen::MatrixXd& energy) {
  const Eigen::Index g = energy.rows() / 2;
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(2 * g, 2 * g);
  j.topRightCorner(g, g).setIdentity();
  j.bottomLeftCorner(g, g) = -Eigen::MatrixXd::Identity(g, g);
  return (energy * j).transpose();
}

WholeClasses judged(Eigen::VectorXd u, Eigen::VectorXd v, const Eigen::MatrixXd& energy,
                    const Eigen::MatrixXd& star) {
  const Eigen::VectorXd miss = v - star * u;
  const double squares = u.dot(energy * u);
  const double misfit = std::sqrt(std::max(0.0, miss.dot(energy * miss) / squares));
  return {std::move(u), std::move(v), squares, misfit};
}

/// The pair of least misfit within most_squares; of nearly equal ones that of fewer squares.
Result<std::optional<WholeClasses>> chooseClasses(Context& context, const Eigen::MatrixXd& energy,
                                                  double most_squares) {
  constexpr double kEqual = 1e-9;
  const Eigen::Index n = energy.rows();
  const Eigen::MatrixXd star = starOfClasses(energy);
  std::optional<WholeClasses> best;
  for (double weight = 1; weight <= most_squares * most_squares * 16; weight *= 4) {
    RETURN_IF_ERROR(context.check());
    Eigen::MatrixXd gram(2 * n, 2 * n);
    gram.topLeftCorner(n, n) = energy + weight * star.transpose() * energy * star;
    gram.topRightCorner(n, n) = -weight * star.transpose() * energy;
    gram.bottomLeftCorner(n, n) = gram.topRightCorner(n, n).transpose();
    gram.bottomRightCorner(n, n) = weight * energy;
    gram = ((gram + gram.transpose()) / 2).eval();
    const Result<ReducedLattice> lattice = reduceLattice(gram);
    // Weights beyond what doubles hold add nothing.
    if (!lattice.ok()) break;
    const Eigen::MatrixXd rows = lattice->transform.cast<double>();
    for (Eigen::Index i = 0; i < 2 * n; ++i) {
      if (rows.row(i).head(n).isZero()) continue;
      WholeClasses found =
          judged(rows.row(i).head(n).transpose(), rows.row(i).tail(n).transpose(), energy, star);
      if (found.squares > most_squares) continue;
      const bool better = !best || found.misfit < best->misfit - kEqual ||
                          (found.misfit < best->misfit + kEqual && found.squares < best->squares);
      if (better) best = std::move(found);
    }
  }
  return best;
}

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

  Result<Parameterization> run() {
    findForm();
    ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface_));
    std::vector<bool> seam(surface_.edgeCount(), false);
    for (const Index e : cutGraph(surface_, trees)) seam[e] = true;
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
  ASSIGN_OR_RETURN(const std::optional<WholeClasses> classes,
                   chooseClasses(context, closed.periods.energy, options.most_squares));
  if (!classes || !(classes->misfit <= kLargestMisfit)) {
    return Status(Reason::kInvalidOption,
                  "no form with whole periods is nearly holomorphic and covers as few as " +
                      shortestDouble(options.most_squares) + " squares",
                  "allow more squares");
  }
  const Context::Stage stage(context, "layout");
  ASSIGN_OR_RETURN(Parameterization result, QuadLayout(surface, closed, *classes).run());
  result.certificate.quality =
      measurePlaneMap(surface, mollified.lengths, result.points, result.corner);
  result.certificate.mollification = mollified.relative_shift;
  return result;
}

}  // namespace moduli
