#include "server/service/flat_targets.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/parameterize/atlas.h"
#include "core/parameterize/components.h"
#include "core/parameterize/cones.h"
#include "core/parameterize/flat.h"
#include "core/parameterize/polycube.h"
#include "core/parameterize/quads.h"
#include "core/parameterize/torus.h"
#include "server/rpc/convert_parameterization.h"
#include "server/service/cones.h"
#include "server/service/named_vertex.h"
#include "server/service/seams.h"

namespace moduli {
namespace {

using Options = v1::ParameterizationOptions;

constexpr double kQuarter = std::numbers::pi / 2;
constexpr double kTypedRounding = 1e-5;  // Of five decimals.

bool startsDelaunay(const Options& message) {
  return !message.has_initial_delaunay() || message.initial_delaunay();
}

bool refines(const Options& message) {
  return !message.has_refine() || message.refine();
}

bool cutsOverlaps(const Options& message) {
  return !message.has_cut_overlaps() || message.cut_overlaps();
}

ConeOptions coneOptions(const v1::ConeChoice& wanted) {
  ConeOptions choice;
  if (wanted.has_spread()) choice.spread = wanted.spread();
  if (wanted.has_most()) choice.most = wanted.most();
  if (wanted.quarter_turns()) choice.quantum = kQuarter;
  return choice;
}

/// Of the options of all targets whose layouts are cut along seams.
template <typename Layout>
Status setSeams(const Options& message, const Subject& subject, Layout& options) {
  if (message.has_margin()) options.margin = message.margin();
  ASSIGN_OR_RETURN(options.seams,
                   seamsOnSurface(message.seams(), subject.surface(), subject.places));
  return {};
}

Result<Parameterization> mapFlat(Context& context, const Options& message, const Subject& subject) {
  FlatOptions options = fromProto(message);
  options.refine = refines(message);
  options.cut_overlaps = cutsOverlaps(message);
  RETURN_IF_ERROR(setSeams(message, subject, options));
  ASSIGN_OR_RETURN(options.cones,
                   conesOnSurface(message.cones(), subject.surface(), subject.places));
  ASSIGN_OR_RETURN(options.boundary, boundaryRule(message.boundary(), message.cones(),
                                                  options.cones, subject.surface()));
  const ConeOptions choice = coneOptions(message.cone_choice());
  const auto flatten = [&](Context& within, const SurfaceComponent& component,
                           FlatOptions own) -> Result<Parameterization> {
    if (!message.has_cone_choice()) {
      return parameterizeFlat(within, component.surface, component.lengths, own);
    }
    ASSIGN_OR_RETURN(const ChosenCones chosen,
                     chooseCones(within, component.surface, component.lengths, choice));
    own.cones = chosen.cones;
    ASSIGN_OR_RETURN(Parameterization map,
                     parameterizeFlat(within, component.surface, component.lengths, own));
    tellChoice(chosen, choice, map);
    return map;
  };
  return flattenComponents(context, subject.surface(), subject.lengths, options, flatten);
}

Result<std::vector<PolycubeCorner>> cornersOf(const Options& message, const Subject& subject) {
  ASSIGN_OR_RETURN(const std::vector<Cone> cones,
                   conesOnSurface(message.cones(), subject.surface(), subject.places));
  std::vector<PolycubeCorner> corners;
  for (std::size_t i = 0; i < cones.size(); ++i) {
    const int sign = cones[i].curvature > 0 ? 1 : -1;
    if (!(std::abs(cones[i].curvature - sign * kQuarter) <= kTypedRounding)) {
      return Status(Reason::kInvalidOption,
                    "a corner at vertex " +
                        std::to_string(message.cones(static_cast<int>(i)).vertex()) +
                        " of curvature " + shortestDouble(cones[i].curvature) +
                        ": corners of cubes have pi/2 or -pi/2",
                    "give 1.57080 where it is convex, -1.57080 where it is concave");
    }
    corners.push_back({cones[i].vertex, sign});
  }
  return corners;
}

Result<Parameterization> mapPolycube(Context& context, const Options& message,
                                     const Subject& subject) {
  PolycubeOptions options;
  options.initial_delaunay = startsDelaunay(message);
  options.refine = refines(message);
  options.cut_overlaps = cutsOverlaps(message);
  RETURN_IF_ERROR(setSeams(message, subject, options));
  ASSIGN_OR_RETURN(options.corners, cornersOf(message, subject));
  const v1::ConeChoice& choice = message.cone_choice();
  if (choice.has_spread()) options.spread = choice.spread();
  if (choice.has_most()) options.most_corners = choice.most();
  return parameterizePolycube(context, subject.surface(), subject.lengths, options);
}

Result<Parameterization> mapAtlas(Context& context, const Options& message,
                                  const Subject& subject) {
  AtlasOptions options;
  options.initial_delaunay = startsDelaunay(message);
  options.refine = refines(message);
  RETURN_IF_ERROR(setSeams(message, subject, options));
  for (const int vertex : message.extraordinary()) {
    ASSIGN_OR_RETURN(const Index place,
                     namedVertex("an extraordinary point", vertex, subject.places));
    options.extraordinary.push_back(place);
  }
  return parameterizeAtlas(context, subject.surface(), subject.lengths, options);
}

v1::Complex message(const std::complex<double>& z) {
  v1::Complex number;
  number.set_re(z.real());
  number.set_im(z.imag());
  return number;
}

v1::TorusDomain describe(const TorusDomain& torus) {
  v1::TorusDomain domain;
  for (const auto& generator : torus.generators) *domain.add_generators() = message(generator);
  *domain.mutable_tau() = message(torus.tau);
  domain.set_parallelogram(torus.is_parallelogram);
  return domain;
}

v1::ConeMetric describe(const ConeDomain& domain, const Subject& subject) {
  v1::ConeMetric message;
  for (const Cone& cone : domain.cones) {
    v1::Cone& one = *message.add_cones();
    one.set_vertex(subject.inputVertex(cone.vertex));
    one.set_curvature(cone.curvature);
  }
  for (const double turn : domain.handle_turns) message.add_handle_turns(turn);
  if (domain.spread) message.set_spread(*domain.spread);
  if (domain.spread_before) message.set_spread_before(*domain.spread_before);
  return message;
}

v1::QuadDomain describe(const QuadDomain& quads, const Subject& subject) {
  v1::QuadDomain domain;
  for (const FormZero& zero : quads.zeros) {
    v1::FormZero& one = *domain.add_zeros();
    one.set_vertex(subject.inputVertex(zero.vertex));
    one.set_index(zero.index);
  }
  for (const auto& period : quads.periods) *domain.add_periods() = message(period);
  domain.set_squares(quads.squares);
  domain.set_misfit(quads.misfit);
  return domain;
}

v1::AtlasSummary describe(const AffineAtlas& atlas) {
  const Connectivity& surface = atlas.surface;
  v1::AtlasSummary message;
  int charts = 0, transitions = 0;
  for (Index v = 0; v < surface.vertexCount(); ++v) charts += atlas.has_chart[v] ? 1 : 0;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    transitions += atlas.has_chart[surface.tail(h)] && atlas.has_chart[surface.head(h)] ? 1 : 0;
  }
  message.set_charts(charts);
  message.set_transitions(transitions);
  message.set_overlap_residual(atlas.overlap_residual);
  message.set_cocycle_residual(atlas.cocycle_residual);
  return message;
}

}  // namespace

