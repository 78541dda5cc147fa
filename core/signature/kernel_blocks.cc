#include "core/signature/kernel_blocks.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/linalg/dense_product.h"
#include "core/signature/soft_bins.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

/// Times from that at which a plane has lost its 50th mode to that at which a sphere has lost its
/// first, and twice over for surfaces that are longer: 1 / (4 pi k) for k = 32 .. 1/4.
double heatTime(int step) {
  return std::exp2(step - 5.0) / (4 * kPi);
}

/// Energies 4 pi k, k from 1/2 in steps of sqrt(2)^(3/2).
double waveEnergy(int step) {
  return 4 * kPi * std::exp2(0.75 * step - 1.0);
}
/// Of log energy.
constexpr double kWaveWidth = 0.5;
/// What the mean of psi^2 is at least counted as: logarithms of nodes stay bounded.
constexpr double kWaveFloor = 0.1;

double taperOf(const SurfaceModes& modes, Eigen::Index k) {
  return modeTaper(modes.values[k], modes.values[kModeCount - 1]);
}

/// weights: modes x signatures. Returns vertices x signatures: sums of weight psi^2.
Eigen::MatrixXd localSums(const SurfaceModes& modes, const Eigen::MatrixXd& weights) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(modes.functions.rows(), weights.cols());
  addProduct(1, modes.functions.cwiseAbs2(), weights, sums);
  return sums;
}

/// Quantiles by area of log(floor + column), column by column.
std::vector<std::vector<double>> logQuantiles(const SurfaceModes& modes,
                                              const Eigen::MatrixXd& columns, double floor) {
  std::vector<std::vector<double>> result;
  std::vector<double> values(modes.areas.size());
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    for (std::size_t v = 0; v < values.size(); ++v) {
      values[v] = std::log(floor + columns(static_cast<Eigen::Index>(v), column));
    }
    result.push_back(tailedQuantileMeans(values, modes.areas));
  }
  return result;
}

/// The first mode of every band, counted from 1, and the end of the last.
constexpr std::array<int, kSpectrumBands + 1> kBands = {1,  2,  3,  4,  5,  6,  7,  8,  10,
                                                        12, 14, 17, 20, 24, 29, 35, 42, 51};
static_assert(kBands.back() == kModeCount + 1);

}  // namespace

std::vector<double> logSpectrum(const SurfaceModes& modes) {
  std::vector<double> result(kModeCount);
  for (Eigen::Index k = 0; k < kModeCount; ++k) {
    result[k] = std::log(modes.values[k] / (4 * kPi * static_cast<double>(k + 1)));
  }
  return result;
}

std::vector<double> spectrumBands(const SurfaceModes& modes) {
  const std::vector<double> logs = logSpectrum(modes);
  std::vector<double> result;
  for (int band = 0; band < kSpectrumBands; ++band) {
    double sum = 0;
    for (int k = kBands[band]; k < kBands[band + 1]; ++k) sum += logs[k - 1];
    result.push_back(sum / std::sqrt(kBands[band + 1] - kBands[band]));
  }
  return result;
}

std::vector<double> heatTrace(const SurfaceModes& modes) {
  std::vector<double> result;
  for (int step = 0; step < kHeatTimes; ++step) {
    double trace = 1;
    for (Eigen::Index k = 0; k < kModeCount; ++k) {
      trace += taperOf(modes, k) * std::exp(-modes.values[k] * heatTime(step));
    }
    result.push_back(std::log(trace));
  }
  return result;
}

std::vector<std::vector<double>> heatKernelQuantiles(const SurfaceModes& modes) {
  Eigen::MatrixXd weights(kModeCount, kHeatTimes);
  for (Eigen::Index k = 0; k < kModeCount; ++k) {
    for (int step = 0; step < kHeatTimes; ++step) {
      weights(k, step) = taperOf(modes, k) * std::exp(-modes.values[k] * heatTime(step));
    }
  }
  return logQuantiles(modes, localSums(modes, weights), 1);
}

std::vector<std::vector<double>> waveKernelQuantiles(const SurfaceModes& modes) {
  Eigen::MatrixXd weights(kModeCount, kWaveEnergies);
  for (int step = 0; step < kWaveEnergies; ++step) {
    const auto weightAt = [step](double value) {
      const double distance = std::log(value / waveEnergy(step)) / kWaveWidth;
      return std::exp(-distance * distance / 2);
    };
    double total = 1e-3;  // A gap in the spectrum is no division by 0.
    for (Eigen::Index k = 0; k < kModeCount; ++k) {
      weights(k, step) = taperOf(modes, k) * weightAt(modes.values[k]);
      total += weights(k, step);
    }
    weights.col(step) /= total;
  }
  return logQuantiles(modes, localSums(modes, weights), kWaveFloor);
}

}  // namespace moduli
