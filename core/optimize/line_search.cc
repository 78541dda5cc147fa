#include "core/optimize/line_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

namespace moduli {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of what the slope promises.
constexpr double kEnough = 1e-4;
/// A slope above this share of the first asks for a longer step.
constexpr double kSteep = 0.9;
/// How far the slope may turn where rounding hides the gain.
constexpr double kTurn = 0.1;
/// Of the value: gains below it are not trusted.
constexpr double kHidden = 1e-10;
constexpr double kOfTerms = 1e-15;
/// A bracket this narrow, in shares of the step, ends a search.
constexpr double kNarrow = 1e-14;
constexpr int kMaxTrials = 120;
/// Longer and longer steps grow tenfold after as many.
constexpr int kDoublings = 5;
/// Unknowns that have gone this far have gone to infinity.
constexpr double kFar = 1e100;

class LineSearch {
 public:
  LineSearch(Context& context, Objective& objective, const Eigen::VectorXd& x,
             const Eigen::VectorXd& direction, const LineSearchOptions& options)
      : context_(context),
        objective_(objective),
        x_(x),
        direction_(direction),
        options_(options),
        value_(objective.value()),
        norm_(objective.gradient().norm()),
        slope_(-objective.gradient().dot(direction)),
        length_(direction.cwiseAbs().maxCoeff()) {}

  Result<LineStep> run() {
    if (options_.kind == LineSearchKind::kExact) {
      RETURN_IF_ERROR(exact());
    } else {
      RETURN_IF_ERROR(backtrack());
      // Rounding of the value may be worse than its size tells: then slopes and norms alone.
      if (!end_) RETURN_IF_ERROR(bySlopes());
    }
    result_.end = end_.value_or(LineSearchEnd::kStuck);
    return std::move(result_);
  }

 private:
  /// A place on the line. slope: d/dt of f(x - t d), negative at 0.
  struct Trial {
    double t = 0;
    double value = 0;
    double slope = 0;
    double norm = 0;

    bool inside() const { return value < kInfinity; }
  };

  Result<Trial> at(double t) {
    RETURN_IF_ERROR(context_.check());
    ++result_.evaluations;
    result_.step = t;
    result_.x = x_ - t * direction_;
    const Status moved = objective_.moveTo(context_, result_.x);
    if (moved.reason() == Reason::kNoConvergence) return Trial{t, kInfinity, kInfinity, kInfinity};
    RETURN_IF_ERROR(moved);
    const Trial trial{t, objective_.value(), -objective_.gradient().dot(direction_),
                      objective_.gradient().norm()};
    const bool finite = objective_.gradient().allFinite();
    // Far up a gradient overflows before its value does.
    if (trial.value == kInfinity || (!finite && trial.value > value_)) {
      return Trial{t, kInfinity, kInfinity, kInfinity};
    }
    if (trial.value == -kInfinity || t * length_ > kFar) {
      end_ = LineSearchEnd::kUnbounded;
    } else if (std::isnan(trial.value) || !finite) {
      end_ = LineSearchEnd::kNotANumber;
    }
    take(trial);
    return trial;
  }

  void take(const Trial& trial) {
    result_.value = trial.value;
    result_.gradient = objective_.gradient();
  }

  Status accept(double t) {
    if (result_.step != t || !(result_.value < kInfinity)) RETURN_IF_ERROR(at(t).status());
    if (!end_) end_ = LineSearchEnd::kFound;
    return {};
  }

  /// Below this rise a value counts as not risen: its rounding, and that of terms of size 1 whose
  /// sum it may be.
  double noise() const { return kHidden * std::abs(value_) + kOfTerms; }

  bool goesDown(const Trial& trial) const {
    if (!trial.inside()) return false;
    if (-trial.t * slope_ > noise()) return trial.value <= value_ + kEnough * trial.t * slope_;
    return trial.value <= value_ + noise() && trial.slope <= -kTurn * slope_;
  }

  /// Where the secant of the slopes at 0 and at a trial that is too long vanishes.
  double shortened(const Trial& trial, double low) const {
    const double width = trial.t - low;
    if (!trial.inside() || !(trial.slope > slope_)) return low + 0.5 * width;
    const double guess = trial.t * -slope_ / (trial.slope - slope_);
    return low + std::clamp((guess - low) / width, 0.1, 0.5) * width;
  }

