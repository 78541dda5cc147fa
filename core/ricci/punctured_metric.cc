#include "core/ricci/punctured_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/intrinsic/delaunay.h"
#include "core/ricci/scaled_face.h"

namespace moduli {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr double kMaxFactor = 600;
constexpr std::size_t kFlipsPerCheck = 4096;
constexpr std::size_t kMaxFlipsPerEdge = 100;

Index next(Index h) {
  return Connectivity::next(h);
}
Index previous(Index h) {
  return Connectivity::previous(h);
}

}  // namespace

PuncturedMetric::PuncturedMetric(IntrinsicTriangulation triangulation, Index infinity,
                                 Unknowns unknowns)
    : triangulation_(std::move(triangulation)),
      infinity_(infinity),
      unknowns_(std::move(unknowns)),
      accepted_flips_(triangulation_.history().size()),
      base_(Eigen::VectorXd::Zero(triangulation_.vertexCount())),
      u_(Eigen::VectorXd::Zero(triangulation_.vertexCount())),
      scale_(triangulation_.vertexCount(), 1.0),
      linked_(triangulation_.vertexCount(), false),
      scaled_(triangulation_.halfedgeCount(), 1.0),
      half_tangents_(triangulation_.halfedgeCount(), 0.0),
      angles_(triangulation_.halfedgeCount(), 0.0),
      angle_sums_(triangulation_.vertexCount(), 0.0) {}

bool PuncturedMetric::finiteFace(Index h) const {
  return triangulation_.tail(h) != infinity_ && triangulation_.tail(next(h)) != infinity_ &&
         triangulation_.tail(previous(h)) != infinity_;
}

double PuncturedMetric::half(Index h) const {
  return triangulation_.halfChord(h) *
         (scale_[triangulation_.tail(h)] * scale_[triangulation_.head(h)]);
}

void PuncturedMetric::setU(Index v, double value) {
  u_[v] = value;
  scale_[v] = std::exp((base_[v] + value) / 2);
}

void PuncturedMetric::joinLink(Index v, Index spoke) {
  const double bound = -2 * std::log(triangulation_.halfChord(spoke)) - base_[v];
  // With two arcs to infinity the shorter one rules.
  setU(v, linked_[v] ? std::max(u_[v], bound) : bound);
  linked_[v] = true;
}

void PuncturedMetric::findLink() {
  std::fill(linked_.begin(), linked_.end(), false);
  for (Index h = 0; h < triangulation_.halfedgeCount(); ++h) {
    if (triangulation_.tail(h) == infinity_) joinLink(triangulation_.head(h), h);
  }
}

bool PuncturedMetric::broken(Index h) const {
  return half(h) >= half(next(h)) + half(previous(h));
}

/// Whether the edge of h, seen from a finite face, has to be flipped.
bool PuncturedMetric::needsWork(Index h) const {
  if (!triangulation_.canFlip(h) || !finiteFace(h)) return false;
  const Index t = triangulation_.twin(h);
  if (!finiteFace(t)) return broken(h);
  const double e = half(h), a = half(next(h)), b = half(previous(h));
  const double c = half(next(t)), d = half(previous(t));
  return delaunaySlack(e, a, b, c, d) < -slackTolerance(e, a, b, c, d);
}

/// The vertex opposite h, a link edge, is beyond it: it gets an arc to infinity.
void PuncturedMetric::expose(Index h) {
  triangulation_.flip(h, triangulation_.ptolemyDiagonal(h));
  // h runs between infinity and the exposed vertex now.
  const bool outward = triangulation_.tail(h) == infinity_;
  const Index spoke = outward ? triangulation_.twin(h) : h;
  joinLink(triangulation_.tail(spoke), spoke);
  // Its u has changed: all faces around it are to be looked at again.
  for (Index g = spoke;;) {
    work_.push_back(g);
    work_.push_back(next(g));
    work_.push_back(triangulation_.twin(next(g)));
    g = triangulation_.twin(previous(g));
    if (g == spoke) break;
  }
}

Status PuncturedMetric::flipAll(Context& context) {
  const auto count = static_cast<std::size_t>(triangulation_.halfedgeCount());
  std::vector<std::vector<Index>> found((count + kGrain - 1) / kGrain);
  parallelBlocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const auto h = static_cast<Index>(n);
      const Index twin = triangulation_.twin(h);
      if ((twin > h || !finiteFace(twin)) && needsWork(h)) found[begin / kGrain].push_back(h);
    }
  });
  work_.clear();
  for (const std::vector<Index>& block : found) {
    work_.insert(work_.end(), block.begin(), block.end());
  }
  std::size_t flips = 0;
  while (!work_.empty()) {
    Index h = work_.back();
    work_.pop_back();
    if (!finiteFace(h)) h = triangulation_.twin(h);
    if (!needsWork(h)) continue;
    const Index t = triangulation_.twin(h);
    if (finiteFace(t)) {
      triangulation_.flip(h, triangulation_.ptolemyDiagonal(h));
      for (const Index g : {next(h), previous(h), next(t), previous(t)}) work_.push_back(g);
    } else {
      expose(h);
    }
    if (++flips % kFlipsPerCheck == 0) RETURN_IF_ERROR(context.check());
    if (flips > kMaxFlipsPerEdge * count) {
      return {Reason::kNoConvergence, "Delaunay flips did not end after " + std::to_string(flips)};
    }
  }
  return {};
}

