#include "core/hyperbolic/fuchsian_group.h"

#include <algorithm>
#include <limits>
#include <string>

#include "core/hyperbolic/short_handles.h"
#include "core/hyperbolic/side_pairings.h"
#include "core/hyperbolic/wide_su11.h"

namespace moduli {
namespace {

constexpr double kWorstRelation = 1e-8;

/// prod [a, b] = 1 with A = a and B = b^-1.
std::vector<Su11> generatorsOf(const std::vector<GroupHandle>& handles) {
  std::vector<Su11> generators;
  for (const GroupHandle& h : handles) {
    generators.push_back(rounded(h.a));
    generators.push_back(rounded(inverse(h.b)));
  }
  return generators;
}

Status check(const FuchsianCertificate& certificate) {
  if (!(certificate.shortest_generator > 0)) {
    return {Reason::kResidualTooLarge, "a generator of the group has no axis"};
  }
  if (!(certificate.relation_residual < kWorstRelation)) {
    return {Reason::kResidualTooLarge, "the relation of the generators misses 1 by " +
                                           std::to_string(certificate.relation_residual)};
  }
  return {};
}

}  // namespace

std::vector<int> canonicalRelation(std::size_t genus) {
  Word word;
  for (int a = 1; a < 2 * static_cast<int>(genus); a += 2) {
    word.insert(word.end(), {a, -(a + 1), -a, a + 1});
  }
  return word;
}

double canonicalRelationResidual(const std::vector<Su11>& generators) {
  std::vector<WideSu11> letters;
  for (const Su11& g : generators) letters.push_back(widened(g));
  const Word relation = canonicalRelation(generators.size() / 2);
  if (evaluate(letters, relation).a.real() < 0) return 2;
  return relationResidual(letters, relation);
}

Result<FuchsianGroup> computeFuchsianGroup(Context& context, const HyperbolicTriangles& triangles,
                                           const Development& development) {
  const Context::Stage stage(context, "group");
  const SidePairings pairings = findSidePairings(triangles.surface, development);
  ASSIGN_OR_RETURN(const RelationCorrection corrected,
                   correctRelation(pairings.letters, pairings.relation));
  ASSIGN_OR_RETURN(const ShortHandles found,
                   findShortHandles(context, corrected.letters, pairings.relation));
  FuchsianGroup group{rounded(found.base), generatorsOf(found.handles), {}};
  FuchsianCertificate& certificate = group.certificate;
  certificate.relation_residual = canonicalRelationResidual(group.generators);
  certificate.moved = corrected.moved;
  certificate.residual_before_moving = corrected.residual_before;
  certificate.development = development.certificate;
  certificate.shortest_generator = std::numeric_limits<double>::infinity();
  for (const Su11& g : group.generators) {
    certificate.longest_displacement = std::max(certificate.longest_displacement, displacement(g));
    certificate.shortest_generator = std::min(certificate.shortest_generator, translationLength(g));
  }
  RETURN_IF_ERROR(check(certificate));
  return group;
}

Result<FuchsianGroup> computeFuchsianGroup(Context& context, const HyperbolicTriangles& triangles,
                                           const DevelopOptions& options) {
  ASSIGN_OR_RETURN(const Development development, develop(context, triangles, options));
  return computeFuchsianGroup(context, triangles, development);
}

}  // namespace moduli
