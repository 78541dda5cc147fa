#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/triangle_soup.h"

/// A labelled benchmark of shape retrieval that anyone can make: closed surfaces of all kinds, and
/// each of them changed in the ways that a descriptor should not mind, or should notice.
namespace moduli {

/// A closed connected surface.
struct BaseShape {
  std::string label;
  TriangleSoup soup;
  std::optional<TriangleSoup> other;  ///< The same shape as another file has it.
};

struct BaseOptions {
  std::size_t max_faces = 10000;  ///< Larger meshes are simplified to this.
};

/// The analytic samples, and the closed meshes of $MODULI_SHARED/meshes (tests/core/testing.h)
/// where there are any. Fails as the readers do.
Result<std::vector<BaseShape>> loadBaseShapes(Context& context, const BaseOptions& options);

/// Names of all kinds of variants, in the order of makeVariants: what is done to the base shape,
/// which then, but for "original", is moved, scaled and renumbered.
///
/// original; rigid: nothing more; half, quarter: simplified to that share of the faces; refined:
/// half as many faces again, all vertices at other places; noise-light, noise: Gaussian errors of
/// 0.1 % and 0.5 % of the bounding box's diagonal; bent: by up to 120 degrees, strain at most
/// 0.45; articulated: limbs turned; bulge: a bump 6 % of the diagonal high; hole: a disk of 3 % of
/// the area missing; inverted: a Möbius map of space; other: the same shape from another source.
const std::vector<std::string>& variantKinds();

struct Variant {
  std::string name;   ///< "LABEL-KIND".
  std::string label;  ///< The base shape's.
  std::string kind;
  TriangleSoup soup;
};

/// All variants of a shape, each a connected manifold, closed but for "hole", of the base shape's
/// genus; "other" only where the shape has one. The same on every machine with the same arithmetic:
/// random numbers depend on label, kind and seed alone. Fails with kInternal if a variant is not
/// what it has to be.
Result<std::vector<Variant>> makeVariants(const BaseShape& base, std::size_t seed);

}  // namespace moduli
