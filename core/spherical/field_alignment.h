#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/context.h"
#include "core/spherical/sphere_locator.h"

/// The rotation between two spheres under which two fields on them are most alike.
namespace moduli {

/// A function on the sphere, linear in each face. Refers to its parts.
struct SphereField {
  const SphereLocator& sphere;
  const std::vector<double>& values;  ///< Per vertex, finite.
};

struct FieldSearchOptions {
  int rotations = 32768;  ///< Of the grid over all rotations; 32768 lie some 0.13 radians apart.
  int samples = 2000;     ///< Vertices of the first sphere that the search looks at.
  int candidates = 12;    ///< Rotations of the grid, 0.25 radians apart or more, that are refined.
};

struct FieldAlignment {
  Eigen::Matrix3d rotation;  ///< A point p of the first sphere corresponds to rotation * p.
  double correlation = 0;    ///< Of the two fields at the vertices of the first, then.
};

/// Correlation coefficient, weighted, of a field at its vertices with another at the rotated
/// places. weights: per vertex of a, >= 0, not all 0. 0 where either is constant. O(V log V).
double fieldCorrelation(const SphereField& a, const std::vector<double>& weights,
                        const SphereField& b, const Eigen::Matrix3d& rotation);

/// Maximizes fieldCorrelation over all rotations: first over an even grid (super-Fibonacci) with
/// the second field in a raster, then by Gauss and Newton's method on the sampled vertices from the
/// best of the grid, then on all vertices from the best of those. Features narrower than half the
/// grid's spacing, 4 degrees, may escape the search.
/// Fails with kInvalidOption (sizes, weights, values not finite, a constant field). A few seconds.
/// Source: MATH 9.2; the grid: Alexa 2022.
Result<FieldAlignment> alignFields(Context& context, const SphereField& a,
                                   const std::vector<double>& weights, const SphereField& b,
                                   const FieldSearchOptions& options = {});

/// Gauss and Newton's method alone, from a rotation that is nearly right.
FieldAlignment refineFieldAlignment(const SphereField& a, const std::vector<double>& weights,
                                    const SphereField& b, const Eigen::Matrix3d& start);

/// Rotation `index` of an even grid of `count` rotations: the super-Fibonacci spiral.
Eigen::Matrix3d gridRotation(int index, int count);

}  // namespace moduli
