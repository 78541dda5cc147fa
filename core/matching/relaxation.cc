#include "core/matching/relaxation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"
#include "core/matching/plane_step.h"

namespace moduli {
namespace {

/// Excess of the energy per area that counts as much: a face or two that are stuck do not hide how
/// the others fare.
constexpr double kMuch = 0.1;

/// What a face counts at most, per area, when maps are compared.
constexpr double kMost = 100;

/// Faces on the sphere that are clearer of turning over than this need not be kept from it. Without
/// such a bound faces whose images in space are sound can be so thin on the sphere that the kernels
/// of rings have no room for another vertex.
constexpr double kClear = 1e-3;
constexpr double kTooThin = 1e-5;  ///< Wild.

/// How much stronger than an attraction what a held vertex is drawn by is.
constexpr double kHold = 100;

/// Vertices that one thread moves before it asks for more.
constexpr std::size_t kTogether = 128;

/// Without energy.
const SpaceTriangle kNoFace = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero()};

/// Newton's step on a line.
Eigen::Vector3d stepAlong(const Eigen::Vector3d& tangent, const Eigen::Vector3d& gradient,
                          const Eigen::Matrix3d& hessian) {
  const double h = tangent.dot(hessian * tangent);
  if (!(h > 0)) return Eigen::Vector3d::Zero();
  return -gradient.dot(tangent) / h * tangent;
}

}  // namespace

/// A vertex's faces: before the map, and the sides opposite the vertex after it.
struct Relaxation::Star {
  std::vector<FaceDistortion> faces;
  double mass = 0;  ///< A third of their area.
};

/// Of Newton's method.
struct Relaxation::Step {
  Eigen::Vector3d way;
  double longest = 0;   ///< That it may be.
  double energy = 0;    ///< Before it.
  double expected = 0;  ///< That it gains where the energy is quadratic.
};

Relaxation::Star Relaxation::starOf(Index v) const {
  Star star;
  const std::vector<Index>& ring = mesh_.ring(v);
  star.faces.reserve(ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
    if (mesh_.isCap(v, a, b)) {
      star.faces.emplace_back(kNoFace);
      continue;
    }
    star.faces.emplace_back(SpaceTriangle{(*positions_)[v], (*positions_)[a], (*positions_)[b]});
    star.mass += star.faces.back().area() / 3;
  }
  return star;
}

double Relaxation::clearance(Index v, const Image& image) const {
  const std::vector<Index>& ring = mesh_.ring(v);
  double least = kClear;
  for (std::size_t i = 0; i < ring.size() && least > 0; ++i) {
    const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
    if (mesh_.isCap(v, a, b)) {
      // Its own width does not matter.
      if (!SphereDomain::isPositive(image, images_[a], images_[b])) return 0;
      continue;
    }
    least = std::min(least, SphereDomain::clearance(image, images_[a], images_[b]));
  }
  return least;
}

double Relaxation::pullEnergy(double mass, Index v, const Eigen::Vector3d& at) const {
  const Attraction& to = (*attractions_)[v];
  const double weight = pull_ * to.weight * mass;
  if (!(weight > 0)) return 0;
  const double r2 = (at - to.place).squaredNorm(), s2 = scale_ * scale_;
  if (mesh_.isHeld(v)) return kHold * weight * r2;
  return weight * r2 * (s2 / (r2 + s2));
}

double Relaxation::energy(const Star& star, Index v, const Image& image) const {
  const std::vector<Index>& ring = mesh_.ring(v);
  double sum = pullEnergy(star.mass, v, image.space);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
    sum += star.faces[i].energy({image.space, images_[a].space, images_[b].space});
  }
  return sum;
}

