#include "core/ricci/vertex_scaling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "core/intrinsic/delaunay.h"
#include "core/ricci/face_thirds.h"
#include "core/ricci/scaled_face.h"
#include "core/ricci/vertex_relaxation.h"
#include "core/ricci/vertex_scaling_energy.h"

namespace moduli {
namespace {

constexpr std::size_t kGrain = 4096;
/// e^{u / 2} and its products with half chords stay far from the ends of a double's range.
constexpr double kMaxFactor = 600;
constexpr int kMaxRelaxations = 10;

}  // namespace

Unknowns Unknowns::all(Index vertices) {
  Unknowns unknowns;
  unknowns.of_vertex.resize(vertices);
  std::iota(unknowns.of_vertex.begin(), unknowns.of_vertex.end(), 0);
  unknowns.count = vertices;
  return unknowns;
}

VertexScalingModel::VertexScalingModel(Geometry geometry, IntrinsicTriangulation triangulation,
                                       Unknowns unknowns, Flips flips)
    : geometry_(geometry),
      triangulation_(std::move(triangulation)),
      unknowns_(std::move(unknowns)),
      flips_(flips),
      on_boundary_(triangulation_.vertexCount(), false),
      accepted_flips_(triangulation_.history().size()),
      base_(Eigen::VectorXd::Zero(unknowns_.count)),
      change_(triangulation_.vertexCount(), 0.0),
      scale_(triangulation_.vertexCount(), 1.0),
      scaled_(triangulation_.halfedgeCount()),
      half_tangents_(triangulation_.halfedgeCount()),
      angles_(triangulation_.halfedgeCount()),
      curvature_(Eigen::VectorXd::Zero(unknowns_.count)) {
  for (Index h = 0; h < triangulation_.halfedgeCount(); ++h) {
    if (triangulation_.twin(h) != kNone) continue;
    on_boundary_[triangulation_.tail(h)] = on_boundary_[triangulation_.head(h)] = true;
  }
}

Status VertexScalingModel::moveTo(Context& context, const Eigen::VectorXd& u) {
  const Context::Stage stage(context, "metric");
  RETURN_IF_ERROR(context.check());
  if (!u.allFinite() || (u.size() > 0 && u.cwiseAbs().maxCoeff() > kMaxFactor)) {
    return {Reason::kNoConvergence, "a conformal factor leaves the range of numbers"};
  }
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    change_[v] = u[unknowns_.of_vertex[v]];
    scale_[v] = std::exp((base_[unknowns_.of_vertex[v]] + change_[v]) / 2);
  }
  if (flips_ == Flips::kOn) {
    const std::size_t before = triangulation_.history().size();
    triangulation_.undoTo(accepted_flips_);
    ASSIGN_OR_RETURN(const std::size_t flips,
                     flipToDelaunayPtolemy(context, triangulation_, scale_));
    if (flips > 0 || before != accepted_flips_) pattern_stale_ = true;
  }
  measure();
  // The sine of a hyperbolic side of hundreds is none.
  if (!curvature_.allFinite()) {
    return {Reason::kNoConvergence, "triangles leave the range of numbers"};
  }
  return {};
}

Result<bool> VertexScalingModel::relax(Context& context, const Eigen::VectorXd& target,
                                       const std::vector<bool>& fixed, double residual,
                                       Eigen::VectorXd& u) {
  if (flips_ == Flips::kOff) return false;
  const Context::Stage stage(context, "relax");
  const double above = std::min(1.0, residual);
  std::optional<VertexRelaxation> relaxation;
  std::vector<std::vector<Index>> orbits;
  bool changed = false;
  for (int round = 0; round < kMaxRelaxations; ++round) {
    std::vector<Index> bad;
    for (Index n = 0; n < unknowns_.count; ++n) {
      if (!fixed.empty() && fixed[n]) continue;
      if (std::abs(curvature_[n] - target[n]) > above) bad.push_back(n);
    }
    if (bad.empty()) break;
    if (!relaxation) {
      relaxation.emplace(geometry_, triangulation_, scale_);
      orbits.resize(unknowns_.count);
      for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
        orbits[unknowns_.of_vertex[v]].push_back(v);
      }
    }
    bool moved = false;
    for (const Index n : bad) {
      RETURN_IF_ERROR(context.check());
      ASSIGN_OR_RETURN(const double change,
                       relaxation->solve(context, orbits[n], target[n], above / 3));
      if (change == 0) continue;
      u[n] += change;
      for (const Index v : orbits[n]) change_[v] = u[n];
      moved = true;
    }
    if (!moved) break;
    changed = true;
    pattern_stale_ = true;
    measure();
  }
  return changed;
}

void VertexScalingModel::measure() {
  const auto faces = static_cast<std::size_t>(triangulation_.faceCount());
  std::vector<char> broken((faces + kGrain - 1) / kGrain, 0);
  parallelBlocks(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto h = static_cast<Index>(3 * f);
      TriangleValues sides;
      for (int c = 0; c < 3; ++c) {
        const double pair =
            scale_[triangulation_.tail(h + c)] * scale_[triangulation_.tail(h + (c + 1) % 3)];
        scaled_[h + c] = triangulation_.halfChord(h + c) * pair;
        sides[c] = scaled_[h + c];
      }
      const ScaledFace face = isNeedle(sides) ? needle(h) : scaledFace(geometry_, sides);
      if (!face.proper) broken[begin / kGrain] = 1;
      for (int c = 0; c < 3; ++c) {
        // Side c runs from corner c to the next; the corner opposite is the one after.
        const double t = face.half_tangent[(c + 1) % 3];
        half_tangents_[h + c] = t;
        angles_[h + c] = 2 * std::atan(t);
      }
    }
  });
  proper_ = true;
  for (const char block : broken) proper_ = proper_ && block == 0;

  curvature_.setZero();
  const std::vector<double> at_vertices = vertexCurvatures();
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    curvature_[unknowns_.of_vertex[v]] += at_vertices[v];
  }
}

