#include "core/forms/torus_period.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/forms/flat_triangle.h"
#include "core/forms/harmonic.h"
#include "core/topology/tree_cotree.h"

namespace moduli {
namespace {

using CochainPair = std::vector<std::vector<int>>;

/// A basis (alpha, beta) of the integer classes with intersection number +1.
Result<CochainPair> symplecticCochains(const Connectivity& surface) {
  ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface));
  if (trees.leftover.size() != 2) {
    return Status{
        Reason::kUnsupportedTopology,
        "the surface has genus " + std::to_string(trees.leftover.size() / 2) + " instead of 1"};
  }
  CochainPair basis = cohomologyBasis(surface, trees);
  if (intersectionNumber(surface, basis[0], basis[1]) < 0) std::swap(basis[0], basis[1]);
  return basis;
}

double determinant(const Eigen::MatrixXd& energy) {
  return energy(0, 0) * energy(1, 1) - energy(0, 1) * energy(0, 1);
}

/// The symplectic projection of the energy of a basis, read as a point of the upper half plane.
Result<Complex> projectedTau(const Eigen::MatrixXd& energy) {
  const double square = determinant(energy);
  if (!(square > 0) || !std::isfinite(square)) {
    return Status{Reason::kResidualTooLarge,
                  "rounding has drowned the energy of the harmonic forms: its determinant is not "
                  "positive",
                  "the triangles or the torus are too thin for double precision"};
  }
  return Complex(-energy(0, 1), std::sqrt(square)) / energy(1, 1);
}

struct ReducedBasis {
  std::vector<ClosedForm> forms;  ///< alpha, beta.
  EnergyForm energy;
  Complex tau;
};

/// Changes to the basis whose tau is reduced. The energy is computed anew in each basis: in the
/// reduced one its determinant does not cancel, |tau|^2 / (Im tau)^2 being at most 4/3.
Result<ReducedBasis> reduceBasis(const Connectivity& surface, const std::vector<double>& lengths,
                                 std::vector<ClosedForm> forms) {
  // The second round finds nothing to do, unless rounding spoiled the first of a very long basis.
  constexpr int kRounds = 5;
  ReducedBasis basis{std::move(forms), {}, {}};
  for (int round = 0; round < kRounds; ++round) {
    basis.energy = energyForm(surface, lengths, basis.forms);
    ASSIGN_OR_RETURN(const Complex tau, projectedTau(basis.energy.energy));
    ASSIGN_OR_RETURN(const ReducedTau reduced, reduceToFundamentalDomain(tau));
    basis.tau = reduced.tau;
    const auto [a, b, c, d] = reduced.transform;
    if (b == 0 && c == 0) return basis;
    // zeta = alpha + tau beta, divided by c tau + d, is alpha' + tau' beta'.
    ClosedForm alpha =
        combine(static_cast<double>(a), basis.forms[0], -static_cast<double>(b), basis.forms[1]);
    ClosedForm beta =
        combine(-static_cast<double>(c), basis.forms[0], static_cast<double>(d), basis.forms[1]);
    basis.forms = {std::move(alpha), std::move(beta)};
  }
  return Status{Reason::kNoConvergence, "the basis of the torus cannot be reduced",
                "the torus is too thin for double precision"};
}

/// Bound of |tau - exact| from the energy form of a reduced basis.
///
/// The energies E of the classes under the metric satisfy E_h / d <= E <= E_h with d = det E_h, so
/// the eigenvalues of E_h^-1 E lie in [1/d, 1] and their product is 1/d: as points of the upper
/// half plane, E and E_h / sqrt(d) are at most log(d) / 2 apart. Rounding moves the energy by a
/// factor within 1 +- 4 r, for the matrix has correlation at most 1/2 in a reduced basis, hence the
/// point by 4 r and d by a factor within 1 +- 8 r. A disk of hyperbolic radius rho reaches
/// Im(tau) (e^rho - 1) far.
double certifiedError(const EnergyForm& form, Complex tau) {
  const double gap = std::max(0.0, determinant(form.energy) - 1) + 8 * form.rounding;
  const double radius = std::log1p(gap) / 2 + 4 * form.rounding;
  return tau.imag() * std::expm1(radius);
}