Relaxation::Step Relaxation::newtonStep(const Star& star, Index v) const {
  const std::vector<Index>& ring = mesh_.ring(v);
  const Image& here = images_[v];
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Step result;
  result.energy = pullEnergy(star.mass, v, here.space);
  double longest = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
    result.energy += star.faces[i].differentiate({here.space, images_[a].space, images_[b].space},
                                                 gradient, hessian);
    if (a == mesh_.pole()) continue;
    longest = std::max(longest, (images_[a].space - here.space).squaredNorm());
  }
  result.longest = 2 * std::sqrt(longest);
  const Attraction& to = (*attractions_)[v];
  const Eigen::Vector3d away = here.space - to.place;
  const double s2 = scale_ * scale_, share = s2 / (s2 + away.squaredNorm());
  const double full = 2 * pull_ * to.weight * star.mass;
  const double pull = mesh_.isHeld(v) ? full * kHold : full * share * share;
  gradient += pull * away;
  hessian.diagonal().array() += pull;
  result.way = mesh_.isRim(v) ? stepAlong(domain_->rimTangent(here), gradient, hessian)
                              : stepInPlane(domain_->normal(here.point.face), gradient, hessian);
  result.expected = -gradient.dot(result.way) / 2;
  return result;
}

Image Relaxation::moved(Index v, const Eigen::Vector3d& step) const {
  const Image& here = images_[v];
  if (!mesh_.isRim(v)) return domain_->walk(here, step);
  return domain_->walkRim(here, domain_->rimTangent(here).dot(step));
}

bool Relaxation::isFixed(Index v) const {
  return images_[v].direction == (*attractions_)[v].image.direction;
}

bool Relaxation::fix(Index v) {
  const Image& there = (*attractions_)[v].image;
  if (!(clearance(v, there) >= kTooThin)) return false;
  images_[v] = there;
  return true;
}

double Relaxation::relax(Index v, double times) {
  if (v == mesh_.pole()) return 0;
  if (mesh_.isHeld(v) && (isFixed(v) || fix(v))) return 0;
  const Star star = starOf(v);
  const Step newton = newtonStep(star, v);
  // Smaller gains drown in the rounding of the sum.
  const double enough = 1e-13 * newton.energy;
  if (!(newton.expected > enough)) return 0;
  Eigen::Vector3d step = times * newton.way;
  if (const double length = step.norm(); length > newton.longest) step *= newton.longest / length;
  for (int halving = 0; halving < 5; ++halving, step /= 3) {
    Image trial = moved(v, step);
    const double gain = newton.energy - energy(star, v, trial);
    if (!(gain > enough)) continue;
    const double then = clearance(v, trial);
    if (!(then > 0) || (then < kClear && then < clearance(v, images_[v]))) continue;
    images_[v] = std::move(trial);
    return gain;
  }
  return 0;
}

std::vector<Index> Relaxation::present() const {
  std::vector<Index> vertices;
  for (Index v = 0; v < vertexCount(); ++v) {
    if (mesh_.isPresent(v)) vertices.push_back(v);
  }
  return vertices;
}

std::vector<Index> Relaxation::inSweepOrder() const {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : *positions_) middle += p / static_cast<double>(vertexCount());
  std::vector<std::pair<double, Index>> sorted;
  for (const Index v : present()) sorted.emplace_back(((*positions_)[v] - middle).norm(), v);
  std::sort(sorted.begin(), sorted.end());
  std::vector<Index> vertices;
  vertices.reserve(sorted.size());
  for (const auto& [distance, v] : sorted) vertices.push_back(v);
  return vertices;
}

bool Relaxation::isTame(Index a, Index b, Index c, double most) const {
  if (mesh_.isCap(a, b, c)) return SphereDomain::isPositive(images_[a], images_[b], images_[c]);
  if (!(SphereDomain::clearance(images_[a], images_[b], images_[c]) > kTooThin)) return false;
  const FaceDistortion face({(*positions_)[a], (*positions_)[b], (*positions_)[c]});
  return face.energy({images_[a].space, images_[b].space, images_[c].space}) <=
         4 * most * face.area();
}

void Relaxation::jump(Index v) {
  if (!((*attractions_)[v].weight > 0)) return;
  const Star star = starOf(v);
  const Image& there = (*attractions_)[v].image;
  const double before = energy(star, v, images_[v]);
  if (!(energy(star, v, there) < before)) return;
  const double then = clearance(v, there);
  if (then > 0 && then >= clearance(v, images_[v])) images_[v] = there;
}

