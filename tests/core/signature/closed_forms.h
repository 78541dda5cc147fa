#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/signature/spectra.h"

/// Spectra of surfaces of revolution from their closed forms, by one-dimensional quadrature.
namespace moduli::closed_forms {

inline constexpr double kPi = std::numbers::pi;

/// Composite Simpson rule with an even number of parts.
inline double integrate(const std::function<double(double)>& f, double from, double to,
                        int parts = 4000) {
  const double h = (to - from) / parts;
  double sum = f(from) + f(to);
  for (int i = 1; i < parts; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(from + i * h);
  return sum * h / 3;
}

/// Of the spheroid (1, 1, c), parametric latitude beta. Conformal factor MATH 12.9; principal
/// curvatures c / w^3 along the meridian and c / w along the parallel, w^2 = sin^2 + c^2 cos^2.
inline FieldSpectra spheroidSpectra(double c) {
  const auto w = [c](double beta) { return std::hypot(std::sin(beta), c * std::cos(beta)); };
  const double half = kPi / 2;
  const double area =
      2 * kPi * integrate([&](double b) { return w(b) * std::cos(b); }, -half, half);
  const double unit = std::sqrt(4 * kPi / area);
  struct Point {
    double z, across, factor, curvature;
  };
  const auto at = [&](double beta) {
    const double sine = std::sin(beta) / w(beta);  // of the geodetic latitude
    const double cosine = c * std::cos(beta) / w(beta);
    double psi = std::copysign(std::log((1 + std::abs(sine)) / cosine), sine);
    if (c < 1) {
      const double e = std::sqrt(1 - c * c);
      psi -= e * std::atanh(e * sine);
    } else {
      const double e = std::sqrt(c * c - 1);
      psi += e * std::atan(e * sine);
    }
    const double lambda = std::log(unit * std::cos(beta) * std::cosh(psi));
    const double curvature = 0.5 * (c / std::pow(w(beta), 3) + c / w(beta)) / unit;
    return Point{std::tanh(psi), 1 / std::cosh(psi), lambda, curvature};
  };
  FieldSpectra spectra;
  // The poles are limits; a hair's breadth of latitude weighs 1e-12.
  const double end = half - 1e-6;
  for (int l = 1; l <= kSpectrumBins; ++l) {
    // dz = sech^2(psi) dpsi, dpsi = w dbeta / cos(beta).
    const auto coefficient = [&](double Point::*field) {
      return 2 * kPi * std::sqrt((2 * l + 1) / (4 * kPi)) *
             integrate(
                 [&](double beta) {
                   const Point p = at(beta);
                   return p.*field * std::legendre(l, std::abs(p.z)) *
                          (l % 2 == 1 && p.z < 0 ? -1 : 1) * p.across * p.across * w(beta) /
                          std::cos(beta);
                 },
                 -end, end);
    };
    const double a = coefficient(&Point::factor);
    const double b = coefficient(&Point::curvature);
    spectra.first.push_back(a * a);
    spectra.second.push_back(b * b);
    spectra.cross.push_back(a * b);
  }
  return spectra;
}

/// Of the torus of revolution with radii R > r. Conformal factor R + r cos v over the flat torus
/// with coordinates u and zeta, d zeta = r dv / (R + r cos v). Source: MATH 12.1.
inline FieldSpectra torusSpectra(double R, double r) {
  const double t = r / std::sqrt(R * R - r * r);
  const double unit = std::sqrt(4 * kPi / (4 * kPi * kPi * R * r));
  FieldSpectra spectra;
  spectra.first.assign(kSpectrumBins, 0.0);
  spectra.second = spectra.cross = spectra.first;
  const auto zeta = [&](double v) {
    return 2 * t * std::atan(std::sqrt((R - r) / (R + r)) * std::tan(v / 2));
  };
  for (int n = 1; n <= 200; ++n) {
    // Both fields are even in v: only cosines of n zeta / t occur, with norm area / 2 = 2 pi.
    const auto coefficient = [&](const std::function<double(double)>& field) {
      const double mean =
          integrate(
              [&](double v) {
                return field(v) * std::cos(n * zeta(v) / t) * r / (R + r * std::cos(v));
              },
              0, kPi - 1e-9) /
          (kPi * t);
      return mean * std::sqrt(8 * kPi);
    };
    const double a = coefficient([&](double v) { return std::log(R + r * std::cos(v)); });
    const double b = coefficient(
        [&](double v) { return 0.5 * (1 / r + std::cos(v) / (R + r * std::cos(v))) / unit; });
    // The flat torus has area 4 pi^2 t and eigenvalue (n / t)^2; scaled to area 4 pi.
    const double frequency = std::sqrt(kPi * n * n / t + 0.25) - 0.5;
    const int below = static_cast<int>(frequency);
    for (int l = below; l <= below + 1; ++l) {
      const double share = frequency < 1 ? (l == 1 ? 1 : 0) : 1 - std::abs(frequency - l);
      if (l < 1 || l > kSpectrumBins) continue;
      spectra.first[l - 1] += share * a * a;
      spectra.second[l - 1] += share * b * b;
      spectra.cross[l - 1] += share * a * b;
    }
  }
  return spectra;
}

/// Largest difference of amplitudes, relative to the norm of all amplitudes.
inline double amplitudeError(const std::vector<double>& powers, const std::vector<double>& exact) {
  double worst = 0, norm = 0;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    worst = std::max(worst, std::abs(std::sqrt(powers[i]) - std::sqrt(exact[i])));
    norm += exact[i];
  }
  return worst / std::sqrt(norm);
}

}  // namespace moduli::closed_forms
