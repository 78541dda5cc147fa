#pragma once

#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/hyperbolic/developing.h"
#include "core/hyperbolic/su11.h"

/// The group of deck transformations of a closed hyperbolic surface, by canonical generators.
///
///   ASSIGN_OR_RETURN(const HyperbolicTriangles triangles, hyperbolicTriangles(metric));
///   ASSIGN_OR_RETURN(const FuchsianGroup group, computeFuchsianGroup(context, triangles));
///   group.generators;  // A_1, B_1, .. A_g, B_g
namespace moduli {

/// What judges a group.
struct FuchsianCertificate {
  /// How far prod [A_k, B_k^-1] of the generators, as they are rounded, is from +1, entry by entry.
  double relation_residual = 0;
  /// How far the side pairings were moved so that their relation holds: lengths and angles.
  double moved = 0;
  /// How far the relation of the side pairings was from +-1 before.
  double residual_before_moving = 0;
  double longest_displacement = 0;  ///< max d(0, X 0) over the generators X.
  double shortest_generator = 0;    ///< The smallest translation length of a generator.
  DevelopmentCertificate development;
};

/// A surface's group in SU(1, 1).
struct FuchsianGroup {
  /// From the coordinates of the generators to those of the layout, where X is base X base^-1: 0
  /// is moved to where the generators move it least.
  Su11 base;
  /// A_1, B_1, .. A_g, B_g with A_1 B_1^-1 A_1^-1 B_1 .. A_g B_g^-1 A_g^-1 B_g = +1: as the side
  /// pairings of a polygon whose sides are a_1, b_1, a_1^-1, b_1^-1, a_2, .. counter-clockwise, A_k
  /// from a_k^-1 to a_k and B_k from b_k^-1 to b_k. In homology A_k . B_k = +1.
  std::vector<Su11> generators;
  FuchsianCertificate certificate;
};

/// The word of the relation in letters +-1 .. +-2 g for A_1, B_1, ..: 1, -2, -1, 2, 3, ..
std::vector<int> canonicalRelation(std::size_t genus);

/// How far prod [A_k, B_k^-1] of generators A_1, B_1, .. is from +1, entry by entry, as they are
/// rounded; about 2 where it is near -1. Grows with their displacements, not with the product's.
double canonicalRelationResidual(const std::vector<Su11>& generators);

/// The group of a surface that is laid out by develop(): side pairings moved to satisfy their
/// relation, canonical generators split off and shortened in 113 bits, and rounded. The sign is +1
/// because commutators do not see the lifts' signs and the Euler number is even.
/// Fails as develop, correctRelation and findShortHandles do, and with kResidualTooLarge where a
/// generator has no axis or the rounded relation misses 1 by 1e-8 or more.
/// O(F log F + g^5). Source: MATH 7.2 to 7.4; Brahana 1921.
Result<FuchsianGroup> computeFuchsianGroup(Context& context, const HyperbolicTriangles& triangles,
                                           const Development& development);
/// Both steps.
Result<FuchsianGroup> computeFuchsianGroup(Context& context, const HyperbolicTriangles& triangles,
                                           const DevelopOptions& options = {});

}  // namespace moduli
