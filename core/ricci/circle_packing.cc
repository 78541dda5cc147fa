#include "core/ricci/circle_packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/ricci/face_thirds.h"

namespace moduli {
namespace {

/// Elements that one thread does at least: some milliseconds, far more than starting it takes.
constexpr std::size_t kGrain = 8192;
/// Beyond it products of hyperbolic sines leave the doubles.
constexpr double kLongestHyperbolic = 700;
/// A clamp that moves I by less is one of rounding.
constexpr double kClamped = 1e-9;

template <typename Body>
void forEach(Index count, const Body& body) {
  parallelBlocks(static_cast<std::size_t>(count), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) body(static_cast<Index>(k));
  });
}

/// log tanh(x / 2) for x > 0, which is its own inverse but for signs: the x of the value y is
/// -logTanhHalf(-y).
double logTanhHalf(double x) {
  return x < 1 ? std::log(std::tanh(x / 2)) : -2 * std::atanh(std::exp(-x));
}

double unknownOfRadius(Geometry geometry, double radius) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return std::log(radius);
    case Geometry::kHyperbolic:
      return logTanhHalf(radius);
    case Geometry::kSpherical:
      return std::log(std::tan(radius / 2));
  }
  return 0;
}

/// A radius with its F and C: identity and 1, sinh and cosh, sin and cos.
struct Circle {
  double radius = 0;
  double sine = 0;
  double cosine = 1;
};

Circle circleOf(Geometry geometry, double u) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return {std::exp(u), std::exp(u), 1};
    case Geometry::kHyperbolic:
      return {-logTanhHalf(-u), -1 / std::sinh(u), -1 / std::tanh(u)};
    case Geometry::kSpherical:
      return {2 * std::atan(std::exp(u)), 1 / std::cosh(u), -std::tanh(u)};
  }
  return {};
}

/// The I of circles with these radii whose centres are `length` apart: the length law, solved.
double inversiveDistance(Geometry geometry, double length, double a, double b) {
  const double sum = a + b;
  return 1 + 2 * (halfChord(geometry, length + sum) / halfChord(geometry, 2 * a)) *
                 (halfChord(geometry, length - sum) / halfChord(geometry, 2 * b));
}

double circleLength(Geometry geometry, double a, double b, double distance) {
  const double across = std::sqrt((distance + 1) / 2) * std::sqrt(halfChord(geometry, 2 * a)) *
                        std::sqrt(halfChord(geometry, 2 * b));
  const double chord = std::hypot(halfChord(geometry, a - b), across);
  return lengthOfHalfChord(geometry,
                           geometry == Geometry::kSpherical ? std::min(1.0, chord) : chord);
}

/// Per vertex the radii that its faces by themselves would give it, put together.
struct CornerRadii {
  std::vector<double> least, mean, largest;
};

CornerRadii cornerRadii(const Connectivity& surface, const std::vector<double>& lengths) {
  const Index count = surface.vertexCount();
  CornerRadii radii{std::vector<double>(count, std::numeric_limits<double>::infinity()),
                    std::vector<double>(count, 0.0), std::vector<double>(count, 0.0)};
  std::vector<Index> degree(count, 0);
  for (Index h = 0; h < surface.halfedgeCount(); ++h) {
    const double left = lengths[surface.edge(Connectivity::previous(h))];
    const double right = lengths[surface.edge(h)];
    const double opposite = lengths[surface.edge(Connectivity::next(h))];
    // The longer side and the opposite one first: of similar size where the radius is small.
    const double radius = (std::min(left, right) + (std::max(left, right) - opposite)) / 2;
    const Index v = surface.tail(h);
    radii.least[v] = std::min(radii.least[v], radius);
    radii.largest[v] = std::max(radii.largest[v], radius);
    radii.mean[v] += radius;
    ++degree[v];
  }
  for (Index v = 0; v < count; ++v) radii.mean[v] /= degree[v];
  return radii;
}

