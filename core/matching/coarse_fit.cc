#include "core/matching/coarse_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/side_by_side.h"
#include "core/matching/conformal_sphere.h"
#include "core/matching/harmonic_match.h"
#include "core/matching/homeomorphism.h"
#include "core/matching/relaxation.h"
#include "core/matching/settling.h"
#include "core/matching/space_mobius.h"
#include "core/matching/spectral_guess.h"
#include "core/matching/sphere_domain.h"
#include "core/matching/thinned_surface.h"
#include "core/mesh/vertex_normals.h"

namespace moduli {
namespace {

/// Enough for thin handles and limbs.
constexpr Index kVertices = 1200;
/// Of the places that modes tell, as SettlingOptions has it: a hundredth of the root of the area
/// away costs as much as a thousandth of stretching. More of it keeps the errors of places that
/// tell surfaces apart which are nearly round, or slide along themselves.
constexpr double kPull = 0.01;
/// How often a Möbius map of space is fitted at most, each time to a better map of the surface:
/// what modes tell of one leaves a stretching of its own,
constexpr int kMobiusRounds = 8;
/// which has to fall by a tenth to go on.
constexpr double kBetter = 0.9;
/// So many pairs of points, evenly numbered, tell how spheres lie on each other.
constexpr std::size_t kPairs = 200;

using Eigen::Vector3d;
using Positions = std::vector<Vector3d>;

SettlingOptions settling() {
  SettlingOptions options;
  options.pull = kPull;
  return options;
}

template <typename Values>
Values chosen(const Values& values, const std::vector<Index>& numbers) {
  Values some;
  some.reserve(numbers.size());
  for (const Index i : numbers) some.push_back(values[i]);
  return some;
}

}  // namespace

Result<CoarseFit> CoarseFit::make(Context& context, const TriangleMesh& a, const TriangleMesh& b,
                                  bool initial_delaunay) {
  CoarseFit fit(a, b);
  if (a.vertexCount() > kVertices + kVertices / 2) {
    ASSIGN_OR_RETURN(ThinnedSurface thinned, thinSurface(context, a, kVertices));
    fit.thin_.emplace(std::move(thinned.mesh));
    fit.vertices_ = std::move(thinned.vertices);
  } else {
    fit.vertices_.resize(a.vertexCount());
    std::iota(fit.vertices_.begin(), fit.vertices_.end(), 0);
  }
  fit.normals_b_ = vertexNormals(b.connectivity(), b.positions());
  if (b.connectivity().eulerCharacteristic() != 2) {
    ASSIGN_OR_RETURN(fit.cover_, straightCover(context, b.connectivity(), b.edgeLengths()));
    return fit;
  }
  const TriangleMesh& from = fit.thin_ ? *fit.thin_ : a;
  Result<ConformalSphere> first = ConformalSphere(), second = ConformalSphere();
  sideBySide(
      context, [&](Context& own) { first = conformalSphere(own, from, initial_delaunay); },
      [&](Context& own) { second = conformalSphere(own, b, initial_delaunay); });
  RETURN_IF_ERROR(first.status());
  RETURN_IF_ERROR(second.status());
  fit.sphere_a_ = std::move(first->points);
  ASSIGN_OR_RETURN(SphereLocator locator,
                   SphereLocator::make(b.connectivity(), std::move(second->points)));
  fit.sphere_b_.emplace(std::move(locator));
  return fit;
}

Result<CoarseMap> CoarseFit::operator()(Context& context, const std::vector<SurfacePoint>& points,
                                        bool mobius) const {
  const TriangleMesh& from = thin_ ? *thin_ : a_;
  std::vector<SurfacePoint> images = chosen(points, vertices_);
  if (!mobius) {
    ASSIGN_OR_RETURN(images, fitted(context, from, images));
    return mapOf(a_.positions(), images);
  }
  CoarseMap least;
  for (int round = 0; round < kMobiusRounds; ++round) {
    ASSIGN_OR_RETURN(const SpaceMobius map, mobiusNear(from, images));
    Positions whole = a_.positions();
    for (Vector3d& p : whole) p = map(p);
    ASSIGN_OR_RETURN(
        const TriangleMesh there,
        TriangleMesh::fromSoup({chosen(whole, vertices_), from.connectivity().faces()}));
    ASSIGN_OR_RETURN(images, fitted(context, there, images));
    CoarseMap found = mapOf(whole, images);
    if (round > 0 && !(found.change.product() < kBetter * least.change.product())) break;
    least = std::move(found);
  }
  return least;
}

Result<SpaceMobius> CoarseFit::mobiusNear(const TriangleMesh& from,
                                          const std::vector<SurfacePoint>& images) const {
  Positions some, places;
  const std::size_t stride = std::max<std::size_t>(1, images.size() / kPairs);
  for (std::size_t v = 0; v < images.size(); v += stride) {
    some.push_back(from.positions()[v]);
    places.push_back(spacePoint(b_.connectivity(), b_.positions(), images[v]));
  }
  ASSIGN_OR_RETURN(SpaceMobiusFit fit, fitSpaceMobius(some, places));
  if (fit.median < kNearMobius * std::sqrt(b_.area())) return fit.map;
  return Status(Reason::kNoConvergence, "no Möbius map of space is near the points");
}

CoarseMap CoarseFit::mapOf(const Positions& whole, const std::vector<SurfacePoint>& images) const {
  CoarseMap map;
  Positions normals;
  for (const SurfacePoint& point : images) {
    map.places.push_back(spacePoint(b_.connectivity(), b_.positions(), point));
    normals.push_back(spacePoint(b_.connectivity(), normals_b_, point).stableNormalized());
  }
  const TriangleMesh& from = thin_ ? *thin_ : a_;
  map.change =
      shapeChange(from.connectivity(), chosen(whole, vertices_),
                  chosen(vertexNormals(a_.connectivity(), whole), vertices_), map.places, normals);
  return map;
}

Result<std::vector<SurfacePoint>> CoarseFit::fitted(
    Context& context, const TriangleMesh& from, const std::vector<SurfacePoint>& targets) const {
  if (!cover_) return fittedSphere(context, from, targets);
  ASSIGN_OR_RETURN(HarmonicMatch match, matchHarmonically(context, from.connectivity(),
                                                          from.edgeLengths(), *cover_, targets));
  RETURN_IF_ERROR(settle(context, from, b_, *cover_, targets, match.map, settling()));
  return std::move(match.map.images);
}

Result<std::vector<SurfacePoint>> CoarseFit::fittedSphere(
    Context& context, const TriangleMesh& from, const std::vector<SurfacePoint>& targets) const {
  std::vector<VertexTarget> there;
  std::vector<PointPair> pairs;
  const std::size_t stride = std::max<std::size_t>(1, targets.size() / kPairs);
  for (std::size_t v = 0; v < targets.size(); ++v) {
    there.push_back({static_cast<Index>(v), targets[v], 1});
    if (v % stride != 0) continue;
    pairs.push_back(
        {sphere_a_[v], spherePoint(b_.connectivity(), sphere_b_->points(), targets[v])});
  }
  ASSIGN_OR_RETURN(const Points3 start, broughtNear(sphere_a_, pairs));
  HomeomorphismOptions fitting;
  fitting.last_smoothing = fitting.smoothing;  // Crumples need not be taken out: they count little.
  ASSIGN_OR_RETURN(const Homeomorphism map,
                   fitHomeomorphism(context, {from.connectivity(), from.positions(), start},
                                    {*sphere_b_, b_.positions()}, there, fitting));
  return settled(context, from, targets, map.points);
}

Result<std::vector<SurfacePoint>> CoarseFit::settled(Context& context, const TriangleMesh& from,
                                                     const std::vector<SurfacePoint>& targets,
                                                     const Points3& points) const {
  Positions positions = from.positions();
  const double unit = std::sqrt(from.area());
  for (Vector3d& p : positions) p /= unit;
  const SphereDomain domain(*sphere_b_, b_.positions(), std::sqrt(b_.area()));
  std::vector<Attraction> attractions;
  for (const SurfacePoint& target : targets) {
    const Image image = domain.at(target);
    attractions.push_back({image.space, image, 1});
  }
  ASSIGN_OR_RETURN(RingMesh rings, RingMesh::make(from.connectivity()));
  Relaxation map(std::move(rings), positions, domain, attractions);
  const auto count = static_cast<Index>(points.size());
  for (Index v = 0; v < count; ++v) map.setImage(v, domain.at(points[v]));
  RETURN_IF_ERROR(settle(context, from.connectivity(), domain, attractions, map, settling()));
  std::vector<SurfacePoint> images;
  for (Index v = 0; v < count; ++v) images.push_back(map.image(v).point);
  return images;
}

}  // namespace moduli
