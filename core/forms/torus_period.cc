#include "core/forms/torus_period.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/forms/holomorphic.h"
#include "core/forms/period_matrix.h"

namespace moduli {
namespace {

Status checkGenus(const Connectivity& surface) {
  // Also of a surface with boundary; that one is refused by name further on.
  const Index twice = 2 - surface.eulerCharacteristic();
  if (twice == 2) return {};
  return {Reason::kUnsupportedTopology, "the surface has Euler characteristic " +
                                            std::to_string(2 - twice) + " (genus " +
                                            std::to_string(twice / 2) + " if closed) instead of 0"};
}

Complex alongHalfedge(const Connectivity& surface, const std::vector<Complex>& zeta, Index h) {
  return static_cast<double>(surface.sign(h)) * zeta[surface.edge(h)];
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
  RETURN_IF_ERROR(checkGenus(surface));
  ASSIGN_OR_RETURN(const ClosedPeriods closed, computePeriods(context, surface, lengths));
  TorusPeriod period;
  const HolomorphicForms zeta = holomorphicForms(closed);
  period.holomorphic.resize(surface.edgeCount());
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    period.holomorphic[e] = zeta.along(surface, surface.halfedge(e), 0);
  }
  period.tau = closed.periods.period(0, 0);
  period.tau_error = closed.periods.error;
  period.energy = closed.periods.energy;
  period.spread = closed.periods.spread;
  period.riemann_residual = closed.periods.riemann_residual;
  period.determinant_gap = std::max(0.0, closed.energy.determinant() - 1);
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
