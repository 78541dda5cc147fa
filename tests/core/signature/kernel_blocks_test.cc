#include "core/signature/kernel_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

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
  close(spectrumBands(flat), spectrumBands(bent));
  for (int time = 0; time < kHeatTimes; ++time) {
    close(heatKernelQuantiles(flat)[time], heatKernelQuantiles(bent)[time]);
  }
}

}  // namespace
}  // namespace moduli
