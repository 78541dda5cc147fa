#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/context.h"
#include "moduli/v1/optimize.pb.h"
#include "server/service/backend.h"

/// From a request for a minimization to what is sent back.
namespace moduli {

/// What a request comes to: a minimization, or the affine normal at its point.
struct Optimized {
  v1::Minimization minimization;
  std::optional<v1::AffineDirection> direction;
  std::vector<double> entries;  ///< Of the point or direction, where they are too many for it.
  std::vector<std::array<double, 7>> trace;
  std::vector<std::array<double, 2>> path;
};

/// Makes the function of a checked request, loads its surface, and minimizes it or finds the affine
/// normal. A search that does not converge is a result. Fails as makeObjective, loadSubject,
/// UniformizationEnergy::make, minimize and affineNormal do.
Result<Optimized> optimizeFunction(Context& context, const Backend& backend,
                                   const v1::MinimizeRequest& request);

/// The messages that carry it, one a call, nothing after the last: arrays in chunks of at most
/// kMaxChunkBytes, then the result.
std::function<std::optional<v1::MinimizeResponse>()> optimizationParts(
    std::shared_ptr<const Optimized> optimized);

}  // namespace moduli