Status PuncturedMetric::moveTo(Context& context, const Eigen::VectorXd& u) {
  const Context::Stage stage(context, "metric");
  RETURN_IF_ERROR(context.check());
  if (!u.allFinite() || u.cwiseAbs().maxCoeff() > kMaxFactor) {
    return {Reason::kNoConvergence, "a conformal factor leaves the range of numbers"};
  }
  const std::size_t before = triangulation_.history().size();
  triangulation_.undoTo(accepted_flips_);
  if (before != accepted_flips_) pattern_stale_ = true;
  u_ = u;
  u_[infinity_] = 0;
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) setU(v, u_[v]);
  findLink();
  RETURN_IF_ERROR(flipAll(context));
  if (triangulation_.history().size() != accepted_flips_) pattern_stale_ = true;
  measure();
  return {};
}

void PuncturedMetric::accept() {
  accepted_flips_ = triangulation_.history().size();
}

bool PuncturedMetric::release(Index vertex) {
  Index spoke = kNone;
  Index degree = 0;
  for (Index h = 0; h < triangulation_.halfedgeCount(); ++h) {
    if (triangulation_.tail(h) != infinity_) continue;
    ++degree;
    if (triangulation_.head(h) == vertex) spoke = h;
  }
  if (spoke == kNone || degree <= 3 || !triangulation_.canFlip(spoke)) return false;
  // From infinity to the vertex; its neighbours on the link are the two opposite corners.
  const double a = half(next(spoke)), b = half(previous(triangulation_.twin(spoke)));
  const double angle = angle_sums_[vertex];
  triangulation_.flip(spoke, triangulation_.ptolemyDiagonal(spoke));
  accepted_flips_ = triangulation_.history().size();
  pattern_stale_ = true;
  // Sides a s, b s over the base a + b with the angle 2 pi - angle between them.
  const double square = a * a + b * b - 2 * a * b * std::cos(angle);
  setU(vertex, u_[vertex] + 2 * std::log((a + b) / std::sqrt(square)));
  return true;
}

ScaledFace PuncturedMetric::needle(Index h) const {
  TriangleValues sides;
  std::array<FineFactor, 3> factors;
  for (int c = 0; c < 3; ++c) {
    const Index v = triangulation_.tail(h + c);
    sides[c] = triangulation_.halfChord(h + c);
    factors[c] = {base_[v], u_[v]};
  }
  return scaledNeedle(Geometry::kEuclidean, sides, factors);
}

void PuncturedMetric::measure() {
  const auto faces = static_cast<std::size_t>(triangulation_.faceCount());
  parallelBlocks(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto h = static_cast<Index>(3 * f);
      const bool finite = finiteFace(h);
      TriangleValues sides;
      for (int c = 0; c < 3; ++c) {
        const bool spoke =
            triangulation_.tail(h + c) == infinity_ || triangulation_.head(h + c) == infinity_;
        sides[c] = scaled_[h + c] = spoke ? 1 : half(h + c);
      }
      ScaledFace face{{0, 0, 0}, true};
      if (finite) {
        face = isNeedle(sides) ? needle(h) : scaledFace(Geometry::kEuclidean, sides);
      }
      for (int c = 0; c < 3; ++c) {
        const double t = face.half_tangent[(c + 1) % 3];
        half_tangents_[h + c] = t;
        angles_[h + c] = 2 * std::atan(t);
      }
    }
  });
  std::fill(angle_sums_.begin(), angle_sums_.end(), 0.0);
  for (Index h = 0; h < triangulation_.halfedgeCount(); ++h) {
    angle_sums_[triangulation_.tail(h)] += angles_[h];
  }
}

/// Per vertex its unknown, kNone where a vertex of the orbit is not free.
std::vector<Index> PuncturedMetric::freeUnknowns() const {
  std::vector<bool> held(unknowns_.count, false);
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    if (!isFree(v)) held[unknowns_.of_vertex[v]] = true;
  }
  std::vector<Index> unknown = unknowns_.of_vertex;
  for (Index& n : unknown) {
    if (held[n]) n = kNone;
  }
  return unknown;
}

Eigen::VectorXd PuncturedMetric::gradient() const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns_.count);
  const std::vector<Index> unknown = freeUnknowns();
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    if (unknown[v] != kNone) gradient[unknown[v]] += 2 * std::numbers::pi - angle_sums_[v];
  }
  return gradient;
}

double PuncturedMetric::residual() const {
  double largest = 0;
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    if (isFree(v)) largest = std::max(largest, std::abs(2 * std::numbers::pi - angle_sums_[v]));
  }
  return largest;
}

const SparseMatrix& PuncturedMetric::hessian() {
  const std::vector<Index> unknown = freeUnknowns();
  if (pattern_stale_) {
    pattern_.build(triangulation_, unknown, unknowns_.count);
    pattern_stale_ = false;
    ++pattern_version_;
  }
  pattern_.fillHessian(Geometry::kEuclidean, triangulation_, unknown, half_tangents_, scaled_);
  SparseMatrix& matrix = pattern_.matrix();
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    if (unknown[v] == kNone) {
      matrix.valuePtr()[pattern_.diagonal(unknowns_.of_vertex[v])] = 1;
    }
  }
  return matrix;
}

}  // namespace moduli