bool isFlatTarget(Options::Target target) {
  return target == Options::FLAT || target == Options::TORUS || target == Options::POLYCUBE ||
         target == Options::ATLAS || target == Options::QUADS;
}

Result<Parameterization> mapToPlane(Context& context, const Options& message,
                                    const Subject& subject) {
  switch (message.target()) {
    case Options::TORUS:
      return parameterizeTorus(context, subject.surface(), subject.lengths,
                               {startsDelaunay(message), refines(message)});
    case Options::POLYCUBE:
      return mapPolycube(context, message, subject);
    case Options::ATLAS:
      return mapAtlas(context, message, subject);
    case Options::QUADS: {
      QuadOptions options;
      options.cut_overlaps = cutsOverlaps(message);
      if (message.has_most_squares()) options.most_squares = message.most_squares();
      return parameterizeQuads(context, subject.surface(), subject.lengths, options);
    }
    default:
      return mapFlat(context, message, subject);
  }
}

void describePlane(const Subject& subject, const Parameterization& map,
                   v1::Parameterization& result) {
  if (map.torus) *result.mutable_torus() = describe(*map.torus);
  // A rectangle is made of a flat metric, too; its cones are its corners.
  if (map.cones && isFlatTarget(result.target())) {
    *result.mutable_cone_metric() = describe(*map.cones, subject);
  }
  if (map.quads) *result.mutable_quads() = describe(*map.quads, subject);
  if (map.atlas) *result.mutable_atlas() = describe(*map.atlas);
}

std::string atlasText(const Subject& subject, const Parameterization& map) {
  if (!map.atlas) return {};
  const Index surface = subject.surface().vertexCount();
  const Index all = map.atlas->surface.vertexCount();
  const auto input = static_cast<Index>(subject.inputVertexCount());
  std::vector<Index> number(all);
  std::vector<bool> taken(subject.inputVertexCount(), false);
  Index next = input + all - surface;
  for (Index v = 0; v < all; ++v) {
    const Index vertex = v < surface ? subject.inputVertex(v) : input + v - surface;
    const bool fits = vertex != kNone && (vertex >= input || !taken[vertex]);
    number[v] = fits ? vertex : next++;
    if (fits && vertex < input) taken[vertex] = true;
  }
  return writeAtlasJson(*map.atlas, number, next);
}

}  // namespace moduli