/// The sum over edges of |log| of the factor by which clamping I to [0, 1] changes the length.
double changeByClamping(const Connectivity& surface, Geometry geometry,
                        const std::vector<double>& lengths, const std::vector<double>& radii) {
  double change = 0;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const double a = radii[surface.tail(surface.halfedge(e))];
    const double b = radii[surface.head(surface.halfedge(e))];
    const double distance = inversiveDistance(geometry, lengths[e], a, b);
    const double clamped = circleLength(geometry, a, b, std::clamp(distance, 0.0, 1.0));
    change += std::abs(std::log(clamped / lengths[e]));
  }
  return change;
}

Status tooLong(std::string what) {
  return {Reason::kNoConvergence, "the step is too long: " + std::move(what), "take a shorter one"};
}

}  // namespace

Result<CirclePackingModel> CirclePackingModel::make(Connectivity surface, Geometry geometry,
                                                    Scheme scheme,
                                                    const std::vector<double>& lengths) {
  if (scheme == Scheme::kVertexScaling) {
    return Status{Reason::kInvalidOption, "vertex scaling is no scheme of circle packings"};
  }
  if (lengths.size() != static_cast<std::size_t>(surface.edgeCount())) {
    return Status{Reason::kInvalidOption, std::to_string(lengths.size()) + " lengths for " +
                                              std::to_string(surface.edgeCount()) + " edges"};
  }
  CirclePackingModel model(std::move(surface), geometry);
  model.lengths_ = lengths;
  RETURN_IF_ERROR(model.checkLengths());
  model.findRadii(scheme);
  model.findDistances(scheme);
  model.makePattern();
  return model;
}

TriangleValues CirclePackingModel::sides(Index f) const {
  return {lengths_[surface_.edge(3 * f + 1)], lengths_[surface_.edge(3 * f + 2)],
          lengths_[surface_.edge(3 * f)]};
}

Status CirclePackingModel::checkLengths() const {
  for (Index f = 0; f < surface_.faceCount(); ++f) {
    const TriangleValues side = sides(f);
    const double perimeter = side[0] + side[1] + side[2];
    const bool fits = std::isfinite(perimeter) &&
                      (geometry_ != Geometry::kSpherical || perimeter < 2 * std::numbers::pi);
    if (fits && !isBrokenTriangle(side)) continue;
    return {Reason::kInvalidOption,
            "the lengths of face " + std::to_string(f) + " make no proper triangle",
            "mollify the metric first"};
  }
  return {};
}

void CirclePackingModel::findRadii(Scheme scheme) {
  CornerRadii radii = cornerRadii(surface_, lengths_);
  const auto change = [&](const std::vector<double>& chosen) {
    return changeByClamping(surface_, geometry_, lengths_, chosen);
  };
  if (scheme == Scheme::kInversiveDistance) {
    radius_ = std::move(radii.least);
  } else if (scheme == Scheme::kThurston && change(radii.largest) <= change(radii.mean)) {
    radius_ = std::move(radii.largest);
  } else {
    radius_ = std::move(radii.mean);
  }
  initial_.resize(size());
  for (Index v = 0; v < surface_.vertexCount(); ++v) {
    initial_[v] = unknownOfRadius(geometry_, radius_[v]);
  }
}

void CirclePackingModel::findDistances(Scheme scheme) {
  distance_.assign(surface_.edgeCount(), 1.0);
  root_.assign(surface_.edgeCount(), 1.0);
  if (scheme == Scheme::kTangential) return;
  Index clamped = 0;
  for (Index e = 0; e < surface_.edgeCount(); ++e) {
    const Index h = surface_.halfedge(e);
    const double given = inversiveDistance(geometry_, lengths_[e], radius_[surface_.tail(h)],
                                           radius_[surface_.head(h)]);
    distance_[e] = scheme == Scheme::kThurston ? std::clamp(given, 0.0, 1.0) : given;
    if (std::abs(given - distance_[e]) > kClamped) ++clamped;
    root_[e] = std::sqrt((distance_[e] + 1) / 2);
  }
  if (scheme == Scheme::kThurston) clamped_fraction_ = 1.0 * clamped / surface_.edgeCount();
}

