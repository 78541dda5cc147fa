#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "core/base/context.h"
#include "core/base/parallel.h"
#include "core/signature/quadrature.h"
#include "core/signature/spectra.h"

/// What the transforms on the sphere and on the torus share. Internal to this room.
namespace moduli {

/// Longest edge of a quadrature cell, a quarter of a turn of the highest frequency. Measured on
/// real meshes, amplitudes come out to 1e-4 of the whole spectrum, the highest frequency to 1e-3 of
/// its own; half the length would cost four times as much and gain a factor of ten.
inline constexpr double kFinestLength = 1.5 / kSpectrumBins;
inline constexpr std::size_t kBatch = 64;

/// Takes the weighted mean out of every field.
template <typename Point>
void removeMeans(Samples<Point>& samples) {
  double total = 0;
  for (const double weight : samples.weights) total += weight;
  for (std::vector<double>& field : samples.fields) {
    double sum = 0;
    for (std::size_t i = 0; i < field.size(); ++i) sum += samples.weights[i] * field[i];
    for (double& value : field) value -= sum / total;
  }
}

/// Sum of what add(begin, end, sums) gives for all batches of samples, rows x columns; the same
/// bytes for any number of threads. Fails when the context says so.
template <typename Add>
Result<Eigen::MatrixXd> sumOverSamples(Context& context, std::size_t count, Eigen::Index rows,
                                       std::size_t columns, const Add& add) {
  constexpr std::size_t kGrain = 64 * kBatch;
  const auto width = static_cast<Eigen::Index>(columns);
  std::vector<Eigen::MatrixXd> partial((count + kGrain - 1) / kGrain);
  parallelBlocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    if (!context.check().ok()) return;
    Eigen::MatrixXd& sums = partial[begin / kGrain];
    sums = Eigen::MatrixXd::Zero(rows, width);
    for (; begin < end; begin += kBatch) add(begin, std::min(begin + kBatch, end), sums);
  });
  RETURN_IF_ERROR(context.check());
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(rows, width);
  for (const Eigen::MatrixXd& sums : partial) total += sums;
  return total;
}

inline FieldSpectra emptySpectra(std::size_t fields) {
  FieldSpectra spectra;
  spectra.first.assign(kSpectrumBins, 0.0);
  if (fields > 1) {
    spectra.second.assign(kSpectrumBins, 0.0);
    spectra.cross.assign(kSpectrumBins, 0.0);
  }
  return spectra;
}

/// Adds a share of a mode's power to a frequency; frequencies past the last are left out.
/// mode: its real coefficient for each field.
inline void addPower(FieldSpectra& spectra, int frequency, double share,
                     const Eigen::RowVectorXd& mode) {
  if (frequency > kSpectrumBins) return;
  const int at = frequency - 1;
  spectra.first[at] += share * mode[0] * mode[0];
  if (mode.size() < 2) return;
  spectra.second[at] += share * mode[1] * mode[1];
  spectra.cross[at] += share * mode[0] * mode[1];
}

}  // namespace moduli
