#include "core/hyperbolic/trigonometry.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace moduli {
namespace {

/// log(2 sinh x) - x and log(2 cosh x) - x for x > 0 and x >= 0.
double logSineExcess(double x) {
  return std::log(-std::expm1(-2 * x));
}
double logCosineExcess(double x) {
  return std::log1p(std::exp(-2 * x));
}

/// asinh(e^x).
double asinhOfExponential(double x) {
  // Beyond e^20 the root of 1 + e^{-2x} is 1 + e^{-2x} / 2 to rounding.
  return x > 20 ? x + std::log(2.0) : std::asinh(std::exp(x));
}

Status needLengths(const std::array<double, 3>& lengths, const char* what) {
  for (double length : lengths)
    if (!(length > 0) || !std::isfinite(length))
      return {Reason::kInvalidOption,
              std::string(what) + " have positive lengths, not " + std::to_string(length)};
  return {};
}

}  // namespace

double hexagonSide(double a, double b, double c) {
  // sinh(d / 2)^2 = cosh((c + a - b) / 2) cosh((c - a + b) / 2) / (sinh a sinh b); the exponents'
  // sum is taken apart, so that only what is left of it is rounded.
  const double difference = std::abs(a - b);
  const double growth = std::max(c, difference) - std::max(a, b) - std::min(a, b);
  const double rest = logCosineExcess(std::abs(c + a - b) / 2) +
                      logCosineExcess(std::abs(c - a + b) / 2) - logSineExcess(a) -
                      logSineExcess(b);
  return 2 * asinhOfExponential((growth + rest) / 2);
}

Result<std::array<double, 3>> pantsSeams(const std::array<double, 3>& cuffs) {
  RETURN_IF_ERROR(needLengths(cuffs, "cuffs"));
  std::array<double, 3> seams{};
  for (int k = 0; k < 3; ++k)
    seams[k] = hexagonSide(cuffs[(k + 1) % 3] / 2, cuffs[(k + 2) % 3] / 2, cuffs[k] / 2);
  return seams;
}

Result<std::array<double, 3>> pantsCuffs(const std::array<double, 3>& seams) {
  RETURN_IF_ERROR(needLengths(seams, "seams"));
  std::array<double, 3> cuffs{};
  for (int k = 0; k < 3; ++k)
    cuffs[k] = 2 * hexagonSide(seams[(k + 1) % 3], seams[(k + 2) % 3], seams[k]);
  return cuffs;
}

Result<std::array<double, 5>> pentagonSides(double a, double b) {
  // With y = log(sinh a sinh b) the third from a is acosh(e^y) = 2 asinh(sqrt((e^y - 1) / 2)).
  const double y =
      a > 0 && b > 0 ? a + b - 2 * std::log(2.0) + logSineExcess(a) + logSineExcess(b) : 0;
  if (!(y > 0) || !std::isfinite(y))
    return Status(Reason::kInvalidOption, "no right-angled pentagon has neighbouring sides " +
                                              std::to_string(a) + " and " + std::to_string(b));
  const double opposite = y > 40 ? y + std::log(2.0) : 2 * std::asinh(std::sqrt(std::expm1(y) / 2));
  // sinh x = cosh a / sinh(opposite), and so for b.
  const auto besideOpposite = [opposite](double side) {
    return asinhOfExponential(side + logCosineExcess(side) - opposite - logSineExcess(opposite));
  };
  return std::array<double, 5>{a, b, besideOpposite(a), opposite, besideOpposite(b)};
}

double collarWidth(double length) {
  return asinhOfExponential(std::log(2.0) - length / 2 - logSineExcess(length / 2));
}

}  // namespace moduli