void CirclePackingModel::makePattern() {
  // Edges by column (their lower vertex), then by row: edges between the same vertices share an
  // entry, and loops that of the diagonal.
  const Index count = surface_.vertexCount();
  std::vector<std::vector<std::pair<Index, Index>>> columns(count);
  for (Index e = 0; e < surface_.edgeCount(); ++e) {
    const Index h = surface_.halfedge(e);
    const auto [column, row] = std::minmax({surface_.tail(h), surface_.head(h)});
    columns[column].emplace_back(row, e);
  }
  slot_.resize(surface_.edgeCount());
  hessian_.resize(count, count);
  hessian_.reserve(static_cast<Eigen::Index>(surface_.edgeCount()) + count);
  for (Index column = 0; column < count; ++column) {
    hessian_.startVec(column);
    hessian_.insertBack(column, column) = 0;
    Index last = column;
    std::sort(columns[column].begin(), columns[column].end());
    for (const auto& [row, e] : columns[column]) {
      if (row != last) hessian_.insertBack(row, column) = 0;
      last = row;
      slot_[e] = static_cast<Index>(hessian_.data().size()) - 1;
    }
  }
  hessian_.finalize();
}

Status CirclePackingModel::moveTo(Context& context, const Eigen::VectorXd& u) {
  RETURN_IF_ERROR(context.check());
  if (u.size() != size()) {
    return {Reason::kInvalidOption,
            std::to_string(u.size()) + " unknowns for " + std::to_string(size()) + " vertices"};
  }
  if (!u.allFinite()) return tooLong("an unknown is not finite");
  if (geometry_ == Geometry::kHyperbolic && u.maxCoeff() >= 0) {
    return tooLong("a hyperbolic circle has no finite radius");
  }
  measureCircles(u);
  measureEdges();
  RETURN_IF_ERROR(checkEdges());
  measureFaces();
  curvature_.resize(size());
  for (Index v = 0; v < surface_.vertexCount(); ++v) {
    curvature_[v] = surface_.isBoundaryVertex(v) ? std::numbers::pi : 2 * std::numbers::pi;
  }
  for (Index h = 0; h < surface_.halfedgeCount(); ++h) curvature_[surface_.tail(h)] -= angles_[h];
  return {};
}

void CirclePackingModel::measureCircles(const Eigen::VectorXd& u) {
  radius_.resize(surface_.vertexCount());
  sine_.resize(surface_.vertexCount());
  cosine_.resize(surface_.vertexCount());
  forEach(surface_.vertexCount(), [&](Index v) {
    const Circle circle = circleOf(geometry_, u[v]);
    radius_[v] = circle.radius;
    sine_[v] = circle.sine;
    cosine_[v] = circle.cosine;
  });
}

void CirclePackingModel::measureEdges() {
  // The length law in half chords, a sum of positive terms:
  // x(l)^2 = x(r_i - r_j)^2 + (I + 1) / 2 F(r_i) F(r_j).
  forEach(surface_.edgeCount(), [&](Index e) {
    const Index i = surface_.tail(surface_.halfedge(e));
    const Index j = surface_.head(surface_.halfedge(e));
    const double across = root_[e] * std::sqrt(sine_[i]) * std::sqrt(sine_[j]);
    const double chord = std::hypot(halfChord(geometry_, radius_[i] - radius_[j]), across);
    lengths_[e] = lengthOfHalfChord(geometry_, chord);
  });
}

Status CirclePackingModel::checkEdges() const {
  const double longest = geometry_ == Geometry::kHyperbolic
                             ? kLongestHyperbolic
                             : std::numeric_limits<double>::max() / 4;
  for (Index e = 0; e < surface_.edgeCount(); ++e) {
    if (lengths_[e] > 0 && lengths_[e] < longest) continue;
    return tooLong("edge " + std::to_string(e) + " has no length that a double holds");
  }
  if (geometry_ != Geometry::kSpherical) return {};
  for (Index f = 0; f < surface_.faceCount(); ++f) {
    const TriangleValues side = sides(f);
    if (side[0] + side[1] + side[2] < 2 * std::numbers::pi) continue;
    return tooLong("face " + std::to_string(f) + " is too large for the sphere");
  }
  return {};
}

void CirclePackingModel::measureFaces() {
  angles_.resize(surface_.halfedgeCount());
  forEach(surface_.faceCount(), [&](Index f) {
    const TriangleValues angle = triangleAngles(geometry_, sides(f));
    for (int c = 0; c < 3; ++c) angles_[3 * f + c] = angle[c];
  });
}

