#include "core/optimize/slice_centroid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/optimize/affine_normal.h"
#include "tests/core/optimize/functions.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

TEST(SliceCentroid, TendsToTheAffineNormalAtFirstOrder) {
  for (const Eigen::Index n : {2, 3, 4}) {
    const NamedObjective f = named("exp-sum", n);
    const Eigen::VectorXd x = 0.5 * f.start;
    Context context;
    const auto normal = affineNormal(context, *f.objective, x);
    ASSERT_OK(normal);
    const Eigen::VectorXd d =
        normal->direction * (f.objective->gradient().norm() / normal->decrease);
    std::vector<double> errors;
    for (const double depth : {1e-1, 1e-2, 1e-3, 1e-4}) {
      const auto slice = sliceCentroid(context, *f.objective, x, depth);
      ASSERT_OK(slice);
      errors.push_back((*slice - d).norm());
    }
    for (std::size_t k = 1; k < errors.size(); ++k) {
      // First order: ratio 10 but for the second order term, of about the depth itself times 10,
      // and for the rounding of r, 1e-13, over the depth: 1e-9 of 1e-5.
      const double depth = std::pow(10.0, -static_cast<double>(k));
      EXPECT_NEAR(errors[k - 1] / errors[k], 10, 10 * 3 * depth) << n << " unknowns, row " << k;
    }
  }
}

TEST(SliceCentroid, RefusesWhatItCannotSlice) {
  const NamedObjective f = named("exp-sum", 5);
  NamedObjective g = named("exp-sum", 3);
  Context context;
  EXPECT_THAT(sliceCentroid(context, *f.objective, f.start, 0.1),
              FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(sliceCentroid(context, *g.objective, g.start, 0), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(sliceCentroid(context, *g.objective, g.start, 1e3),
              FailsWith(Reason::kNoConvergence));
}

}  // namespace
}  // namespace moduli
