#include "core/matching/settling.h"

#include <cmath>
#include <utility>

#include "core/base/parallel.h"
#include "core/matching/isometric_step.h"
#include "core/matching/surface_walk.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Eigen::Vector3d;
using Vectors = std::vector<Vector3d>;

/// After a common step: evens out the few faces that it does harm to.
constexpr int kSweeps = 3;
constexpr int kHalvings = 5;
/// Vertices or edges that one thread moves before it asks for more.
constexpr std::size_t kTogether = 512;

/// A map to a surface of genus 0, as it moves.
class SphereState {
 public:
  SphereState(const Connectivity& surface, const SphereDomain& domain, Relaxation map)
      : surface_(&surface),
        domain_(&domain),
        map_(std::move(map)),
        order_(map_.inSweepOrder()),
        sets_(separatedSets(map_.mesh(), order_)) {}

  Vectors places() const {
    Vectors places;
    for (Index v = 0; v < map_.vertexCount(); ++v) places.push_back(map_.image(v).space);
    return places;
  }

  Vectors normals() const {
    Vectors normals;
    for (Index v = 0; v < map_.vertexCount(); ++v) {
      // What is held has no plane to move in.
      normals.push_back(map_.mesh().isHeld(v) ? Vector3d::Zero()
                                              : domain_->normal(map_.image(v).point.face));
    }
    return normals;
  }

  /// That of Relaxation: single faces that are stretched without end do not stop all others.
  double excess(const IsometricStep&) const { return map_.excess(order_); }

  Result<SphereState> moved(Context& context, const Vectors& steps, double share) const {
    SphereState result = *this;
    parallelBlocks(order_.size(), kTogether, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) {
        const Index v = order_[i];
        result.map_.setImage(v, domain_->walk(map_.image(v), share * steps[v]));
      }
    });
    while (result.keepFolded(map_)) RETURN_IF_ERROR(context.check());
    RETURN_IF_ERROR(result.map_.relaxSets(context, sets_, kSweeps));
    return result;
  }

  Relaxation& map() { return map_; }

 private:
  /// Leaves the vertices of folded faces where they were; whether there are any.
  bool keepFolded(const Relaxation& before) {
    bool folds = false;
    for (const Triangle& face : surface_->faces()) {
      if (SphereDomain::isPositive(map_.image(face[0]), map_.image(face[1]), map_.image(face[2]))) {
        continue;
      }
      folds = true;
      for (const Index v : face) map_.setImage(v, before.image(v));
    }
    return folds;
  }

  const Connectivity* surface_;
  const SphereDomain* domain_;
  Relaxation map_;
  std::vector<Index> order_;
  std::vector<std::vector<Index>> sets_;
};

/// A map to a surface with handles.
class CoverState {
 public:
  CoverState(const Connectivity& surface, const CoverSurface& cover, const SurfaceWalk& walk,
             CoverMap map)
      : surface_(&surface), cover_(&cover), walk_(&walk), map_(std::move(map)) {}

  Vectors places() const {
    Vectors places;
    for (const SurfacePoint& image : map_.images) places.push_back(walk_->place(image));
    return places;
  }

  Vectors normals() const {
    Vectors normals;
    for (const SurfacePoint& image : map_.images) normals.push_back(walk_->normal(image.face));
    return normals;
  }

  double excess(const IsometricStep& step) const { return step.excess(places()); }

  Result<CoverState> moved(Context& context, const Vectors& steps, double share) const {
    CoverState result = *this;
    std::vector<Motion> way(steps.size(), Motion::Identity());
    parallelBlocks(steps.size(), kTogether, [&](std::size_t v, std::size_t end) {
      for (; v < end; ++v) {
        const auto cross = [&](Index h) { way[v] = way[v] * cover_->across[h]; };
        result.map_.images[v] = (*walk_)(map_.images[v], share * steps[v], 256, cross);
        result.map_.places[v] = cover_->place(result.map_.images[v]);
      }
    });
    do {
      RETURN_IF_ERROR(context.check());
      result.follow(map_, way);
    } while (result.keepFolded(map_, way));
    return result;
  }

