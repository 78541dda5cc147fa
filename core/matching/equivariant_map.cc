#include "core/matching/equivariant_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/forms/cotan.h"
#include "core/linalg/spd_solver.h"
#include "core/spherical/exact_sign.h"

namespace moduli {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// What is left where rounding keeps steps from becoming as small.
constexpr double kFairStep = 1e-3;
constexpr double kArmijo = 1e-4;
constexpr int kMostHalvings = 40;
/// Of the median.
constexpr double kLeastWeight = 1e-2;

/// d coth d and d / sinh d.
struct Bending {
  double same = 1, other = 1;
};
Bending bendingOf(bool is_flat, double d) {
  if (is_flat) return {};
  if (d < 1e-4) return {1 + d * d / 3, 1 - d * d / 6};
  return {d / std::tanh(d), d / std::sinh(d)};
}

class HarmonicSearch {
 public:
  HarmonicSearch(Context& context, Geometry geometry, const Connectivity& surface,
                 const std::vector<double>& weights, VertexLinks start,
                 const HarmonicOptions& options)
      : context_(context),
        plane_(geometry),
        surface_(surface),
        weights_(weights),
        options_(options),
        links_(std::move(start)),
        moves_(options.moves),
        ways_(surface.vertexCount(), Matrix2d::Identity()) {
    if (moves_.empty()) moves_.assign(surface.vertexCount(), Motion::Identity());
    for (Index v = surface.vertexCount() - 1; v >= 0; --v) {
      if (!isBound(v)) continue;
      ways_[v] << options.slides[v], Vector2d(0, 0);
      anchor_ = v;
    }
  }

  Result<HarmonicMap> run() {
    const Context::Stage stage(context_, "harmonic");
    double energy = totalEnergy(links_, moves_), last = 0;
    int n = 0;
    for (bool done = false; !done; ++n) {
      RETURN_IF_ERROR(context_.check());
      if (n >= options_.most_iterations) return notConverged(n, last);
      ASSIGN_OR_RETURN(const Eigen::VectorXd step, newtonStep());
      const double relative = relativeSize(step);
      const bool moved = take(step, energy);
      last = relative;
      done = relative < options_.tolerance || !moved;
      if (!moved && relative > kFairStep) return notConverged(n, last);
    }
    HarmonicMap map{std::move(links_), std::move(moves_), 0, last, n, 0};
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      map.energy += edgeEnergy(map.links, e);
    }
    map.folded_faces = countFolded(surface_, map.links);
    return map;
  }

 private:
  static Status notConverged(int steps, double last) {
    return {Reason::kNoConvergence, "the harmonic map still moves by " + shortestDouble(last) +
                                        " of an edge after " + std::to_string(steps) + " steps"};
  }

  double pull(Index v) const { return options_.pulls.empty() ? 0 : options_.pulls[v]; }

  double edgeEnergy(const VertexLinks& links, Index e) const {
    return weights_[e] * plane_.wayTo(links[surface_.halfedge(e)].col(2)).squaredNorm() / 2;
  }

