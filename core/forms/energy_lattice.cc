#include "core/forms/energy_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <string>
#include <utility>

#include "core/forms/lattice_reduction.h"

namespace moduli {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;
/// What thetaSums may leave out, relative to Theta - 1.
constexpr double kLeftOut = 1e-15;
/// Equal energies differ by rounding; one that is not smaller than this times a known one is no
/// news.
constexpr double kSmaller = 1 - 1e-14;
constexpr double kRounding = 1 + 1e-12;
constexpr std::int64_t kPollMask = (1 << 17) - 1;

/// Schnorr-Euchner enumeration of one of each pair v, -v != 0 below a radius: depth first over the
/// coordinates from the last to the first, each outwards from the centre that the later ones set.
class Enumeration {
 public:
  Enumeration(Context& context, GramSchmidt steps, std::int64_t node_limit)
      : context_(context),
        steps_(std::move(steps)),
        node_limit_(node_limit),
        n_(steps_.squares.size()) {}

  /// Calls radius = visit(v, energy) for each v whose energy is at most the radius of that moment.
  template <typename Visit>
  Status run(double radius, const Visit& visit) {
    begin();
    Index k = 0;
    while (true) {
      if ((++nodes_ & kPollMask) == 0) RETURN_IF_ERROR(context_.check());
      if (nodes_ > node_limit_) return tooManyNodes();
      const double offset = v_(k) - centre_(k);
      const double energy = above_(k + 1) + offset * offset * steps_.squares(k);
      if (energy <= radius && k > 0) {
        above_(k) = energy;
        descend(--k);
        continue;
      }
      if (energy <= radius) {
        radius = visit(v_, energy);
      } else {
        if (++k == n_) return {};
        changed_(k - 1) = k;
      }
      advance(k);
    }
  }

 private:
  void begin() {
    v_ = VectorXd::Unit(n_, 0);
    centre_ = stride_ = VectorXd::Zero(n_);
    above_ = VectorXd::Zero(n_ + 1);
    sums_ = Eigen::MatrixXd::Zero(n_ + 1, n_);
    changed_ = Eigen::Matrix<Index, Eigen::Dynamic, 1>::LinSpaced(n_, 0, n_ - 1);
    top_ = 0;
  }

  /// Starts coordinate k at its centre. sums_(i, k) is the sum over j >= i of v_j mu(j, k), right
  /// for i > changed_(k).
  void descend(Index k) {
    if (k > 0) changed_(k - 1) = std::max(changed_(k - 1), changed_(k));
    for (Index i = changed_(k); i > k; --i) {
      sums_(i, k) = sums_(i + 1, k) + v_(i) * steps_.mu(i, k);
    }
    centre_(k) = -sums_(k + 1, k);
    v_(k) = std::rint(centre_(k));
    stride_(k) = 1;
  }

  /// The next value of coordinate k: upwards only where all later ones are 0, for -v is not wanted.
  void advance(Index k) {
    if (k >= top_) {
      top_ = k;
      v_(k) += 1;
    } else {
      v_(k) += v_(k) > centre_(k) ? -stride_(k) : stride_(k);
      stride_(k) += 1;
    }
  }

  Status tooManyNodes() const {
    return {
        Reason::kNoConvergence,
        "an enumeration of lattice vectors has more than " + std::to_string(node_limit_) + " nodes",
        "allow more of them, or ask for fewer vectors or for a larger t"};
  }

