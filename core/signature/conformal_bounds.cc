#include "core/signature/conformal_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace moduli {
namespace {

/// |log(x / y)| / 2, the same both ways.
double halfLogRatio(double x, double y) {
  return std::log(std::max(x, y) / std::min(x, y)) / 2;
}

/// What |log(a_i / b_i)| / 2 is at least for the first i that `more` alone has.
double boundBeyond(const KnownNumbers& fewer, const KnownNumbers& more) {
  const std::size_t i = fewer.values.size();
  if (i >= more.values.size() || !(fewer.complete_to > more.values[i])) return 0;
  return halfLogRatio(fewer.complete_to, more.values[i]);
}

/// All there are of them, or the smallest ones.
KnownNumbers smallest(const std::vector<double>& values) {
  return {values, values.empty() ? 0 : values.back()};
}

std::optional<double> energyBound(const ConformalBlock& a, const ConformalBlock& b) {
  if (a.energy_spectrum.empty() || b.energy_spectrum.empty()) return std::nullopt;
  return spectrumBound(smallest(a.energy_spectrum), smallest(b.energy_spectrum));
}

std::optional<double> lengthBound(const Signature& a, const Signature& b) {
  if (!a.certificate.spectrum_complete_to || !b.certificate.spectrum_complete_to) {
    return std::nullopt;
  }
  return spectrumBound({a.conformal->length_spectrum, *a.certificate.spectrum_complete_to},
                       {b.conformal->length_spectrum, *b.certificate.spectrum_complete_to});
}

std::optional<double> boundaryBound(const ConformalBlock& a, const ConformalBlock& b) {
  if (a.boundary_lengths.size() != b.boundary_lengths.size()) return std::nullopt;
  return spectrumBound(smallest(a.boundary_lengths), smallest(b.boundary_lengths));
}

}  // namespace

std::optional<double> spectrumBound(const KnownNumbers& a, const KnownNumbers& b) {
  if (a.values.empty() && b.values.empty()) return std::nullopt;
  double largest = std::max(boundBeyond(a, b), boundBeyond(b, a));
  for (std::size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i) {
    largest = std::max(largest, halfLogRatio(a.values[i], b.values[i]));
  }
  return largest;
}

std::optional<double> ConformalBounds::largest() const {
  return std::max({energies, lengths, boundary});  // Nothing comes before any number.
}

ConformalBounds conformalBounds(const Signature& a, const Signature& b) {
  if (!a.conformal || !b.conformal) return {};
  return {energyBound(*a.conformal, *b.conformal), lengthBound(a, b),
          boundaryBound(*a.conformal, *b.conformal)};
}

}  // namespace moduli