  double totalEnergy(const VertexLinks& links, const std::vector<Motion>& moves) const {
    double sum = 0;
    for (Index e = 0; e < surface_.edgeCount(); ++e) sum += edgeEnergy(links, e);
    if (options_.pulls.empty()) return sum;
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      sum += pull(v) * plane_.wayTo(moves[v].col(2)).squaredNorm() / 2;
    }
    return sum;
  }

  /// Directions along an edge at its two ends, both away from the tail, and its length.
  struct EdgeView {
    Vector2d at_tail, at_head;
    double length = 0;
  };
  EdgeView viewOf(const Motion& link) const {
    const Vector2d way = plane_.wayTo(link.col(2));
    const double length = way.norm();
    if (!(length > 0)) {
      const Vector2d along(1, 0);
      return {along, link.topLeftCorner<2, 2>().transpose() * along, 0};
    }
    const Vector2d back = plane_.inverse(link).col(2).head<2>();
    return {way / length, -back.normalized(), length};
  }

  bool isBound(Index v) const { return !options_.slides.empty() && !options_.slides[v].isZero(0); }

  /// In the coordinates of what vertices can do.
  void addBlock(std::vector<Eigen::Triplet<double>>& entries, Index i, Index j,
                const Matrix2d& whole) const {
    const Matrix2d block = ways_[i].transpose() * whole * ways_[j];
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) {
        if (2 * i + r >= 2 * j + c) entries.emplace_back(2 * i + r, 2 * j + c, block(r, c));
      }
    }
  }

  void addEdge(Index e, std::vector<Eigen::Triplet<double>>& entries) {
    const Index h = surface_.halfedge(e), i = surface_.tail(h), j = surface_.head(h);
    const double w = weights_[e];
    const EdgeView view = viewOf(links_[h]);
    const Bending bending = bendingOf(plane_.isFlat(), view.length);
    const Vector2d &p = view.at_tail, &q = view.at_head;
    const Vector2d p_left(-p[1], p[0]), q_left(-q[1], q[0]);
    gradient_.segment<2>(2 * i) -= w * view.length * p;
    gradient_.segment<2>(2 * j) += w * view.length * q;
    addBlock(entries, i, i, w * (p * p.transpose() + bending.same * p_left * p_left.transpose()));
    addBlock(entries, j, j, w * (q * q.transpose() + bending.same * q_left * q_left.transpose()));
    const Matrix2d mixed = -w * (p * q.transpose() + bending.other * p_left * q_left.transpose());
    if (i == j) {
      addBlock(entries, i, i, mixed + mixed.transpose());
    } else if (i > j) {
      addBlock(entries, i, j, mixed);
    } else {
      addBlock(entries, j, i, mixed.transpose());
    }
  }

  void addPull(Index v, std::vector<Eigen::Triplet<double>>& entries) {
    if (!(pull(v) > 0)) return;
    const Vector2d way = plane_.wayTo(plane_.inverse(moves_[v]).col(2));
    const double length = way.norm();
    const Vector2d along = length > 0 ? Vector2d(way / length) : Vector2d(1, 0);
    const Vector2d left(-along[1], along[0]);
    gradient_.segment<2>(2 * v) -= pull(v) * way;
    addBlock(entries, v, v,
             pull(v) * (along * along.transpose() +
                        bendingOf(plane_.isFlat(), length).same * left * left.transpose()));
  }

  Result<Eigen::VectorXd> newtonStep() {
    const Index n = surface_.vertexCount();
    gradient_ = Eigen::VectorXd::Zero(2 * n);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(12 * static_cast<std::size_t>(surface_.edgeCount()));
    for (Index e = 0; e < surface_.edgeCount(); ++e) addEdge(e, entries);
    for (Index v = 0; v < n; ++v) addPull(v, entries);
    // A flat energy is quadratic.
    if (!solver_ || !plane_.isFlat()) RETURN_IF_ERROR(factorize(std::move(entries)));
    for (Index v = 0; v < n; ++v) {
      gradient_.segment<2>(2 * v) = (ways_[v].transpose() * gradient_.segment<2>(2 * v)).eval();
    }
    ASSIGN_OR_RETURN(const Eigen::MatrixXd solved, solver_->solve(context_, -gradient_));
    fall_ = -solved.col(0).dot(gradient_);
    Eigen::VectorXd step(2 * n);
    for (Index v = 0; v < n; ++v) {
      step.segment<2>(2 * v) = ways_[v] * solved.col(0).segment<2>(2 * v);
    }
    return step;
  }

  Status factorize(std::vector<Eigen::Triplet<double>> entries) {
    const Index n = surface_.vertexCount();
    // Shifts of a flat map cost nothing.
    if (plane_.isFlat() && options_.pulls.empty())
      addBlock(entries, anchor_, anchor_, Matrix2d::Identity());
    // What bound vertices cannot do.
    for (Index v = 0; v < n; ++v) {
      if (isBound(v)) entries.emplace_back(2 * v + 1, 2 * v + 1, 1.0);
    }
    SparseMatrix hessian(2 * n, 2 * n);
    hessian.setFromTriplets(entries.begin(), entries.end());
    if (solver_) return solver_->refactorize(context_, hessian);
    ASSIGN_OR_RETURN(SpdSolver made, SpdSolver::make(context_, hessian));
    solver_.emplace(std::move(made));
    return {};
  }

  double relativeSize(const Eigen::VectorXd& step) const {
    std::vector<double> longest(surface_.vertexCount(), 0.0);
    for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
      double& most = longest[surface_.tail(h)];
      most = std::max(most, links_[h].col(2).head<2>().norm());
    }
    double worst = 0;
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      const double size = step.segment<2>(2 * v).norm();
      if (size > 0) worst = std::max(worst, size / std::max(longest[v], 1e-300));
    }
    return worst;
  }

  /// Halves the step until the energy falls. False where rounding hides whether it does.
  bool take(Eigen::VectorXd step, double& energy) {
    double fall = fall_;
    // The sum's own rounding: below that a full step of Newton's method is right.
    const double rounding = 1e-13 * energy;
    for (int n = 0; n < kMostHalvings; ++n) {
      VertexLinks links = links_;
      std::vector<Motion> moves = moves_;
      move(step, links, moves);
      const double after = totalEnergy(links, moves);
      if (after <= energy - kArmijo * fall + rounding) {
        links_ = std::move(links);
        moves_ = std::move(moves);
        energy = after;
        return true;
      }
      step /= 2;
      fall /= 2;
    }
    return false;
  }

  void move(const Eigen::VectorXd& step, VertexLinks& links, std::vector<Motion>& moves) const {
    std::vector<Motion> shift(surface_.vertexCount());
    for (Index v = 0; v < surface_.vertexCount(); ++v) {
      shift[v] = plane_.shift(step.segment<2>(2 * v));
      moves[v] = plane_.normalized(Motion(moves[v] * shift[v]));
    }
    for (Index e = 0; e < surface_.edgeCount(); ++e) {
      const Index h = surface_.halfedge(e);
      links[h] = plane_.normalized(
          Motion(plane_.inverse(shift[surface_.tail(h)]) * links[h] * shift[surface_.head(h)]));
      if (surface_.twin(h) != kNone) links[surface_.twin(h)] = plane_.inverse(links[h]);
    }
  }

  Context& context_;
  CoverPlane plane_;
  const Connectivity& surface_;
  const std::vector<double>& weights_;
  const HarmonicOptions& options_;
  VertexLinks links_;
  std::vector<Motion> moves_;
  /// Per vertex what it can do: all, or go along one direction.
  std::vector<Matrix2d> ways_;
  Index anchor_ = 0;
  Eigen::VectorXd gradient_;
  double fall_ = 0;  ///< Of the energy along the last step, at its beginning.
  std::optional<SpdSolver> solver_;
};

