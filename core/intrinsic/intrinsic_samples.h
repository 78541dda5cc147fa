#pragma once

#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/intrinsic/intrinsic_surface.h"
#include "core/mesh/samples.h"

namespace moduli {

/// The kinds that makeIntrinsicSample knows; none has parameters.
const std::vector<SampleKind>& intrinsicSampleKinds();

/// A hyperbolic surface with as many symmetries as its genus allows, or nearly, made of equilateral
/// triangles, the same number k around each vertex: their edges have cosh(l / 2) = 1 / (2 sin(pi /
/// k)).
///
///   bolza   genus 2, 16 triangles, k = 8: Bolza's surface y^2 = x^5 - x, automorphisms GL(2, 3)
///   klein   genus 3, 56 triangles, k = 7: Klein's quartic, automorphisms PSL(2, 7)
///
/// Fails with kInvalidOption for other kinds.
Result<IntrinsicSurface> makeIntrinsicSample(const std::string& kind);

}  // namespace moduli
