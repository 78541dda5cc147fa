#include "core/signature/conformal_vector.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "core/hyperbolic/dirichlet_domain.h"
#include "core/hyperbolic/fenchel_nielsen.h"
#include "core/intrinsic/intrinsic_samples.h"
#include "tests/core/hyperbolic/hexagon_pants.h"
#include "tests/core/signature/stretched_surfaces.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

/// Where what begins.
constexpr std::size_t kEnergies = 2, kThetas = 34, kLengths = 38, kBoundary = 50;

Signature sign(const std::string& kind, std::map<std::string, double> parameters) {
  Context context;
  const auto prepared = prepareMesh(context, surfaces::sample(kind, parameters), {});
  EXPECT_OK(prepared);
  SignatureOptions options;
  options.space = Space::kConformal;
  auto signature = computeSignature(context, *prepared, options);
  EXPECT_OK(signature);
  return *std::move(signature);
}

Signature signIntrinsic(const IntrinsicSurface& surface, std::optional<double> length = {}) {
  Context context;
  SignatureOptions options;
  options.spectrum_length = length;
  auto signature = computeIntrinsicSignature(context, surface, options);
  EXPECT_OK(signature);
  return *std::move(signature);
}

TEST(ConformalVector, HasOneLengthForEachType) {
  const auto lengthOf = [](const std::string& kind, std::map<std::string, double> parameters) {
    parameters["resolution"] = 4;
    const Signature signature = sign(kind, parameters);
    EXPECT_EQ(conformalVectorLength(signature.conformal->type), signature.vectors.conformal.size());
    return signature.vectors.conformal.size();
  };
  EXPECT_EQ(lengthOf("sphere", {}), 1U);
  EXPECT_EQ(lengthOf("disk", {}), 1U);
  EXPECT_EQ(lengthOf("annulus", {}), 1U);
  EXPECT_EQ(lengthOf("torus", {}), 4U);
  EXPECT_EQ(lengthOf("genus", {{"genus", 2}}), kHyperbolicLength);
  EXPECT_EQ(lengthOf("genus", {{"genus", 3}}), kHyperbolicLength);
  EXPECT_EQ(lengthOf("plate", {{"holes", 2}}), kBorderedLength);
  EXPECT_EQ(lengthOf("plate", {{"holes", 4}}), kBorderedLength);
}

TEST(ConformalVector, OfBolzaHasItsKnownNumbers) {
  const std::vector<float> vector = signIntrinsic(*makeIntrinsicSample("bolza")).vectors.conformal;
  ASSERT_EQ(vector.size(), kHyperbolicLength);
  EXPECT_EQ(vector[0], 2 * kTopologyStep);
  EXPECT_EQ(vector[1], 0);
  // Twelve energies sqrt 2 and twelve 2 sqrt 2 (CHECKS D2); twelve systoles, cut off at 1.5 times
  // that (CHECKS G1). Floats carry seven digits.
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(vector[kEnergies + i], std::log(2) / 4, 1e-7);
    EXPECT_NEAR(vector[kLengths + i], std::log(2 * std::acosh(1 + std::sqrt(2))) / 2, 1e-7);
  }
  EXPECT_NEAR(vector[kEnergies + 12], std::log(8) / 4, 1e-7);
  const std::vector<double> times = {1, 1.5, 2, 3};
  for (std::size_t i = 0; i < times.size(); ++i) {
    // Of both energies 24 classes are there, of the next one, 3 sqrt 2, 16; the doubles of the
    // first have 4 sqrt 2.
    const double x = std::exp(-M_PI * times[i] * std::sqrt(2));
    const double sum = 24 * x + 24 * x * x + 16 * x * x * x + 24 * x * x * x * x;
    EXPECT_NEAR(vector[kThetas + i], -std::log(sum) / (2 * M_PI * times[i]), 1e-7);
  }
}

TEST(ConformalVector, DoesNotDependOnTheSpectrumThatIsAskedFor) {
  const IntrinsicSurface klein = *makeIntrinsicSample("klein");
  const std::vector<float> vector = signIntrinsic(klein).vectors.conformal;
  EXPECT_EQ(signIntrinsic(klein, 1).vectors.conformal, vector);
  EXPECT_EQ(signIntrinsic(klein, 6).vectors.conformal, vector);
}