  Context& context_;
  GramSchmidt steps_;
  std::int64_t node_limit_;
  std::int64_t nodes_ = 0;
  Index n_;
  VectorXd v_, centre_, stride_;
  VectorXd above_;  ///< (k): the energy that coordinates k and later add.
  Eigen::MatrixXd sums_;
  Eigen::Matrix<Index, Eigen::Dynamic, 1> changed_;
  Index top_ = 0;  ///< The last coordinate that is not 0.
};

bool isPrimitive(const VectorXd& v) {
  std::int64_t divisor = 0;
  for (Index i = 0; i < v.size() && divisor != 1; ++i) {
    divisor = std::gcd(divisor, static_cast<std::int64_t>(v(i)));
  }
  return divisor == 1;
}

/// v^T gram v.
double energyOf(const Eigen::MatrixXd& gram, const VectorXd& v) {
  double energy = 0;
  for (Index j = 0; j < v.size(); ++j) {
    if (v(j) != 0) energy += v(j) * gram.col(j).dot(v);
  }
  return energy;
}

/// A radius with `count` primitive vectors below it where the basis, its sums and its differences
/// are so many; otherwise that of all of these.
double startRadius(const Eigen::MatrixXd& gram, std::size_t count) {
  std::vector<double> known;
  for (Index i = 0; i < gram.rows(); ++i) {
    known.push_back(gram(i, i));
    for (Index j = 0; j < i; ++j) {
      known.push_back(gram(i, i) + gram(j, j) + 2 * gram(i, j));
      known.push_back(gram(i, i) + gram(j, j) - 2 * gram(i, j));
    }
  }
  const auto nth = known.begin() + static_cast<std::ptrdiff_t>(std::min(count, known.size()) - 1);
  std::nth_element(known.begin(), nth, known.end());
  return *nth * kRounding;
}

/// The smallest energies of primitive vectors; count > 0.
Result<std::vector<double>> shortest(Enumeration& enumeration, const Eigen::MatrixXd& gram,
                                     std::size_t count) {
  if (gram.rows() == 1) return std::vector<double>{gram(0, 0)};
  double radius = startRadius(gram, count);
  while (true) {
    std::priority_queue<double> best;
    RETURN_IF_ERROR(enumeration.run(radius, [&](const VectorXd& v, double) {
      if (isPrimitive(v)) best.push(energyOf(gram, v));
      if (best.size() > count) best.pop();
      return best.size() < count ? radius : std::min(radius, best.top() * kSmaller);
    }));
    radius *= 2;
    if (best.size() < count) continue;
    std::vector<double> energies(count);
    for (std::size_t i = count; i-- > 0; best.pop()) energies[i] = best.top();
    return energies;
  }
}

// Let m be the smallest energy, u = pi t R and Theta_R the sum over the vectors above the radius R.
// For s < t, Theta_R(t) <= exp(-pi (t - s) R) Theta(s), and s^(n/2) Theta(s), by Poisson a constant
// times the theta sum of the dual lattice at 1 / s, grows with s. Hence
// Theta_R(t) <= exp(-pi (t - s) R) (t / s)^(n/2) Theta(t), the best s being n / (2 pi R) < t:
//   log Theta_R(t) <= -u + n/2 + (n/2) log(2 u / n) + log Theta(t)  for u > n/2.
// And Theta(t) / (Theta(t) - 1) <= 1 + exp(pi t m) / 2, since v and -v reach m.
double logLeftOut(double u, double n, double u_min) {
  const double ratio = u_min + std::log(std::exp(-u_min) + 0.5);
  return -u + n / 2 * (1 + std::log(2 * u / n)) + ratio;
}

/// A radius beyond which Theta(t) - 1 is left out up to kLeftOut, for energies from `least` on.
double thetaRadius(Index dimension, double t, double least) {
  const auto n = static_cast<double>(dimension);
  const double u_min = kPi * t * least;
  double low = std::max(n / 2, u_min);
  double high = 2 * low + 100;
  while (logLeftOut(high, n, u_min) > std::log(kLeftOut)) high *= 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (logLeftOut(middle, n, u_min) > std::log(kLeftOut) ? low : high) = middle;
  }
  return high / (kPi * t);
}

