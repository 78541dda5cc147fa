#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/forms/bordered_period.h"
#include "core/forms/energy_lattice.h"
#include "core/forms/period_matrix.h"
#include "core/mesh/samples.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

/// What the tests of periods share.
namespace moduli {

inline Result<ClosedPeriods> closedPeriodsOf(const MetricSurface& mesh) {
  Context context;
  return computePeriods(context, mesh.surface, mesh.lengths);
}

inline Result<BorderedPeriods> borderedPeriodsOf(const MetricSurface& mesh) {
  Context context;
  return computeBorderedPeriods(context, mesh.surface, mesh.lengths);
}

/// The smallest energies of primitive classes; empty, and the test failed, if there are none.
inline std::vector<double> spectrum(const Eigen::MatrixXd& energy, std::size_t count = 32) {
  Context context;
  auto energies = shortestEnergies(context, energy, count);
  EXPECT_OK(energies);
  return energies.ok() ? *energies : std::vector<double>();
}

inline MetricSurface sampleSurface(const std::string& kind,
                                   const std::map<std::string, double>& values) {
  const auto soup = makeSample(kind, values);
  EXPECT_OK(soup);
  return fromPositions(soup->vertices, soup->faces);
}

}  // namespace moduli
