#pragma once

#include <array>
#include <vector>

#include "client/cpp/array_pieces.h"
#include "core/base/status.h"
#include "moduli/v1/optimize.pb.h"

namespace moduli {

/// A step of a minimization; the first one is the start.
struct MinimizedStep {
  int iteration = 0;
  double value = 0;
  double gradient_norm = 0;  ///< Euclidean.
  double step = 0;           ///< t of x - t d that led here; 0 at the start.
  double decrease = 0;       ///< Gradient times d; 0 at the start.
  int evaluations = 0;       ///< So far, as the next.
  int factorizations = 0;
};

/// A minimization. trace and path are empty where the request did not want them.
struct MinimizedFunction {
  v1::Minimization result;  ///< With all of x, however many unknowns there are.
  std::vector<MinimizedStep> trace;
  std::vector<std::array<double, 2>> path;  ///< The point of each step.
};

/// Puts the arrays of a minimization together from their chunks, and judges them. Not thread-safe.
class MinimizeAssembler {
 public:
  explicit MinimizeAssembler(const v1::MinimizeRequest& request);

  /// As ArrayPieces::take.
  Status take(const v1::ArrayChunk& chunk) { return pieces_.take(chunk); }

  /// All of it, with its result. Fails with kInternal where an array is missing or incomplete,
  /// where two do not fit each other, on counts that are none, and without a point.
  Result<MinimizedFunction> finish(v1::Minimization result);
  Result<v1::AffineDirection> finish(v1::AffineDirection result);

 private:
  const bool trace_, path_;
  ArrayPieces pieces_;
};

}  // namespace moduli
