#include "core/spherical/field_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/parallel.h"

namespace moduli {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// Points with values of the first field and weights of sum 1.
struct Sample {
  Eigen::Vector3d point;
  double value = 0, weight = 0;
};
using Samples = std::vector<Sample>;

/// A field on the six sides of a cube, cells of equal angle: a value in no time.
class CubeRaster {
 public:
  explicit CubeRaster(const SphereField& field) : values_(std::size_t{6} * kSide * kSide) {
    parallelBlocks(values_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell) {
        values_[cell] =
            valueAt(field.sphere.surface(), field.values, field.sphere.locate(centre(cell)));
      }
    });
  }

  double operator()(const Eigen::Vector3d& p) const {
    Eigen::Index axis = 0;
    const double length = p.cwiseAbs().maxCoeff(&axis);
    const std::size_t side = 2 * axis + (p[axis] < 0 ? 1 : 0);
    return values_[(side * kSide + cell(p[(axis + 1) % 3] / length)) * kSide +
                   cell(p[(axis + 2) % 3] / length)];
  }

 private:
  static constexpr int kSide = 96;  // Cells of one degree.

  static std::size_t cell(double tangent) {
    // atan(t) to 0.005 radians, a quarter of a cell.
    const double angle = tangent * (std::numbers::pi / 4 + 0.273 * (1 - std::abs(tangent)));
    const double at = (angle / (std::numbers::pi / 2) + 0.5) * kSide;
    return std::clamp(static_cast<int>(at), 0, kSide - 1);
  }

  static Eigen::Vector3d centre(std::size_t cell) {
    const auto tangent = [](std::size_t i) {
      return std::tan((static_cast<double>(i) + 0.5 - 0.5 * kSide) * std::numbers::pi / 2 / kSide);
    };
    const std::size_t side = cell / (kSide * kSide);
    const auto axis = static_cast<int>(side / 2);
    Eigen::Vector3d p;
    p[axis] = side % 2 == 0 ? 1 : -1;
    p[(axis + 1) % 3] = tangent(cell / kSide % kSide);
    p[(axis + 2) % 3] = tangent(cell % kSide);
    return p.normalized();
  }

  std::vector<double> values_;
};

Samples allVertices(const SphereField& a, const std::vector<double>& weights) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  Samples samples;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    samples.push_back({a.sphere.points()[v], a.values[v], weights[v] / total});
  }
  return samples;
}

/// As many of the samples, of equal weight, drawn at even shares of the cumulated weight.
Samples thinned(const Samples& all, int count) {
  if (all.size() <= static_cast<std::size_t>(count)) return all;
  Samples samples;
  double sum = 0;
  for (const Sample& sample : all) {
    sum += sample.weight;
    while (static_cast<int>(samples.size()) < count &&
           (static_cast<double>(samples.size()) + 0.5) / count <= sum) {
      samples.push_back({sample.point, sample.value, 1.0 / count});
    }
  }
  return samples;
}

/// Weighted correlation of the samples with a field at the rotated places.
template <typename Field>
double correlationOf(const Samples& samples, const Field& field, const Eigen::Matrix3d& rotation) {
  std::vector<double> values(samples.size());
  double mean_a = 0, mean_b = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    values[i] = field(rotation * samples[i].point);
    mean_a += samples[i].weight * samples[i].value;
    mean_b += samples[i].weight * values[i];
  }
  double aa = 0, ab = 0, bb = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double a = samples[i].value - mean_a, b = values[i] - mean_b;
    aa += samples[i].weight * a * a;
    ab += samples[i].weight * a * b;
    bb += samples[i].weight * b * b;
  }
  // Less is what rounding leaves of a constant: 1e-12 of its size for sums over many vertices.
  if (!(aa > 1e-24 * mean_a * mean_a) || !(bb > 1e-24 * mean_b * mean_b)) return 0;
  return ab / std::sqrt(aa * bb);
}