ScaledFace VertexScalingModel::needle(Index h) const {
  TriangleValues sides;
  std::array<FineFactor, 3> factors;
  for (int c = 0; c < 3; ++c) {
    const Index v = triangulation_.tail(h + c);
    sides[c] = triangulation_.halfChord(h + c);
    factors[c] = {base_[unknowns_.of_vertex[v]], change_[v]};
  }
  return scaledNeedle(geometry_, sides, factors);
}

bool VertexScalingModel::setBase(const Eigen::VectorXd& base) {
  base_ = base;
  return true;
}

std::vector<double> VertexScalingModel::vertexCurvatures() const {
  std::vector<double> sums(triangulation_.vertexCount(), 0.0);
  for (Index h = 0; h < triangulation_.halfedgeCount(); ++h) {
    sums[triangulation_.tail(h)] += angles_[h];
  }
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    sums[v] = (on_boundary_[v] ? 1 : 2) * std::numbers::pi - sums[v];
  }
  return sums;
}

double VertexScalingModel::area() const {
  double total = 0;
  for (Index h = 0; h < triangulation_.halfedgeCount(); h += 3) {
    TriangleValues lengths;
    for (int c = 0; c < 3; ++c) lengths[c] = lengthOfHalfChord(geometry_, scaled_[h + c]);
    total += triangleArea(geometry_, lengths);
  }
  return total;
}

const SparseMatrix& VertexScalingModel::hessian() {
  if (pattern_stale_) {
    pattern_.build(triangulation_, unknowns_.of_vertex, unknowns_.count);
    pattern_stale_ = false;
    ++pattern_version_;
  }
  pattern_.fillHessian(geometry_, triangulation_, unknowns_.of_vertex, half_tangents_, scaled_);
  return pattern_.matrix();
}

double VertexScalingModel::energy() const {
  const auto faces = static_cast<std::size_t>(triangulation_.faceCount());
  std::vector<long double> sums((faces + kGrain - 1) / kGrain, 0);
  parallelBlocks(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    long double sum = 0;
    for (std::size_t f = begin; f < end; ++f) {
      TriangleValues logarithms, angles;
      for (int c = 0; c < 3; ++c) {
        // Side c runs from corner c to the next: it is opposite the one before.
        logarithms[(c + 2) % 3] = std::log(scaled_[3 * f + c]);
        angles[c] = angles_[3 * f + c];
      }
      sum += vertexScalingEnergyOf(geometry_, logarithms, angles) -
             std::numbers::pi * (logarithms[0] + logarithms[1] + logarithms[2]);
    }
    sums[begin / kGrain] = sum;
  });
  long double total = std::accumulate(sums.begin(), sums.end(), 0.0L);
  for (Index v = 0; v < triangulation_.vertexCount(); ++v) {
    const double wanted = (on_boundary_[v] ? 1 : 2) * std::numbers::pi;
    total += wanted * (base_[unknowns_.of_vertex[v]] + change_[v]);
  }
  return static_cast<double>(total);
}

TriangleValues VertexScalingModel::contractFace(Index h, const SparseMatrix& weights) const {
  TriangleValues tangents, sides;
  TriangleMatrix at_corners{};
  for (int c = 0; c < 3; ++c) {
    tangents[c] = half_tangents_[h + c];
    sides[c] = scaled_[h + (c + 1) % 3];
    if (!(tangents[c] > 0)) return {};
    const Index diagonal = pattern_.diagonal(unknowns_.of_vertex[triangulation_.tail(h + c)]);
    const Index slot = pattern_.slot(h + c) == kNone ? diagonal : pattern_.slot(h + c);
    const int next = (c + 1) % 3;
    at_corners[c][c] = weights.valuePtr()[diagonal];
    at_corners[c][next] = at_corners[next][c] = weights.valuePtr()[slot];
  }
  // The curvature falls where the angles grow.
  TriangleValues result = contract(scaledFaceThirds(geometry_, tangents, sides), at_corners);
  for (double& value : result) value = -value;
  return result;
}

Eigen::VectorXd VertexScalingModel::thirdContraction(const SparseMatrix& weights) const {
  const auto faces = static_cast<std::size_t>(triangulation_.faceCount());
  std::vector<double> at_corners(3 * faces);
  parallelBlocks(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const TriangleValues values = contractFace(static_cast<Index>(3 * f), weights);
      std::copy(values.begin(), values.end(), &at_corners[3 * f]);
    }
  });
  Eigen::VectorXd result = Eigen::VectorXd::Zero(size());
  for (Index h = 0; h < triangulation_.halfedgeCount(); ++h) {
    result[unknowns_.of_vertex[triangulation_.tail(h)]] += at_corners[h];
  }
  return result;
}

}  // namespace moduli