/// exp(pi x) times the sum over k >= 1 of exp(-pi k^2 x), for x > 0; by Poisson summation where
/// that takes fewer terms.
double sumOfMultiples(double x) {
  constexpr int kTerms = 4;  // exp(-24 pi) is 2e-33.
  double sum = 0;
  if (x >= 1) {
    for (int k = kTerms; k > 0; --k) sum += std::exp(-kPi * (k * k - 1) * x);
    return sum;
  }
  for (int k = kTerms; k > 0; --k) sum += std::exp(-kPi * k * k / x);
  return std::exp(kPi * x) * ((1 + 2 * sum) / std::sqrt(x) - 1) / 2;
}

/// Theta(t) - 1 = exp(-pi t least) sums(t), which neither overflows nor vanishes.
struct ScaledSums {
  double least;
  std::vector<double> sums;
};

Result<ScaledSums> scaledSums(Context& context, const Eigen::MatrixXd& energy,
                              const std::vector<double>& t, std::int64_t node_limit) {
  for (const double each : t) {
    if (!std::isfinite(each) || !(each > 0)) {
      return Status{Reason::kInvalidOption, "a theta sum needs numbers t > 0"};
    }
  }
  ASSIGN_OR_RETURN(const ReducedLattice lattice, reduceLattice(energy));
  ASSIGN_OR_RETURN(GramSchmidt steps, gramSchmidt(lattice.gram));
  Enumeration enumeration(context, std::move(steps), node_limit);
  ASSIGN_OR_RETURN(const std::vector<double> least, shortest(enumeration, lattice.gram, 1));
  std::vector<double> radii;
  for (const double each : t) radii.push_back(thetaRadius(energy.rows(), each, least[0]));
  std::vector<long double> sums(t.size());
  const double radius = radii.empty() ? 0 : *std::max_element(radii.begin(), radii.end());
  RETURN_IF_ERROR(enumeration.run(radius, [&](const VectorXd&, double value) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (value <= radii[i]) sums[i] += 2 * std::exp(-kPi * t[i] * (value - least[0]));
    }
    return radius;
  }));
  return ScaledSums{least[0], std::vector<double>(sums.begin(), sums.end())};
}

}  // namespace

Result<std::vector<double>> shortestEnergies(Context& context, const Eigen::MatrixXd& energy,
                                             std::size_t count, std::int64_t node_limit) {
  ASSIGN_OR_RETURN(const ReducedLattice lattice, reduceLattice(energy));
  ASSIGN_OR_RETURN(GramSchmidt steps, gramSchmidt(lattice.gram));
  if (count == 0) return std::vector<double>{};
  Enumeration enumeration(context, std::move(steps), node_limit);
  return shortest(enumeration, lattice.gram, count);
}

Result<std::vector<double>> thetaSums(Context& context, const Eigen::MatrixXd& energy,
                                      const std::vector<double>& t, std::int64_t node_limit) {
  ASSIGN_OR_RETURN(ScaledSums scaled, scaledSums(context, energy, t, node_limit));
  for (std::size_t i = 0; i < t.size(); ++i) {
    scaled.sums[i] = 1 + std::exp(-kPi * t[i] * scaled.least) * scaled.sums[i];
  }
  return std::move(scaled.sums);
}

Result<std::vector<double>> thetaFeatures(Context& context, const Eigen::MatrixXd& energy,
                                          const std::vector<double>& t, std::int64_t node_limit) {
  ASSIGN_OR_RETURN(ScaledSums scaled, scaledSums(context, energy, t, node_limit));
  for (std::size_t i = 0; i < t.size(); ++i) {
    scaled.sums[i] = scaled.least - std::log(scaled.sums[i]) / (kPi * t[i]);
  }
  return std::move(scaled.sums);
}

std::vector<double> spectrumThetaFeatures(const std::vector<double>& energies,
                                          const std::vector<double>& t) {
  std::vector<double> features;
  for (const double each : t) {
    double sum = 0;
    for (const double energy : energies) {
      sum += 2 * std::exp(-kPi * each * (energy - energies[0])) * sumOfMultiples(each * energy);
    }
    features.push_back(energies[0] - std::log(sum) / (kPi * each));
  }
  return features;
}

}  // namespace moduli
