#include "core/parameterize/cones.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/forms/cotan.h"
#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/geometry.h"
#include "core/intrinsic/mollify.h"
#include "core/linalg/spd_solver.h"
#include "core/topology/surface_topology.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
/// Curvature that is none.
constexpr double kNothing = 1e-9;

/// L u = K' - K, the Green's functions of the cones being asked for one by one.
class Scales {
 public:
  static Result<Scales> make(Context& context, const Connectivity& surface,
                             const std::vector<double>& lengths) {
    Scales scales;
    scales.closed_ = true;
    const Index count = surface.vertexCount();
    scales.row_.assign(count, 0);
    for (Index v = 0; v < count; ++v) {
      if (surface.isBoundaryVertex(v)) scales.closed_ = false;
    }
    Index rows = 0;
    for (Index v = 0; v < count; ++v) {
      const bool fixed = scales.closed_ ? v == 0 : surface.isBoundaryVertex(v);
      scales.row_[v] = fixed ? kNone : rows++;
    }
    scales.areas_ = vertexAreas(surface, lengths);
    scales.curvature_ = curvatures(surface, lengths);
    const SparseMatrix whole = stiffnessMatrix(surface, cotanWeights(surface, lengths));
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < whole.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator it(whole, column); it; ++it) {
        const Index r = scales.row_[it.row()], c = scales.row_[it.col()];
        if (r != kNone && c != kNone)
          entries.emplace_back(std::max(r, c), std::min(r, c), it.value());
      }
    }
    SparseMatrix matrix(rows, rows);
    matrix.setFromTriplets(entries.begin(), entries.end());
    ASSIGN_OR_RETURN(SpdSolver solver, SpdSolver::make(context, matrix));
    scales.solver_ = std::make_unique<SpdSolver>(std::move(solver));
    ASSIGN_OR_RETURN(scales.given_, scales.solve(context, scales.curvature_));
    return scales;
  }

  bool closed() const { return closed_; }
  const std::vector<double>& areas() const { return areas_; }
  /// Whether a cone may lie there.
  bool isFree(Index v) const { return closed_ || row_[v] != kNone; }

  /// The inverse of L, 0 where u is held.
  Result<Eigen::VectorXd> solve(Context& context, const Eigen::VectorXd& right) const {
    Eigen::MatrixXd b(rowCount(), 1);
    for (Index v = 0; v < right.size(); ++v) {
      if (row_[v] != kNone) b(row_[v], 0) = right[v];
    }
    ASSIGN_OR_RETURN(const Eigen::MatrixXd x, solver_->solve(context, b));
    Eigen::VectorXd u = Eigen::VectorXd::Zero(right.size());
    for (Index v = 0; v < right.size(); ++v) {
      if (row_[v] != kNone) u[v] = x(row_[v], 0);
    }
    return u;
  }

  Status add(Context& context, Index cone) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(curvature_.size());
    unit[cone] = 1;
    ASSIGN_OR_RETURN(Eigen::VectorXd green, solve(context, unit));
    cones_.push_back(cone);
    greens_.push_back(std::move(green));
    return {};
  }
  const std::vector<Index>& cones() const { return cones_; }

  /// The curvatures of the cones for which u is 0 at all of them, or the same where nothing bounds.
  Eigen::VectorXd harmonicCurvatures(double sum) const {
    const auto n = static_cast<Eigen::Index>(cones_.size());
    const Eigen::Index border = closed_ ? 1 : 0;
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + border, n + border);
    Eigen::VectorXd right(n + border);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) system(i, k) = greens_[k][cones_[i]];
      right[i] = given_[cones_[i]];
      if (closed_) system(i, n) = system(n, i) = 1;
    }
    if (closed_) right[n] = sum;
    return system.fullPivLu().solve(right).head(n);
  }

  /// u for these curvatures of the cones, 0 on average where nothing bounds it.
  Eigen::VectorXd scale(const Eigen::VectorXd& curvatures) const {
    Eigen::VectorXd u = -given_;
    for (std::size_t k = 0; k < cones_.size(); ++k) {
      u += curvatures[static_cast<Eigen::Index>(k)] * greens_[k];
    }
    return u;
  }

  /// u for curvature that is spread evenly (by area), or none inside a boundary.
  Result<Eigen::VectorXd> evenScale(Context& context, double sum) const {
    if (!closed_) return Eigen::VectorXd(-given_);
    const double area = std::accumulate(areas_.begin(), areas_.end(), 0.0);
    Eigen::VectorXd wanted(curvature_.size());
    for (Index v = 0; v < wanted.size(); ++v) wanted[v] = sum * areas_[v] / area - curvature_[v];
    return solve(context, wanted);
  }

 private:
  Scales() = default;

  static Eigen::VectorXd curvatures(const Connectivity& surface,
                                    const std::vector<double>& lengths) {
    Eigen::VectorXd result(surface.vertexCount());
    for (Index v = 0; v < surface.vertexCount(); ++v) {
      result[v] = surface.isBoundaryVertex(v) ? kPi : 2 * kPi;
    }
    for (Index h = 0; h < surface.halfedgeCount(); h += 3) {
      const auto side = [&](Index g) { return lengths[surface.edge(g)]; };
      const TriangleValues angles =
          triangleAngles(Geometry::kEuclidean, {side(h + 1), side(h + 2), side(h)});
      for (Index c = 0; c < 3; ++c) result[surface.tail(h + c)] -= angles[c];
    }
    return result;
  }

  Eigen::Index rowCount() const {
    return static_cast<Eigen::Index>(
        std::count_if(row_.begin(), row_.end(), [](Index row) { return row != kNone; }));
  }

  bool closed_ = true;
  std::vector<Index> row_;  ///< Per vertex; kNone where u is held.
  std::vector<double> areas_;
  Eigen::VectorXd curvature_, given_;  ///< K, and its solution.
  std::unique_ptr<SpdSolver> solver_;
  std::vector<Index> cones_;
  std::vector<Eigen::VectorXd> greens_;
};