/// From a frame at the third corner of the face of h to that at h's tail.
Motion thirdLink(const Connectivity& surface, const VertexLinks& links, Index h) {
  const Index back = surface.twin(Connectivity::previous(h));
  return back == kNone ? Motion(links[h] * links[Connectivity::next(h)]) : links[back];
}

/// The neighbours that a face has at the tail of h, seen from there: h's head and the third corner.
std::array<std::complex<double>, 2> sidesAt(const Connectivity& surface, const VertexLinks& links,
                                            Index h) {
  const Motion &to = links[h], back = thirdLink(surface, links, h);
  return {std::complex<double>(to(0, 2), to(1, 2)) / to(2, 2),
          std::complex<double>(back(0, 2), back(1, 2)) / back(2, 2)};
}

}  // namespace

Result<HarmonicMap> harmonicMap(Context& context, Geometry geometry, const Connectivity& surface,
                                const std::vector<double>& weights, VertexLinks start,
                                const HarmonicOptions& options) {
  const auto is = [](std::size_t size, Index count) {
    return size == static_cast<std::size_t>(count);
  };
  if (!is(weights.size(), surface.edgeCount()) || !is(start.size(), surface.halfedgeCount()) ||
      !(options.pulls.empty() || is(options.pulls.size(), surface.vertexCount())) ||
      !(options.slides.empty() || is(options.slides.size(), surface.vertexCount())) ||
      !(options.moves.empty() || is(options.moves.size(), surface.vertexCount()))) {
    return Status(Reason::kInvalidOption,
                  "weights, links, pulls, slides or moves are not one for each element");
  }
  return HarmonicSearch(context, geometry, surface, weights, std::move(start), options).run();
}

std::vector<double> positiveWeights(const Connectivity& surface,
                                    const std::vector<double>& lengths) {
  std::vector<double> weights = cotanWeights(surface, lengths);
  std::vector<double> sizes(weights.size());
  std::transform(weights.begin(), weights.end(), sizes.begin(),
                 [](double w) { return std::abs(w); });
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  for (double& w : weights) w = std::clamp(w, kLeastWeight * *middle, *middle / kLeastWeight);
  return weights;
}

std::vector<bool> foldedFaces(const Connectivity& surface, const VertexLinks& links) {
  std::vector<bool> folded(surface.faceCount());
  for (Index f = 0; f < surface.faceCount(); ++f) {
    // The corner of the largest angle tells best: opposite the longest side.
    Index corner = 3 * f;
    double longest = 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const double length = links[h].col(2).head<2>().norm();
      if (!(length > longest)) continue;
      longest = length;
      corner = Connectivity::previous(h);
    }
    const auto sides = sidesAt(surface, links, corner);
    folded[f] = spherical::orientationSign(0.0, sides[0], sides[1]) <= 0;
  }
  return folded;
}

Index countFolded(const Connectivity& surface, const VertexLinks& links) {
  const std::vector<bool> folded = foldedFaces(surface, links);
  return static_cast<Index>(std::count(folded.begin(), folded.end(), true));
}

double coveredArea(Geometry geometry, const Connectivity& surface, const VertexLinks& links) {
  const CoverPlane plane(geometry);
  double sum = 0;
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    sum += plane.area(links[h].col(2), thirdLink(surface, links, h).col(2));
  }
  return sum;
}

double closureResidual(const Connectivity& surface, const VertexLinks& links) {
  double worst = 0;
  for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
    worst = std::max(worst, distanceToUnit(links[h] * links[h + 1] * links[h + 2]));
  }
  return worst;
}

}  // namespace moduli