  Status backtrack() {
    double low = 0, high = kInfinity, t = options_.first_step;
    for (int n = 0; n < kMaxTrials; ++n) {
      ASSIGN_OR_RETURN(const Trial trial, at(t));
      if (end_) return {};
      if (!goesDown(trial)) {
        high = t;
        t = shortened(trial, low);
      } else if (options_.lengthen && trial.slope < kSteep * slope_) {
        low = t;
        t = high < kInfinity ? 0.5 * (low + high) : (n < kDoublings ? 2 : 10) * t;
      } else {
        return accept(trial.t);
      }
      if (high < kInfinity && high - low <= kNarrow * high) break;
    }
    return low > 0 ? accept(low) : Status();
  }

  Status bySlopes() {
    double t = options_.first_step;
    for (int n = 0; n < 5; ++n) {
      ASSIGN_OR_RETURN(const Trial trial, at(t));
      if (end_) return {};
      if (trial.inside() && trial.norm < norm_ && trial.slope <= -kTurn * slope_) {
        return accept(t);
      }
      t = shortened(trial, 0);
    }
    return {};
  }

  /// Whether the minimum along the line lies before the trial.
  bool isTooLong(const Trial& trial) const {
    return !trial.inside() || trial.value > value_ + noise() || trial.slope >= 0;
  }

  /// A root of the slope between a step too short and a step too long: secants, halving the slope
  /// of an end that stays twice (Illinois), and bisection where that is slow or impossible.
  Status exact() {
    Trial low{0, value_, slope_, norm_};
    std::optional<Trial> high;
    double t = options_.first_step;
    int same_side = 0;
    for (int n = 0; n < kMaxTrials; ++n) {
      ASSIGN_OR_RETURN(const Trial trial, at(t));
      if (end_) return {};
      const bool long_one = isTooLong(trial);
      if (std::abs(trial.slope) <= -options_.slope_tolerance * slope_ &&
          trial.value <= value_ + noise()) {
        return accept(t);
      }
      if (!high && !long_one) {
        t = std::clamp(secant(low, trial), 2 * t, 10 * t);
        low = trial;
        continue;
      }
      const double width = high ? high->t - low.t : kInfinity;
      if (long_one) {
        same_side = same_side > 0 ? same_side + 1 : 1;
        if (same_side > 1) low.slope /= 2;
        high = trial;
      } else {
        same_side = same_side < 0 ? same_side - 1 : -1;
        if (same_side < -1 && high->slope > 0) high->slope /= 2;
        low = trial;
      }
      const double left = high->t - low.t;
      if (left <= kNarrow * high->t) break;
      t = secant(low, *high);
      const bool slow = left > 0.5 * width && std::abs(same_side) > 2;
      if (slow || !(high->slope > 0) || !high->inside() || !(t > low.t) || !(t < high->t)) {
        t = low.t + 0.5 * left;
      }
    }
    return low.t > 0 ? accept(low.t) : Status();
  }

  static double secant(const Trial& a, const Trial& b) {
    const double t = a.t - a.slope * (b.t - a.t) / (b.slope - a.slope);
    return std::isfinite(t) && (t - a.t) * (b.t - a.t) > 0 ? t : kInfinity;
  }

  Context& context_;
  Objective& objective_;
  const Eigen::VectorXd& x_;
  const Eigen::VectorXd& direction_;
  const LineSearchOptions& options_;
  const double value_;
  const double norm_;
  const double slope_;
  const double length_;
  std::optional<LineSearchEnd> end_;
  LineStep result_;
};

}  // namespace

std::string_view lineSearchName(LineSearchKind kind) {
  return kind == LineSearchKind::kExact ? "exact" : "backtracking";
}

Result<LineSearchKind> lineSearchFromName(std::string_view name) {
  for (const LineSearchKind kind : {LineSearchKind::kBacktracking, LineSearchKind::kExact}) {
    if (lineSearchName(kind) == name) return kind;
  }
  return Status{Reason::kInvalidOption, "there is no line search '" + std::string(name) + "'",
                "the line searches are backtracking, exact"};
}

Result<LineStep> searchLine(Context& context, Objective& objective, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& direction, const LineSearchOptions& options) {
  return LineSearch(context, objective, x, direction, options).run();
}

}  // namespace moduli