TEST(ConformalVector, OfASurfaceWithoutGeodesicsIsThatOfItsEnergies) {
  const Signature pants = signIntrinsic(hexagonPants({2.0, 2.4, 3.0}));
  const std::vector<double> lengths(kFirstLengths, 2.5);
  ConformalBlock block = *pants.conformal;
  const auto whole = conformalVector(block, pants.topology, lengths);
  const auto without = conformalVector(block, pants.topology, {});
  ASSERT_EQ(without.size(), kBorderedLength);
  for (std::size_t i = 0; i < kBorderedLength; ++i) {
    const bool length = i >= kLengths && i < kLengths + kFirstLengths;
    EXPECT_EQ(without[i], length ? 0 : whole[i]) << i;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(whole[kBoundary + i], std::log(block.boundary_lengths[i]) / 2, 1e-15);
  }
  for (std::size_t i = 3; i < kBoundaryCount; ++i) EXPECT_EQ(whole[kBoundary + i], 0);
  block.energy_spectrum.clear();
  const auto geodesics = conformalVector(block, pants.topology, lengths);
  ASSERT_EQ(geodesics.size(), kBorderedLength);
  EXPECT_EQ(geodesics[kEnergies], 0);
  EXPECT_EQ(geodesics[kLengths], whole[kLengths]);
  block.boundary_lengths.clear();
  EXPECT_TRUE(conformalVector(block, pants.topology, {}).empty());
}

/// Along the stretching of translation surfaces, through Bolza's surface where twelve classes
/// change places, and through three squares. Teichmüller distance is t, which bounds the changes
/// of logarithms: of energies exactly (conformal_bounds_test.cc), of lengths with room to spare.
/// Theta features: half the mean of energies, weighted by their terms, times t; the mean is below
/// the largest energy of all. No jump, however small a step, is let pass.
TEST(ConformalVector, ChangesNoFasterThanSurfacesAreStretched) {
  for (const int corners : {8, 0}) {
    for (const double step : {0.02, 0.005}) {
      SCOPED_TRACE(step);
      std::vector<Signature> path;
      for (int i = -4; i <= 4; ++i) {
        const double t = i * step;
        path.push_back(signatureOf(subdivide(
            corners == 8 ? stretchedPolygon(8, std::numbers::pi / 8, t) : stretchedL(t), 3)));
      }
      double largest = 0;
      for (std::size_t n = 0; n + 1 < path.size(); ++n) {
        const std::vector<float>&x = path[n].vectors.conformal, &y = path[n + 1].vectors.conformal;
        ASSERT_EQ(x.size(), kHyperbolicLength);
        ASSERT_EQ(y.size(), kHyperbolicLength);
        for (std::size_t i = 0; i < x.size(); ++i) {
          const bool theta = i >= kThetas && i < kLengths;
          const double rate = theta ? path[n].conformal->energy_spectrum.back() : 1.0;
          EXPECT_LE(std::abs(x[i] - y[i]), rate * step + 1e-6) << "coordinate " << i;
          largest = std::max<double>(largest, std::abs(x[i] - y[i]) / step);
        }
      }
      EXPECT_GT(largest, 0.5);
    }
  }
}

/// The first cuff passes the others on its way. Pants have exact lengths whatever their triangles
/// are. A jump would stay what it is where steps are a quarter as long.
TEST(ConformalVector, OfPantsHasNoJumpsWhereCuffsChangePlaces) {
  constexpr double kStep = 0.02;
  std::vector<std::vector<float>> path;
  for (int i = 0; i <= 20; ++i) {
    path.push_back(signIntrinsic(hexagonPants({1.8 + kStep * i, 2.0, 2.1})).vectors.conformal);
    ASSERT_EQ(path.back().size(), kBorderedLength);
  }
  const auto largest = [&](std::size_t stride, std::size_t begin, std::size_t end) {
    double step = 0;
    for (std::size_t n = 0; n + stride < path.size(); n += stride) {
      for (std::size_t i = begin; i < end; ++i) {
        step = std::max<double>(step, std::abs(path[n][i] - path[n + stride][i]));
      }
    }
    return step;
  };
  EXPECT_LT(largest(1, kLengths, kBoundary), largest(4, kLengths, kBoundary) / 2);
  EXPECT_GT(largest(4, kLengths, kBoundary), 0.01);
  const double first = std::log(1 + kStep / 1.8) / 2;
  EXPECT_NEAR(largest(1, kBoundary, kBorderedLength), first, 1e-6);
}

std::vector<double> firstLengthsOf(const FenchelNielsen& coordinates) {
  Context context;
  const auto group = groupFromFenchelNielsen(coordinates);
  EXPECT_OK(group);
  const auto polygon = orbitPolygon(context, group->generators, coordinates.genus);
  EXPECT_OK(polygon);
  const auto spectrum = shortGeodesics(context, *polygon, kLeastReach);
  EXPECT_OK(spectrum);
  return firstLengths(*spectrum);
}

