#include "core/spherical/slit_map.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/forms/cotan.h"
#include "core/forms/harmonic.h"
#include "core/spherical/face_frame.h"
#include "core/topology/surface_topology.h"
#include "core/topology/symplectic_cohomology.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Loops = std::vector<std::vector<Index>>;
constexpr double kTurn = 2 * std::numbers::pi;

Status checkInput(const Connectivity& surface, const Loops& loops, const SlitMapOptions& options) {
  const SurfaceTopology topology = computeTopology(surface);
  if (topology.components != 1 || topology.genus != 0 || topology.boundary_loops.size() < 2) {
    return {Reason::kUnsupportedTopology,
            "a slit map needs one component of genus 0 with two boundary loops or more; this has " +
                std::to_string(topology.components) + " of genus " +
                std::to_string(topology.genus) + " with " +
                std::to_string(topology.boundary_loops.size())};
  }
  if (loops != topology.boundary_loops) {
    return {Reason::kInvalidOption, "the loops given are not those of the surface"};
  }
  const auto count = static_cast<Index>(loops.size());
  const auto known = [&](Index k) { return k >= 0 && k < count; };
  if (!known(options.outer) || !known(options.inner) || options.outer == options.inner) {
    return {Reason::kInvalidOption,
            "loops " + std::to_string(options.outer) + " and " + std::to_string(options.inner) +
                " cannot be the outer and the inner one of " + std::to_string(count)};
  }
  return {};
}

/// What log |w| is on each loop: 0 on the outer one, and such that the fluxes are right. reduced:
/// the flux matrix of loops 1, 2, ...; all fluxes of a function add up to 0.
Result<Eigen::VectorXd> loopValues(const Eigen::MatrixXd& reduced, const SlitMapOptions& options) {
  const Eigen::Index count = reduced.rows() + 1;
  const Eigen::LLT<Eigen::MatrixXd> factor(reduced);
  if (factor.info() != Eigen::Success) {
    return Status(Reason::kNotPositiveDefinite, "the flux matrix of the loops is not definite");
  }
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(count);
  flux[options.outer] = kTurn;
  flux[options.inner] = -kTurn;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(count);
  values.tail(count - 1) = factor.solve(flux.tail(count - 1));
  values.array() -= values[options.outer];
  return values;
}

/// gamma_outer - gamma_inner: period 1 around the outer loop, -1 around the inner one.
Cochain turningCochain(const BorderedCohomology& cohomology, const SlitMapOptions& options) {
  std::vector<CochainTerm> terms;
  if (options.outer > 0) terms = cohomology.loops[options.outer - 1];
  if (options.inner > 0) {
    for (const CochainTerm& term : cohomology.loops[options.inner - 1]) {
      terms.push_back({term.edge, -term.value});
    }
  }
  return gatherTerms(std::move(terms));
}

/// arg w in turns, along the halfedges.
class Turning {
 public:
  Turning(const Connectivity& surface, const BorderedForms& forms, const Cochain& cut,
          const SlitMapOptions& options)
      : surface_(surface),
        angle_(Eigen::VectorXd::Zero(surface.vertexCount())),
        jump_(surface.edgeCount(), 0.0) {
    if (options.outer > 0) angle_ += forms.tangential.potential.col(options.outer - 1);
    if (options.inner > 0) angle_ -= forms.tangential.potential.col(options.inner - 1);
    for (const CochainTerm& term : cut) jump_[term.edge] = static_cast<double>(term.value);
  }

  double at(Index v) const { return angle_[v]; }
  void startAt(Index v) { angle_.array() -= angle_[v]; }
  double along(Index h) const {
    return angle_[surface_.head(h)] - angle_[surface_.tail(h)] +
           surface_.sign(h) * jump_[surface_.edge(h)];
  }

 private:
  const Connectivity& surface_;
  Eigen::VectorXd angle_;
  std::vector<double> jump_;
};

/// The arc that a loop covers, and the turns it makes.
struct Covered {
  SlitArc arc;
  double turns = 0;
};