double Relaxation::restingGain(double tolerance) const {
  return 0.01 * tolerance * kMuch / static_cast<double>(mesh_.vertexCount());
}

void Relaxation::relaxNear(const std::vector<Index>& vertices, int sweeps, double tolerance) {
  const double rest = restingGain(tolerance);
  std::vector<Index> active;
  const auto wake = [&](Index v, std::vector<Index>& list) {
    if (awake_[v] != 0) return;
    awake_[v] = 1;
    list.push_back(v);
  };
  std::fill(awake_.begin(), awake_.end(), 0);
  for (const Index v : vertices) {
    wake(v, active);
    for (const Index w : mesh_.ring(v)) wake(w, active);
  }
  for (int sweep = 0; sweep < sweeps && !active.empty(); ++sweep) {
    std::vector<Index> next;
    for (const Index v : active) {
      awake_[v] = 0;
      if (!(relax(v) > rest)) continue;
      wake(v, next);
      for (const Index w : mesh_.ring(v)) wake(w, next);
    }
    active = std::move(next);
  }
}

Status Relaxation::relaxAll(Context& context, const std::vector<Index>& order, int sweeps,
                            double tolerance) {
  double left = tolerance > 0 ? excess(order) : 0;
  // Vertices that have come to rest sleep until a neighbour moves.
  for (const Index v : order) awake_[v] = 1;
  const double rest = restingGain(tolerance);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    double gained = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i % 10000 == 0) RETURN_IF_ERROR(context.check());
      const Index v = order[i];
      if (awake_[v] == 0) continue;
      const double gain = relax(v);
      gained += gain;
      if (gain > rest) {
        for (const Index w : mesh_.ring(v)) awake_[w] = 1;
      } else {
        awake_[v] = 0;
      }
    }
    left -= gained;
    if (!(gained > tolerance * std::clamp(left, 0.0, kMuch))) break;
  }
  return {};
}

Status Relaxation::relaxSets(Context& context, const std::vector<std::vector<Index>>& sets,
                             int sweeps, double times) {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    RETURN_IF_ERROR(context.check());
    for (const std::vector<Index>& set : sets) {
      parallelBlocks(set.size(), kTogether, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) relax(set[i], times);
      });
    }
  }
  return {};
}

double Relaxation::excess(const std::vector<Index>& vertices) const {
  double sum = 0;
  for (const Index v : vertices) {
    const Star star = starOf(v);
    const std::vector<Index>& ring = mesh_.ring(v);
    sum += pullEnergy(star.mass, v, images_[v].space);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Index a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
      const double energy =
          star.faces[i].energy({images_[v].space, images_[a].space, images_[b].space});
      sum += std::min(energy - 4 * star.faces[i].area(), kMost * star.faces[i].area()) / 3;
    }
  }
  return sum;
}

/// Mean value coordinates of a vertex in its ring, as the surface before the map has them, applied
/// to the directions. Source: Floater 2003.
Eigen::Vector3d Relaxation::meanOfRing(Index v) const {
  const std::vector<Index>& ring = mesh_.ring(v);
  const std::size_t n = ring.size();
  std::vector<double> half_tangent(n);  // Of the angle between neighbours i and i + 1.
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d a = (*positions_)[ring[i]] - (*positions_)[v];
    const Eigen::Vector3d b = (*positions_)[ring[(i + 1) % n]] - (*positions_)[v];
    const double cosine = a.dot(b) + a.norm() * b.norm();
    half_tangent[i] = cosine > 0 ? std::min(a.cross(b).norm() / cosine, 1e3) : 1e3;
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const double length = ((*positions_)[ring[i]] - (*positions_)[v]).norm();
    const double weight = (half_tangent[i] + half_tangent[(i + n - 1) % n]) /
                          std::max(length, std::numeric_limits<double>::min());
    sum += weight * images_[ring[i]].direction;
  }
  return sum;
}