std::vector<Complex> holomorphicForm(const Connectivity& surface,
                                     const std::vector<ClosedForm>& forms, Complex tau) {
  std::vector<Complex> zeta(surface.edgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    zeta[e] = forms[0].onEdge(surface, e) + tau * forms[1].onEdge(surface, e);
  }
  return zeta;
}

Complex alongHalfedge(const Connectivity& surface, const std::vector<Complex>& zeta, Index h) {
  return static_cast<double>(surface.sign(h)) * zeta[surface.edge(h)];
}

/// Half the squared norm of a complex form.
double halfEnergy(const Connectivity& surface, const std::vector<double>& lengths,
                  const std::vector<Complex>& zeta) {
  double sum = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    std::array<double, 3> sides{};
    std::array<double, 3> real{};
    std::array<double, 3> imaginary{};
    for (Index c = 0; c < 3; ++c) {
      const Complex value = alongHalfedge(surface, zeta, 3 * f + c);
      sides[c] = lengths[surface.edge(3 * f + c)];
      real[c] = value.real();
      imaginary[c] = value.imag();
    }
    const TriangleFrame frame(sides);
    sum += frame.area() *
           (frame.gradient(real).squaredNorm() + frame.gradient(imaginary).squaredNorm());
  }
  return sum / 2;
}

double closureResidual(const Connectivity& surface, const std::vector<Complex>& zeta) {
  double worst = 0;
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    worst = std::max(
        worst, std::abs(alongHalfedge(surface, zeta, h) + alongHalfedge(surface, zeta, h + 1) +
                        alongHalfedge(surface, zeta, h + 2)));
  }
  double sum = 0;
  for (const Complex value : zeta) sum += std::abs(value);
  return worst / (sum / static_cast<double>(zeta.size()));
}

}  // namespace

Result<TorusPeriod> computeTorusPeriod(Context& context, const Connectivity& surface,
                                       const std::vector<double>& lengths) {
  ASSIGN_OR_RETURN(const CochainPair cochains, [&] {
    const Context::Stage stage(context, "cohomology");
    return symplecticCochains(surface);
  }());
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(HarmonicForms harmonic,
                   harmonicForms(context, surface, cotanWeights(surface, lengths), cochains));

  const Context::Stage stage(context, "period");
  ASSIGN_OR_RETURN(const ReducedBasis basis,
                   reduceBasis(surface, lengths, std::move(harmonic.forms)));
  TorusPeriod period;
  period.tau = basis.tau;
  period.tau_error = certifiedError(basis.energy, basis.tau);
  period.energy = basis.energy.energy;
  period.determinant_gap = std::max(0.0, determinant(period.energy) - 1);
  period.holomorphic = holomorphicForm(surface, basis.forms, basis.tau);
  period.riemann_residual =
      std::abs(halfEnergy(surface, lengths, period.holomorphic) / basis.tau.imag() - 1);
  period.closure_residual = closureResidual(surface, period.holomorphic);
  return period;
}

std::vector<Complex> layOutTorus(const Connectivity& surface, const TorusPeriod& period) {
  std::vector<Complex> corner(surface.halfedgeCount());
  std::vector<bool> placed(surface.faceCount(), false);
  const auto place = [&](Index h, Complex start) {
    const Index second = Connectivity::next(h);
    corner[h] = start;
    corner[second] = start + alongHalfedge(surface, period.holomorphic, h);
    corner[Connectivity::next(second)] =
        corner[second] + alongHalfedge(surface, period.holomorphic, second);
    placed[Connectivity::faceOf(h)] = true;
  };
  std::vector<Index> queue{0};
  queue.reserve(surface.faceCount());
  place(0, 0);
  for (std::size_t at = 0; at < queue.size(); ++at) {
    for (Index h = 3 * queue[at]; h < 3 * queue[at] + 3; ++h) {
      const Index twin = surface.twin(h);
      if (twin == kNone || placed[Connectivity::faceOf(twin)]) continue;
      place(twin, corner[Connectivity::next(h)]);
      queue.push_back(Connectivity::faceOf(twin));
    }
  }
  return corner;
}

}  // namespace moduli