Covered coverLoop(const Connectivity& surface, const std::vector<Index>& loop,
                  const Turning& turning, double value, bool full) {
  double at = turning.at(surface.tail(loop[0]));
  double low = at;
  double high = at;
  Covered covered;
  for (const Index h : loop) {
    covered.turns += turning.along(h);
    low = std::min(low, at + covered.turns);
    high = std::max(high, at + covered.turns);
  }
  const double begin = full ? 0 : low - std::round(low);
  covered.arc = {std::exp(value), kTurn * begin, full ? kTurn : kTurn * (high - low)};
  return covered;
}

/// Derivatives of log w in each face, against the metric.
void measureFaces(const Connectivity& surface, const std::vector<double>& lengths,
                  const Eigen::VectorXd& height, const Turning& turning, SlitQuality& quality) {
  const std::vector<double> areas = faceAreas(surface, lengths);
  double holomorphic = 0;
  double antiholomorphic = 0;
  double weight = 0;
  double sum = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Index h = 3 * f;
    const FaceFrame frame = frameFromSides(lengths[surface.edge(h)], lengths[surface.edge(h + 1)],
                                           lengths[surface.edge(h + 2)], areas[f]);
    const Triangle& corner = surface.face(f);
    const Complex first(height[corner[1]] - height[corner[0]], kTurn * turning.along(h));
    const Complex second(height[corner[2]] - height[corner[0]], -kTurn * turning.along(h + 2));
    const Complex by_x = first / frame.base;
    const Complex by_y = (second - frame.x * by_x) / frame.y;
    const double forward = std::abs(by_x - Complex(0, 1) * by_y) / 2;
    const double backward = std::abs(by_x + Complex(0, 1) * by_y) / 2;
    holomorphic += areas[f] * forward * forward;
    antiholomorphic += areas[f] * backward * backward;
    if (!(backward < forward)) {
      ++quality.flipped_faces;
      continue;
    }
    weight += areas[f];
    sum += areas[f] * (forward + backward) / (forward - backward);
  }
  // Energies sum to 2 (|f_z|^2 + |f_zbar|^2), the area to |f_z|^2 - |f_zbar|^2.
  quality.energy_defect = 2 * antiholomorphic / (holomorphic + antiholomorphic);
  if (weight > 0) quality.mean_dilatation = sum / weight;
}

}  // namespace

Result<SlitMap> computeSlitMap(Context& context, const Connectivity& surface,
                               const std::vector<double>& given_lengths, const Loops& loops,
                               const SlitMapOptions& options) {
  RETURN_IF_ERROR(checkInput(surface, loops, options));
  ASSIGN_OR_RETURN(const BorderedCohomology cohomology, borderedCohomology(surface, loops));
  const std::vector<double> lengths = unitLengths(given_lengths);
  ASSIGN_OR_RETURN(
      const BorderedForms forms,
      borderedHarmonicForms(context, surface, cotanWeights(surface, lengths), cohomology, loops));
  const Context::Stage stage(context, "slits");
  ASSIGN_OR_RETURN(const Eigen::VectorXd values,
                   loopValues(energyForm(surface, lengths, forms.normal).energy, options));
  const auto others = static_cast<Eigen::Index>(loops.size()) - 1;
  Eigen::VectorXd height =
      forms.normal.potential * (values.tail(others).array() - values[0]).matrix();
  height.array() += values[0];
  for (std::size_t k = 0; k < loops.size(); ++k) {
    for (const Index h : loops[k]) height[surface.tail(h)] = values[static_cast<Eigen::Index>(k)];
  }

  SlitMap result;
  result.cut = turningCochain(cohomology, options);
  Turning turning(surface, forms, result.cut, options);
  turning.startAt(surface.tail(loops[options.outer][0]));
  for (Index v = 0; v < surface.vertexCount(); ++v) {
    result.logarithm.emplace_back(height[v], kTurn * turning.at(v));
    result.points.push_back(std::exp(result.logarithm.back()));
  }
  for (Index k = 0; k < static_cast<Index>(loops.size()); ++k) {
    const bool full = k == options.outer || k == options.inner;
    const Covered covered = coverLoop(surface, loops[k], turning, values[k], full);
    result.arcs.push_back(covered.arc);
    const double expected = !full ? 0 : k == options.outer ? 1 : -1;
    result.quality.period_defect =
        std::max(result.quality.period_defect, kTurn * std::abs(covered.turns - expected));
  }
  measureFaces(surface, lengths, height, turning, result.quality);
  result.quality.solver_residual = forms.solver_residual;
  return result;
}

}  // namespace moduli