void Relaxation::considerRim(Index v, Index kept,
                             const std::function<bool(const Image&)>& consider) const {
  const std::vector<Index>& ring = mesh_.ring(v);
  const auto pole = std::find(ring.begin(), ring.end(), mesh_.pole());
  const Index ahead = pole + 1 == ring.end() ? ring.front() : *(pole + 1);
  const Index behind = pole == ring.begin() ? ring.back() : *(pole - 1);
  const auto& p = *positions_;
  const double to = (p[ahead] - p[v]).norm(), from = (p[behind] - p[v]).norm();
  const double share = from + to > 0 ? from / (from + to) : 0.5;
  const double way = domain_->rimWay(images_[behind], images_[ahead]);
  if (consider(domain_->walkRim(images_[behind], share * way))) return;
  // Close to `kept`, before the other neighbour, there is a place.
  const Eigen::Vector3d& origin = images_[kept].direction;
  const Eigen::Vector3d towards = images_[kept == ahead ? behind : ahead].direction - origin;
  for (double reach = 0.5; reach > 1e-17; reach /= 2) {
    if (consider(domain_->onRim(origin + reach * towards))) return;
  }
}

bool Relaxation::place(Index v, Index kept) {
  const Star star = starOf(v);
  double least = std::numeric_limits<double>::infinity();
  Image best;
  double clearest = 0;
  const auto consider = [&](const Image& trial) {
    const double clear = clearance(v, trial);
    if (!(clear > 0)) return false;
    const double cost = energy(star, v, trial);
    if (clear > clearest || (clear == clearest && cost < least)) {
      best = trial;
      least = cost;
      clearest = clear;
    }
    return true;
  };
  if ((*attractions_)[v].weight > 0) consider((*attractions_)[v].image);
  const Eigen::Vector3d mean = meanOfRing(v);
  if (mesh_.isRim(v)) {
    considerRim(v, kept, consider);
    if (!(clearest > 0)) return false;
    images_[v] = std::move(best);
    relax(v);
    return true;
  }
  const bool mean_will_do = mean.squaredNorm() > 0 && consider(domain_->at(mean));
  if (!mean_will_do) {
    // Close to `kept` the kernel is a sector between the two neighbours they share; its bisector
    // leads into it.
    const std::vector<Index>& ring = mesh_.ring(v);
    const auto at = std::find(ring.begin(), ring.end(), kept) - ring.begin();
    const auto n = static_cast<std::ptrdiff_t>(ring.size());
    const Eigen::Vector3d& origin = images_[kept].direction;
    const auto towards = [&](std::ptrdiff_t i) {
      const Eigen::Vector3d& p = images_[ring[i]].direction;
      return Eigen::Vector3d((p - p.dot(origin) * origin).normalized());
    };
    const Eigen::Vector3d left = towards((at + 1) % n), right = towards((at + n - 1) % n);
    Eigen::Vector3d middle = left + right;
    // The sector runs counter-clockwise from `left` to `right`, over v.
    if (right.cross(left).dot(origin) > 0) middle = -middle;
    const Eigen::Vector3d across = right.cross(origin);
    if (middle.norm() < 1e-6) middle = across;
    middle.normalize();
    double reach = 0;
    for (const Index w : ring) reach = std::max(reach, (images_[w].direction - origin).norm());
    for (int halving = 0; halving < 60; ++halving, reach /= 2) {
      const Image near = domain_->at(Eigen::Vector3d(origin + reach * middle));
      if (!consider(near)) continue;
      if (!(mean.squaredNorm() > 0)) break;
      double t = 0.5;
      for (int step = 0; step < 8; ++step, t /= 2) {
        const Eigen::Vector3d between = (1 - t) * near.direction + t * mean.normalized();
        if (consider(domain_->at(between))) break;
      }
      break;
    }
  }
  if (!(clearest > 0)) return false;
  images_[v] = std::move(best);
  relax(v);
  return true;
}

}  // namespace moduli
