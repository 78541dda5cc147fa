#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/status.h"

namespace moduli {

struct PrecisionRecallCurve {
  std::string name;               ///< UTF-8 without control characters.
  std::vector<double> precision;  ///< At recall j / (n - 1), within [0, 1]: Evaluation::precision.
};

struct PrecisionRecallOptions {
  int width = 640;   ///< Pixels, at least 320.
  int height = 440;  ///< At least 240, and enough for the legend: 20 a curve and 90 more.
  std::string title = "Precision and recall";
};

/// The curves of several descriptors in one picture, as an SVG file: recall to the right, precision
/// up, both from 0 to 1, a legend on the right that names curves in the order given. Colours can be
/// told apart by colour-blind readers, and marks tell curves apart without colour.
/// Fails with kInvalidOption (sizes, no curves, fewer than 2 points, values out of range, names
/// that cannot be printed). O(points).
Result<std::string> drawPrecisionRecall(std::span<const PrecisionRecallCurve> curves,
                                        const PrecisionRecallOptions& options = {});

}  // namespace moduli
