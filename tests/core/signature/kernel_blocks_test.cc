#include "core/signature/kernel_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/signature/diffusion_distances.h"
#include "core/signature/field_blocks.h"
#include "tests/core/signature/modes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::modesOf;
using surfaces::sample;

constexpr double kPi = std::numbers::pi;

/// A sheet of 16 x 12 squares, folded along its middle line by an angle: all lengths stay.
TriangleMesh foldedSheet(double angle) {
  TriangleSoup soup;
  for (int i = 0; i <= 16; ++i) {
    for (int j = 0; j <= 12; ++j) {
      const double x = i - 8.0;
      soup.vertices.emplace_back(x <= 0 ? x : x * std::cos(angle), j,
                                 x <= 0 ? 0 : x * std::sin(angle));
    }
  }
  const auto at = [](int i, int j) { return static_cast<Index>(i * 13 + j); };
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 12; ++j) {
      soup.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh(soup);
}

TEST(KernelBlocks, OfASphereAreTheSameEverywhere) {
  // Homogeneous: psi^2 summed over a multiplet is its size, so the heat kernel signature is the
  // heat trace at every point and the wave kernel signature is the share of weight in the sum.
  // The icosahedral mesh of 2562 vertices keeps that to about its h^2 = 0.005.
  const SurfaceModes modes = modesOf(mesh(sample("sphere", {{"resolution", 16}})));
  const std::vector<double> trace = heatTrace(modes);
  const auto heat = heatKernelQuantiles(modes);
  for (int time = 0; time < kHeatTimes; ++time) {
    for (const double mean : heat[time]) EXPECT_NEAR(mean, trace[time], 0.02) << time;
  }
  for (const auto& wave : waveKernelQuantiles(modes)) EXPECT_LT(wave.back() - wave.front(), 0.04);
}

TEST(KernelBlocks, HeatTraceOfASphereIsTheSumOverDegrees) {
  // At 4 times 1 / 4 pi: 1 + sum (2 l + 1) exp(-4 l (l + 1)).
  const SurfaceModes modes = modesOf(mesh(sample("sphere", {{"resolution", 24}})));
  double exact = 1;
  for (int l = 1; l < 6; ++l) exact += (2 * l + 1) * std::exp(-4.0 * l * (l + 1));
  EXPECT_NEAR(heatTrace(modes).back(), std::log(exact), 1e-4 * std::log(exact) + 1e-5);
}

TEST(KernelBlocks, BandsKeepTheLogSpectrum) {
  const SurfaceModes modes = modesOf(mesh(sample("torus", {{"resolution", 12}})));
  const std::vector<double> logs = logSpectrum(modes), bands = spectrumBands(modes);
  EXPECT_NEAR(logs[0], std::log(modes.values[0] / (4 * kPi)), 1e-14);
  EXPECT_EQ(bands[6], logs[6]);
  EXPECT_NEAR(bands[7], (logs[7] + logs[8]) / std::numbers::sqrt2, 1e-14);
  EXPECT_EQ(bands.size(), std::size_t{kSpectrumBands});
}

TEST(KernelBlocks, DoNotSeeBending) {
  const SurfaceModes flat = modesOf(foldedSheet(0)), bent = modesOf(foldedSheet(2));
  const auto close = [](const std::vector<double>& a, const std::vector<double>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-8);
  };
  Context context;
  close(spectrumBands(flat), spectrumBands(bent));
  for (int time = 0; time < kHeatTimes; ++time) {
    close(heatKernelQuantiles(flat)[time], heatKernelQuantiles(bent)[time]);
  }
  const auto near_flat = diffusionDistances(context, flat);
  const auto near_bent = diffusionDistances(context, bent);
  ASSERT_OK(near_flat);
  ASSERT_OK(near_bent);
  close(*near_flat, *near_bent);
}

TEST(FieldAmplitudes, OfAModeAreItsSizeInTheWindowsOfItsValue) {
  const SurfaceModes modes = modesOf(mesh(sample("torus", {{"R", 2}, {"resolution", 20}})));
  std::vector<double> field(modes.areas.size());
  for (std::size_t v = 0; v < field.size(); ++v) {
    field[v] = 3 * modes.functions(static_cast<Eigen::Index>(v), 4);
  }
  const double place = std::log2(modes.values[4] / (4 * kPi)) + 2;
  const std::vector<double> amplitudes = fieldAmplitudes(modes, field);
  ASSERT_EQ(amplitudes.size(), std::size_t{kFieldWindows});
  for (int window = 0; window < kFieldWindows; ++window) {
    const double share = std::max(0.0, 1 - std::abs(place - window));
    EXPECT_NEAR(amplitudes[window], 3 * std::sqrt(share), 1e-6) << window;
  }
}

TEST(DiffusionDistances, OfASphereFollowTheAngle) {
  // A sphere is two-point homogeneous; its farthest pairs are antipodes. Half of all pairs are
  // farther than a right angle, so parts ascend and the middle lies between.
  Context context;
  const auto block = diffusionDistances(
      context, modesOf(mesh(sample("sphere", {{"resolution", 16}, {"seed", 2}}))));
  ASSERT_OK(block);
  ASSERT_EQ(block->size(), std::size_t{2 * kDiffusionParts});
  for (int i = 1; i < kDiffusionParts; ++i) EXPECT_GT((*block)[i], (*block)[i - 1]);
  // sum over odd l of 2 (2 l + 1) P_l(..) / mu^2 at antipodes: d^2 = sum 4 (2 l + 1) / mu^2, l odd.
  double squared = 0;
  for (int l = 1; l < 6; l += 2) squared += 4 * (2 * l + 1) / std::pow(4 * kPi * l * (l + 1), 2);
  // The last sixteenth of pairs is almost antipodal; logarithm of a mean plus 1 % of the largest.
  EXPECT_NEAR((*block)[kDiffusionParts - 1], std::log(1.01 * std::sqrt(squared)), 0.03);
}

}  // namespace
}  // namespace moduli