  CoverMap& map() { return map_; }

 private:
  /// Changes the transitions as the ways of the vertices demand.
  void follow(const CoverMap& before, const std::vector<Motion>& way) {
    const CoverPlane plane = cover_->plane();
    parallelBlocks(surface_->edgeCount(), kTogether, [&](std::size_t begin, std::size_t end) {
      for (auto e = static_cast<Index>(begin); e < static_cast<Index>(end); ++e) {
        const Index h = surface_->halfedge(e), back = surface_->twin(h);
        map_.transitions[h] =
            plane.normalized(Motion(plane.inverse(way[surface_->tail(h)]) * before.transitions[h] *
                                    way[surface_->head(h)]));
        map_.transitions[back] = plane.inverse(map_.transitions[h]);
      }
    });
  }

  bool keepFolded(const CoverMap& before, std::vector<Motion>& way) {
    bool folds = false;
    for (Index f = 0; f < surface_->faceCount(); ++f) {
      if (!isFolded(*surface_, map_, f)) continue;
      folds = true;
      for (const Index v : surface_->face(f)) {
        map_.images[v] = before.images[v];
        map_.places[v] = before.places[v];
        way[v] = Motion::Identity();
      }
    }
    return folds;
  }

  const Connectivity* surface_;
  const CoverSurface* cover_;
  const SurfaceWalk* walk_;
  CoverMap map_;
};

/// Newton's method with steps that are halved until the energy falls.
template <typename State>
Status settleState(Context& context, IsometricStep& step, State& state,
                   const SettlingOptions& options) {
  const Context::Stage stage(context, "settle");
  step.setPull(options.pull, options.scale);
  double excess = state.excess(step);
  for (int i = 0; i < options.steps; ++i) {
    RETURN_IF_ERROR(context.check());
    ASSIGN_OR_RETURN(const Vectors steps, step(context, state.places(), state.normals()));
    double gain = 0, share = 1;
    for (int halving = 0; halving < kHalvings && !(gain > 0); ++halving, share /= 2) {
      ASSIGN_OR_RETURN(State trial, state.moved(context, steps, share));
      gain = excess - trial.excess(step);
      if (gain > 0) state = std::move(trial);
    }
    if (!(gain > 0)) break;
    excess -= gain;
    if (!(gain > options.tolerance * excess)) break;
  }
  return {};
}

}  // namespace

Status settle(Context& context, const Connectivity& surface, const SphereDomain& domain,
              const std::vector<Attraction>& attractions, Relaxation& map,
              const SettlingOptions& options) {
  IsometricStep step(surface, map.positions(), attractions);
  map.setPull(options.pull, options.scale);
  SphereState state(surface, domain, std::move(map));
  const Status status = settleState(context, step, state, options);
  map = std::move(state.map());
  return status;
}

Status settle(Context& context, const TriangleMesh& a, const TriangleMesh& b,
              const CoverSurface& cover, const std::vector<SurfacePoint>& targets, CoverMap& map,
              const SettlingOptions& options) {
  Vectors positions = a.positions();
  const double unit = std::sqrt(a.area());
  for (Vector3d& p : positions) p /= unit;
  const SurfaceWalk walk(b.connectivity(), b.positions(), std::sqrt(b.area()));
  std::vector<Attraction> attractions(positions.size());
  for (std::size_t v = 0; v < targets.size(); ++v) {
    attractions[v].place = walk.place(targets[v]);
    attractions[v].weight = 1;
  }
  IsometricStep step(a.connectivity(), positions, attractions);
  CoverState state(a.connectivity(), cover, walk, std::move(map));
  const Status status = settleState(context, step, state, options);
  map = std::move(state.map());
  return status;
}

}  // namespace moduli