/// Value and gradient (in space) of a field at a point of the sphere.
std::pair<double, Eigen::Vector3d> sampleField(const SphereField& field, const Eigen::Vector3d& q) {
  const SurfacePoint place = field.sphere.locate(q);
  const Triangle& face = field.sphere.surface().face(place.face);
  const Points3& p = field.sphere.points();
  const double value = valueAt(field.sphere.surface(), field.values, place);
  // The weights are those of q in the basis of the corners, over their sum. Their gradients are the
  // cross products of the other corners, over the volume.
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector3d& next = p[face[(c + 1) % 3]];
    const Eigen::Vector3d& last = p[face[(c + 2) % 3]];
    gradient += (field.values[face[c]] - value) * next.cross(last);
    corner += place.barycentric[c] * p[face[c]];
  }
  const double volume = p[face[0]].dot((p[face[1]] - p[face[0]]).cross(p[face[2]] - p[face[0]]));
  // q is the combination over its length: the basis weights of q sum to 1 / |combination|.
  return {value, gradient * (corner.norm() / volume)};
}

/// The regression of the first field on the second, and how it changes with the rotation.
class Regression {
 public:
  Regression(const Samples& samples, const SphereField& field, const Eigen::Matrix3d& rotation) {
    std::vector<std::pair<double, Eigen::Vector3d>> values;  // And turning moments.
    double mean_a = 0, mean_b = 0, variance = 0, covariance = 0;
    for (const Sample& sample : samples) {
      const Eigen::Vector3d q = rotation * sample.point;
      const auto [b, gradient] = sampleField(field, q);
      values.emplace_back(b, q.cross(gradient));
      mean_a += sample.weight * sample.value;
      mean_b += sample.weight * b;
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double b = values[i].first - mean_b;
      variance += samples[i].weight * b * b;
      covariance += samples[i].weight * b * (samples[i].value - mean_a);
    }
    slope_ = variance > 0 ? covariance / variance : 0;
    normal_.setZero();
    load_.setZero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double b = values[i].first - mean_b;
      const double off = samples[i].value - mean_a - slope_ * b;
      Vector5 row;
      row << slope_ * values[i].second, 1, b;
      normal_ += samples[i].weight * row * row.transpose();
      load_ += samples[i].weight * row * off;
      residual_ += samples[i].weight * off * off;
    }
  }

  /// Least sum of squares: the variance of the first field times 1 - correlation^2, without the
  /// cancellation.
  double residual() const { return residual_; }
  double slope() const { return slope_; }

  /// The turn that Gauss and Newton advise.
  Eigen::Vector3d turn() const {
    const double scale = 1e-14 * normal_.diagonal().maxCoeff();
    return (normal_ + scale * Matrix5::Identity()).ldlt().solve(load_).head<3>();
  }

 private:
  double slope_ = 0, residual_ = 0;
  Matrix5 normal_;
  Vector5 load_;
};

Eigen::Matrix3d turned(const Eigen::Vector3d& turn, const Eigen::Matrix3d& rotation) {
  if (turn.norm() == 0) return rotation;
  const Eigen::Quaterniond step(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  return (step * Eigen::Quaterniond(rotation)).normalized().toRotationMatrix();
}

/// Gauss and Newton's method, steps halved until they help.
Eigen::Matrix3d refine(const Samples& samples, const SphereField& b, Eigen::Matrix3d rotation,
                       int iterations) {
  Regression now(samples, b, rotation);
  for (int i = 0; i < iterations; ++i) {
    Eigen::Vector3d turn = now.turn();
    if (turn.norm() > 0.2) turn *= 0.2 / turn.norm();
    bool moved = false;
    for (int half = 0; half < 8 && !moved && turn.norm() > 1e-15; ++half, turn /= 2) {
      const Eigen::Matrix3d next = turned(turn, rotation);
      const Regression there(samples, b, next);
      if (!(there.residual() < now.residual()) || there.slope() <= 0) continue;
      rotation = next;
      now = there;
      moved = true;
    }
    if (!moved) break;
  }
  return rotation;
}

double angleOf(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

/// The best rotations of the grid, no two near to each other.
std::vector<Eigen::Matrix3d> searchGrid(const Samples& samples, const SphereField& b,
                                        const FieldSearchOptions& options) {
  const CubeRaster raster(b);
  std::vector<std::pair<double, int>> scores(options.rotations);
  parallelBlocks(scores.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto index = static_cast<int>(i);
      const Eigen::Matrix3d rotation = gridRotation(index, options.rotations);
      scores[i] = {-correlationOf(samples, raster, rotation), index};
    }
  });
  std::sort(scores.begin(), scores.end());
  std::vector<Eigen::Matrix3d> best;
  for (const auto& [score, index] : scores) {
    const Eigen::Matrix3d rotation = gridRotation(index, options.rotations);
    const bool is_new = std::none_of(best.begin(), best.end(), [&](const Eigen::Matrix3d& other) {
      return angleOf(rotation, other) < 0.25;
    });
    if (is_new) best.push_back(rotation);
    if (static_cast<int>(best.size()) == options.candidates) break;
  }
  return best;
}