/// A twist by s along a curve c changes the length of another by at most s per crossing, and each
/// crossing takes that one through the collar of c, of width 2 w, sinh w = 1 / sinh(l_c / 2). So
/// |d log(length) / ds| <= 1 / (2 w) for all, and for what is sorted and cut off from them.
TEST(FirstLengths, ChangeNoFasterThanATwist) {
  const double curve = 2.2;
  const double width = std::asinh(1 / std::sinh(curve / 2));
  for (const double step : {0.1, 0.01}) {
    std::vector<double> before;
    double largest = 0;
    for (double twist = -0.6; twist < 0.6; twist += step) {
      const std::vector<double> lengths =
          firstLengthsOf({2, {{0, 2, 4}, {1, 3, 5}}, {curve, 2.6, 2.9}, {twist, 0.4, -0.7}});
      ASSERT_EQ(lengths.size(), kFirstLengths);
      for (std::size_t i = 0; i < before.size(); ++i) {
        const double change = std::abs(std::log(lengths[i] / before[i]));
        EXPECT_LE(change, step / (2 * width) + 1e-9) << i << " at " << twist;
        largest = std::max(largest, change / (step / (2 * width)));
      }
      before = lengths;
    }
    EXPECT_GT(largest, 0.1);
    std::cout << "steps " << step << ": at most " << largest << " of the bound\n";
  }
}

/// The shortest curve changes hands where the first one becomes as long as the second, and others
/// come below the cut and leave it. Of steps a sixteenth as long the largest is at most an eighth
/// of that of the whole ones: a jump would stay what it is.
TEST(FirstLengths, HaveNoJumpsWhereTheSystoleChangesHands) {
  std::vector<std::vector<double>> path;
  for (int i = 0; i <= 64; ++i) {
    path.push_back(
        firstLengthsOf({2, {{0, 2, 4}, {1, 3, 5}}, {1.6 + i / 64.0, 2.2, 2.5}, {0.3, 0, 0.2}}));
  }
  EXPECT_NEAR(path.front()[0], 1.6, 1e-9);
  EXPECT_NEAR(path.back()[0], 2.2, 1e-9);
  const auto largest = [&](std::size_t stride) {
    double step = 0;
    for (std::size_t n = 0; n + stride < path.size(); n += stride) {
      for (std::size_t i = 0; i < kFirstLengths; ++i) {
        step = std::max(step, std::abs(path[n][i] - path[n + stride][i]));
      }
    }
    return step;
  };
  EXPECT_LT(largest(1), largest(16) / 8);
  EXPECT_GT(largest(16), 0.1);
}

TEST(FirstLengths, ChangeNoFasterThanTheSystoleWhereTheCutChangesItsRule) {
  // The cut is 4 below systoles of 8/3, and 1.5 of them above.
  std::vector<double> before;
  for (double systole = 2.6; systole < 2.75; systole *= 1.001) {
    LengthSpectrum spectrum;
    spectrum.geodesics = {{systole, {}, {}}, {3.0, {}, {}}};
    spectrum.complete_to = std::max(4.0, 1.5 * systole);
    const std::vector<double> lengths = firstLengths(spectrum);
    EXPECT_EQ(lengths.back(), spectrum.complete_to);
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_LE(std::abs(std::log(lengths[i] / before[i])), std::log(1.001) + 1e-12);
    }
    before = lengths;
  }
}

TEST(FirstLengths, AreCutOffAndFilledUp) {
  LengthSpectrum spectrum;
  for (const double length : {1.0, 2.0, 3.0}) spectrum.geodesics.push_back({length, {}, {}});
  spectrum.complete_to = 5;
  std::vector<double> expected(kFirstLengths, 4.0);
  std::copy_n(std::vector{1.0, 2.0, 3.0}.begin(), 3, expected.begin());
  EXPECT_EQ(firstLengths(spectrum), expected);
  spectrum.complete_to = 3.5;
  std::fill(expected.begin() + 3, expected.end(), 3.5);
  EXPECT_EQ(firstLengths(spectrum), expected);
  spectrum.geodesics = {{3.0, {}, {}}, {4.6, {}, {}}};
  spectrum.complete_to = 5;
  std::fill(expected.begin(), expected.end(), 4.5);
  expected[0] = 3;
  EXPECT_EQ(firstLengths(spectrum), expected);
}

}  // namespace
}  // namespace moduli