double spreadOf(const Eigen::VectorXd& u) {
  return u.maxCoeff() - u.minCoeff();
}

/// Whole numbers nearby with a given sum, none beyond +-most: by largest remainders. Nothing where
/// there are none.
std::optional<std::vector<int>> roundedTo(const Eigen::VectorXd& values, int sum, int most) {
  const auto count = static_cast<std::size_t>(values.size());
  std::vector<int> whole(count);
  int total = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = values[static_cast<Eigen::Index>(i)];
    whole[i] = static_cast<int>(std::lround(std::clamp(value, -1.0 * most, 1.0 * most)));
    total += whole[i];
  }
  while (total != sum) {
    const int step = total < sum ? 1 : -1;
    std::size_t best = count;
    double gain = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
      if (std::abs(whole[i] + step) > most) continue;
      const double open = step * (values[static_cast<Eigen::Index>(i)] - whole[i]);
      if (open > gain) {
        gain = open;
        best = i;
      }
    }
    if (best == count) return std::nullopt;
    whole[best] += step;
    total += step;
  }
  return whole;
}

class ConeChoice {
 public:
  ConeChoice(Context& context, Scales scales, double sum, const ConeOptions& options)
      : context_(context), scales_(std::move(scales)), sum_(sum), options_(options) {
    if (!options_.quantum) return;
    quanta_ = static_cast<int>(std::lround(sum / *options_.quantum));
    // A cone has less than 2 pi.
    most_quanta_ = static_cast<int>(std::lround(2 * kPi / *options_.quantum)) - 1;
    if (options_.most_quanta) most_quanta_ = std::min(most_quanta_, *options_.most_quanta);
  }

  Result<ChosenCones> run() {
    ASSIGN_OR_RETURN(Eigen::VectorXd u, scales_.evenScale(context_, sum_));
    const double spread_before = spreadOf(u);
    std::optional<ChosenCones> best;
    // There is a flat metric without cones.
    if (std::abs(sum_) < kNothing || !scales_.closed()) {
      best = ChosenCones{{}, spread_before, spread_before};
      if (best->spread <= options_.spread) return *std::move(best);
    }
    u.array() -= u.mean();
    while (addExtremes(u, best.has_value())) {
      RETURN_IF_ERROR(context_.check());
      RETURN_IF_ERROR(takeCandidates());
      const Eigen::VectorXd curvatures = scales_.harmonicCurvatures(sum_);
      u = scales_.scale(curvatures);
      u.array() -= u[scales_.cones().front()];
      std::optional<ChosenCones> found = rounded(curvatures);
      if (found && (!best || found->spread < best->spread)) best = std::move(found);
      if (best && best->spread <= options_.spread) break;
    }
    if (!best) return tooFew();
    best->spread_before = spread_before;
    return *std::move(best);
  }

 private:
  /// The next candidates: the vertices where u is farthest out on either side, the second only
  /// where some choice stands already. False where no more are allowed or needed.
  bool addExtremes(const Eigen::VectorXd& u, bool both) {
    candidates_.clear();
    Index highest = kNone, lowest = kNone;
    for (Index v = 0; v < u.size(); ++v) {
      if (!scales_.isFree(v) || isCone(v)) continue;
      if (highest == kNone || u[v] > u[highest]) highest = v;
      if (lowest == kNone || u[v] < u[lowest]) lowest = v;
    }
    if (highest == kNone) return false;
    const bool up = std::abs(u[highest]) > std::abs(u[lowest]);
    const Index first = up ? highest : lowest, second = up ? lowest : highest;
    const auto room = static_cast<std::size_t>(options_.most) - scales_.cones().size();
    if (room >= 1) candidates_.push_back(first);
    const bool opposite = u[highest] > 0 && u[lowest] < 0;
    if (room >= 2 && both && opposite && second != first) candidates_.push_back(second);
    return !candidates_.empty();
  }

  bool isCone(Index v) const {
    const std::vector<Index>& cones = scales_.cones();
    return std::find(cones.begin(), cones.end(), v) != cones.end();
  }