Status checkField(const SphereField& field, const char* name) {
  const std::string what = std::string("the ") + name + " field ";
  if (field.values.size() != field.sphere.points().size()) {
    return {Reason::kInvalidOption, what + "needs one value for every vertex"};
  }
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    if (!std::isfinite(field.values[v])) {
      return {Reason::kInvalidOption, what + "is not finite at vertex " + std::to_string(v)};
    }
  }
  const auto [low, high] = std::minmax_element(field.values.begin(), field.values.end());
  if (!(*low < *high)) return {Reason::kInvalidOption, what + "is constant"};
  return {};
}

Status checkWeights(const SphereField& a, const std::vector<double>& weights) {
  double total = 0;
  for (const double weight : weights) {
    if (!(weight >= 0)) return {Reason::kInvalidOption, "weights must not be negative"};
    total += weight;
  }
  if (weights.size() != a.values.size() || !(total > 0) || !std::isfinite(total)) {
    return {Reason::kInvalidOption, "every vertex of the first field needs a weight"};
  }
  return {};
}

}  // namespace

Eigen::Matrix3d gridRotation(int index, int count) {
  const double phi = std::numbers::sqrt2;
  const double psi = 1.533751168755204288118041;  // The root of x^4 = x + 4.
  const double s = index + 0.5;
  const double r = std::sqrt(s / count), R = std::sqrt(1 - s / count);
  const double alpha = 2 * std::numbers::pi * s / phi, beta = 2 * std::numbers::pi * s / psi;
  return Eigen::Quaterniond(R * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha),
                            R * std::sin(beta))
      .toRotationMatrix();
}

double fieldCorrelation(const SphereField& a, const std::vector<double>& weights,
                        const SphereField& b, const Eigen::Matrix3d& rotation) {
  const auto field = [&](const Eigen::Vector3d& q) {
    return valueAt(b.sphere.surface(), b.values, b.sphere.locate(q));
  };
  return correlationOf(allVertices(a, weights), field, rotation);
}

FieldAlignment refineFieldAlignment(const SphereField& a, const std::vector<double>& weights,
                                    const SphereField& b, const Eigen::Matrix3d& start) {
  FieldAlignment result;
  result.rotation = refine(allVertices(a, weights), b, start, 50);
  result.correlation = fieldCorrelation(a, weights, b, result.rotation);
  return result;
}

Result<FieldAlignment> alignFields(Context& context, const SphereField& a,
                                   const std::vector<double>& weights, const SphereField& b,
                                   const FieldSearchOptions& options) {
  RETURN_IF_ERROR(checkField(a, "first"));
  RETURN_IF_ERROR(checkField(b, "second"));
  RETURN_IF_ERROR(checkWeights(a, weights));
  if (options.rotations < 1 || options.samples < 3 || options.candidates < 1) {
    return Status(Reason::kInvalidOption,
                  "the search needs at least one rotation, three samples and one candidate");
  }
  RETURN_IF_ERROR(context.check());
  const Context::Stage stage(context, "rotation search");
  const Samples all = allVertices(a, weights);
  const Samples samples = thinned(all, options.samples);
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  double best_residual = -1;
  for (const Eigen::Matrix3d& start : searchGrid(samples, b, options)) {
    RETURN_IF_ERROR(context.check());
    const Eigen::Matrix3d rotation = refine(samples, b, start, 20);
    const Regression end(samples, b, rotation);
    if (end.slope() <= 0 || (best_residual >= 0 && end.residual() >= best_residual)) continue;
    best = rotation;
    best_residual = end.residual();
  }
  return refineFieldAlignment(a, weights, b, best);
}

}  // namespace moduli
