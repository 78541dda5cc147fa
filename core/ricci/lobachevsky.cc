#include "core/ricci/lobachevsky.h"

#include <array>
#include <cmath>
#include <numbers>

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPiBeyondDouble = 1.2246467991473532e-16;  ///< pi less the double next to it.

/// The Riemann zeta function at 2, 4, ...; both series below fall by 9 a term.
constexpr std::array<double, 17> kZeta{
    1.6449340668482264365, 1.0823232337111381915, 1.0173430619844491397, 1.0040773561979443394,
    1.0009945751278180853, 1.0002460865533080483, 1.0000612481350587048, 1.0000152822594086519,
    1.0000038172932649998, 1.0000009539620338728, 1.0000002384505027277, 1.0000000596081890513,
    1.0000000149015548284, 1.0000000037253340248, 1.0000000009313274324, 1.0000000002328311834,
    1.0000000000582077209};

/// Coefficients of the power series in (x / pi)^2 of log (x / sin x), integrated and over x.
constexpr std::array<double, 17> nearZero() {
  std::array<double, 17> result{};
  for (int n = 1; n <= 17; ++n) result[n - 1] = kZeta[n - 1] / (n * (2 * n + 1));
  return result;
}

/// The same of -log cos y, in (2 y / pi)^2.
constexpr std::array<double, 17> nearQuarter() {
  std::array<double, 17> result = nearZero();
  double quarter = 1;
  for (double& coefficient : result) {
    quarter /= 4;
    coefficient *= 1 - quarter;
  }
  return result;
}

constexpr std::array<double, 17> kNearZero = nearZero();
constexpr std::array<double, 17> kNearQuarter = nearQuarter();

double powerSeries(const std::array<double, 17>& coefficients, double square) {
  double sum = 0;
  for (int n = 16; n >= 0; --n) sum = (sum + coefficients[n]) * square;
  return sum;
}

}  // namespace

double lobachevsky(double x) {
  const double reduced = std::remainder(x, kPi);
  const double turns = std::round((x - reduced) / kPi);
  const double rest = reduced - turns * kPiBeyondDouble;
  const double size = std::abs(rest);
  if (size == 0) return 0;
  double value = 0;
  if (size < kPi / 3) {
    const double part = size / kPi;
    value = size * (1 - std::log(2 * size) + powerSeries(kNearZero, part * part));
  } else {
    // The double next to pi / 2 is a little less than it.
    const double left = (kPi / 2 - size) + kPiBeyondDouble / 2;
    const double part = 2 * left / kPi;
    value = left * (std::numbers::ln2 - powerSeries(kNearQuarter, part * part));
  }
  return rest < 0 ? -value : value;
}

}  // namespace moduli