  Status takeCandidates() {
    for (const Index v : candidates_) RETURN_IF_ERROR(scales_.add(context_, v));
    return {};
  }

  /// The cones of these curvatures as options want them; nothing where no metric has them.
  std::optional<ChosenCones> rounded(Eigen::VectorXd curvatures) const {
    if (options_.quantum) {
      int sum = quanta_;
      if (!scales_.closed()) {
        sum = 0;
        for (Eigen::Index i = 0; i < curvatures.size(); ++i) {
          sum += static_cast<int>(std::lround(std::clamp(curvatures[i] / *options_.quantum,
                                                         -1.0 * most_quanta_, 1.0 * most_quanta_)));
        }
      }
      const auto whole = roundedTo(curvatures / *options_.quantum, sum, most_quanta_);
      if (!whole) return std::nullopt;
      for (Eigen::Index i = 0; i < curvatures.size(); ++i) {
        curvatures[i] = (*whole)[static_cast<std::size_t>(i)] * *options_.quantum;
      }
    }
    ChosenCones chosen;
    for (Eigen::Index i = 0; i < curvatures.size(); ++i) {
      if (!(curvatures[i] < 2 * kPi - kNothing)) return std::nullopt;
      if (std::abs(curvatures[i]) < kNothing) continue;
      chosen.cones.push_back({scales_.cones()[static_cast<std::size_t>(i)], curvatures[i]});
    }
    std::sort(chosen.cones.begin(), chosen.cones.end(),
              [](const Cone& a, const Cone& b) { return a.vertex < b.vertex; });
    chosen.spread = spreadOf(scales_.scale(curvatures));
    return chosen;
  }

  Status tooFew() const {
    std::string why = "a cone has a curvature below 2 pi";
    if (options_.quantum) {
      why = "a cone has at most " + std::to_string(most_quanta_) + " times " +
            shortestDouble(*options_.quantum);
    }
    return {Reason::kInvalidOption,
            "by the theorem of Gauss and Bonnet the curvatures add up to " + shortestDouble(sum_) +
                ", and " + why + ": " + std::to_string(options_.most) + " cones are too few",
            "allow more cones"};
  }

  Context& context_;
  Scales scales_;
  double sum_;
  const ConeOptions& options_;
  int quanta_ = 0, most_quanta_ = 0;
  std::vector<Index> candidates_;
};

Status checkOptions(const ConeOptions& options) {
  const auto bad = [](const std::string& what) { return Status(Reason::kInvalidOption, what); };
  if (!(options.spread > 0)) return bad("the spread of scales must be positive");
  if (options.most < 0) return bad("the number of cones must not be negative");
  if (options.most_quanta && *options.most_quanta < 1) {
    return bad("a cone must be allowed one quantum at least");
  }
  if (!options.quantum) return {};
  const double parts = 2 * kPi / *options.quantum;
  if (parts >= 2 - kNothing && std::abs(parts - std::round(parts)) < kNothing) return {};
  return bad("a quantum of curvature must be a part of 2 pi, and " +
             shortestDouble(*options.quantum) + " is not");
}

}  // namespace

Result<ChosenCones> chooseCones(Context& context, const Connectivity& surface,
                                const std::vector<double>& lengths, const ConeOptions& options) {
  RETURN_IF_ERROR(checkOptions(options));
  if (computeTopology(surface).components != 1) {
    return Status(Reason::kUnsupportedTopology,
                  "cones are chosen for a connected surface, one component at a time");
  }
  ASSIGN_OR_RETURN(const MollifiedLengths mollified, mollify(surface, unitLengths(lengths)));
  std::vector<double> chords;
  for (const double length : mollified.lengths) {
    chords.push_back(halfChord(Geometry::kEuclidean, length));
  }
  IntrinsicTriangulation triangulation(surface, chords);
  RETURN_IF_ERROR(flipToDelaunayIsometric(context, triangulation).status());
  std::vector<double> delaunay_lengths = triangulation.edgeHalfChords();
  for (double& x : delaunay_lengths) x = lengthOfHalfChord(Geometry::kEuclidean, x);
  ASSIGN_OR_RETURN(Scales scales,
                   Scales::make(context, triangulation.connectivity(), delaunay_lengths));
  const double sum = 2 * kPi * surface.eulerCharacteristic();
  return ConeChoice(context, std::move(scales), sum, options).run();
}

void tellChoice(const ChosenCones& chosen, const ConeOptions& wanted, Parameterization& map) {
  if (map.cones) {
    map.cones->spread = chosen.spread;
    map.cones->spread_before = chosen.spread_before;
  }
  if (chosen.spread <= wanted.spread) return;
  map.certificate.warnings.push_back(
      "CONE_SPREAD: logarithms of the scale spread over about " + shortestDouble(chosen.spread) +
      " where " + shortestDouble(wanted.spread) + " was asked for; " +
      (wanted.quantum ? "whole quarters of a turn do no better at these vertices"
                      : "more cones take more of it out"));
}

}  // namespace moduli