void CirclePackingModel::differentiateFace(Index f) {
  const TriangleValues side = sides(f);
  const TriangleValues angle{angles_[3 * f], angles_[3 * f + 1], angles_[3 * f + 2]};
  const TriangleMatrix by_sides = angleDerivatives(geometry_, side, angle);
  // Row c: how the side opposite corner c grows with the u of the corners; not with its own.
  TriangleMatrix sides_by_u{};
  const Triangle& corner = surface_.face(f);
  for (int c = 0; c < 3; ++c) {
    const double distance = distance_[surface_.edge(3 * f + (c + 1) % 3)];
    const double divisor = halfChord(geometry_, 2 * side[c]);  // F(l).
    for (int k = 1; k < 3; ++k) {
      const Index i = corner[(c + k) % 3];
      const Index j = corner[(c + 3 - k) % 3];
      sides_by_u[c][(c + k) % 3] =
          (sine_[i] / divisor) * (sine_[i] * cosine_[j] + distance * cosine_[i] * sine_[j]);
    }
  }
  TriangleMatrix matrix{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int c = 0; c < 3; ++c) matrix[i][j] -= by_sides[i][c] * sides_by_u[c][j];
    }
  }
  for (int c = 0; c < 3; ++c) {
    own_[3 * f + c] = matrix[c][c];
    cross_[3 * f + c] = (matrix[c][(c + 1) % 3] + matrix[(c + 1) % 3][c]) / 2;
  }
}

const SparseMatrix& CirclePackingModel::hessian() {
  own_.resize(surface_.halfedgeCount());
  cross_.resize(surface_.halfedgeCount());
  forEach(surface_.faceCount(), [&](Index f) { differentiateFace(f); });
  double* values = hessian_.valuePtr();
  std::fill(values, values + hessian_.nonZeros(), 0.0);
  for (Index h = 0; h < surface_.halfedgeCount(); ++h) {
    const Index i = surface_.tail(h);
    values[hessian_.outerIndexPtr()[i]] += own_[h];
    // A loop's two entries above and below the diagonal both fall on it.
    values[slot_[surface_.edge(h)]] += i == surface_.head(h) ? 2 * cross_[h] : cross_[h];
  }
  return hessian_;
}

TriangleValues CirclePackingModel::contractFace(Index f, const SparseMatrix& weights) const {
  CircleFace face;
  face.side = sides(f);
  TriangleMatrix at_corners{};
  const Triangle& corner = surface_.face(f);
  for (int c = 0; c < 3; ++c) {
    const int next = (c + 1) % 3;
    face.sine[c] = sine_[corner[c]];
    face.cosine[c] = cosine_[corner[c]];
    face.distance[c] = distance_[surface_.edge(3 * f + next)];
    face.angle[c] = angles_[3 * f + c];
    at_corners[c][c] = weights.valuePtr()[weights.outerIndexPtr()[corner[c]]];
    at_corners[c][next] = at_corners[next][c] = weights.valuePtr()[slot_[surface_.edge(3 * f + c)]];
  }
  // The curvature falls where the angles grow.
  TriangleValues result = contract(circleFaceThirds(geometry_, face), at_corners);
  for (double& value : result) value = -value;
  return result;
}

Eigen::VectorXd CirclePackingModel::thirdContraction(const SparseMatrix& weights) const {
  std::vector<double> at_corners(static_cast<std::size_t>(surface_.halfedgeCount()));
  forEach(surface_.faceCount(), [&](Index f) {
    const TriangleValues values = contractFace(f, weights);
    std::copy(values.begin(), values.end(), &at_corners[3 * f]);
  });
  Eigen::VectorXd result = Eigen::VectorXd::Zero(size());
  for (Index h = 0; h < surface_.halfedgeCount(); ++h) result[surface_.tail(h)] += at_corners[h];
  return result;
}

Index CirclePackingModel::brokenFaces() const {
  Index broken = 0;
  for (Index f = 0; f < surface_.faceCount(); ++f) broken += isBrokenTriangle(sides(f)) ? 1 : 0;
  return broken;
}

}  // namespace moduli
