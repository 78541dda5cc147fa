#pragma once

#include <optional>
#include <vector>

#include "core/signature/signature.h"

/// The vectors whose Euclidean distance is the distance of two signatures.
///
/// The amplitude of a field f at frequency l is the norm of its part f_l there. As
/// | |f_l| - |g_l| | <= |f_l - g_l|, and the parts are orthogonal, the amplitude vectors of f and g
/// are no farther apart than f and g are in the mean square on the canonical domain, however f and
/// g are turned against each other: amplitudes are 1-Lipschitz, which powers are not.
namespace moduli {

/// Metric space: amplitudes of the log conformal factor, one per frequency.
std::vector<double> metricAmplitudes(const MetricBlock& metric);

/// Shape space: amplitudes of k, of (lambda + k) / 2 and of (lambda - k) / 2, one after the other,
/// where lambda is the log conformal factor and k_l = 2 h_l / (l (l + 1)) the mean curvature made
/// comparable with it: for a round sphere moved by a small f along its normals, lambda is f_l and h
/// is (l - 1)(l + 2) f_l / 2 to first order, so that k is a displacement too, and the noise of the
/// curvature at the scale of the mesh weighs no more than the displacement that makes it. The sums
/// and differences carry the cross spectrum. 1-Lipschitz in lambda / sqrt(2) and sqrt(3 / 2) k.
std::vector<double> shapeAmplitudes(const MetricBlock& metric, const ShapeBlock& shape);

/// Of a signature: from its blocks in double precision, or, where only one space was computed and
/// its blocks do not suffice, from the stored vector. Empty if the space is not there.
std::optional<std::vector<double>> amplitudes(const Signature& signature, Space space);

}  // namespace moduli
