#include "core/forms/energy_lattice.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "core/forms/lattice_reduction.h"
#include "core/forms/modular.h"
#include "core/forms/siegel.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
const Complex kI(0, 1);

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

/// Y = 1 + A A^T, X in [-1/2, 1/2].
MatrixXd randomEnergy(std::mt19937& random, Index g) {
  MatrixXd a(g, g);
  MatrixXcd period(g, g);
  for (double& entry : a.reshaped()) entry = uniform(random, -0.5, 0.5);
  period.real() = a.selfadjointView<Eigen::Upper>();
  period.imag() = 0.8 * MatrixXd::Identity(g, g) + a * a.transpose();
  return energyOfPeriod(period);
}

/// A product of elementary matrices: a change of basis of Z^n.
IntegerMatrix randomUnimodular(std::mt19937& random, Index n, int letters) {
  IntegerMatrix word = IntegerMatrix::Identity(n, n);
  for (int k = 0; k < letters; ++k) {
    const auto to = static_cast<Index>(random() % n);
    const auto from = static_cast<Index>(random() % n);
    const Integer times = random() % 2 == 0 ? 1 : -1;
    if (to == from) continue;
    EXPECT_OK(addRow(word, to, times, from));
  }
  return word;
}

MatrixXd directSum(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd sum = MatrixXd::Zero(a.rows() + b.rows(), a.rows() + b.rows());
  sum.topLeftCorner(a.rows(), a.rows()) = a;
  sum.bottomRightCorner(b.rows(), b.rows()) = b;
  return sum;
}

/// MATH 12.6, 12.5.
MatrixXd bolza() {
  const double r2 = std::sqrt(2.0);
  MatrixXcd period(2, 2);
  period << Complex(-2, 2 * r2), Complex(1, -r2), Complex(1, -r2), Complex(-2, 2 * r2);
  return energyOfPeriod(period / 3.0);
}

MatrixXd lawson() {
  MatrixXcd period(2, 2);
  period << 2.0 * kI, kI, kI, 2.0 * kI;
  return energyOfPeriod(period / std::sqrt(3.0));
}

MatrixXd klein() {
  const Complex s(0, std::sqrt(7.0));
  MatrixXcd period(3, 3);
  period << -1.0 + 3.0 * s, -2.0 - 2.0 * s, -3.0 + s,  //
      -2.0 - 2.0 * s, 4.0 + 4.0 * s, -2.0 - 2.0 * s,   //
      -3.0 + s, -2.0 - 2.0 * s, 7.0 + 3.0 * s;
  return energyOfPeriod(period / 8.0);
}

MatrixXd threeSquares() {
  MatrixXcd period(2, 2);
  period << 5.0 * kI, 4.0 * kI, 4.0 * kI, 5.0 * kI;
  return energyOfPeriod(period / 3.0);
}

/// The root lattice E8: 240 vectors of square 2, 2160 of square 4, all primitive.
MatrixXd e8() {
  MatrixXd gram = 2 * MatrixXd::Identity(8, 8);
  const auto join = [&](Index i, Index j) { gram(i, j) = gram(j, i) = -1; };
  for (Index i = 0; i < 6; ++i) join(i, i + 1);
  join(4, 7);
  return gram;
}

/// The double of a plate with 2 x columns holes: X = 0, Y^-1 the Laplacian of a grid with its rim
/// grounded and uneven weights.
MatrixXd plateDouble(Index columns) {
  const Index g = 2 * columns;
  MatrixXd laplacian = MatrixXd::Zero(g, g);
  const auto weight = [](Index i) { return 1 + 0.2 * std::sin(static_cast<double>(i * i)); };
  const auto join = [&](Index i, Index j) {
    laplacian(i, i) += weight(i + j);
    laplacian(j, j) += weight(i + j);
    laplacian(i, j) = laplacian(j, i) = -weight(i + j);
  };
  for (Index c = 0; c < columns; ++c) {
    join(2 * c, 2 * c + 1);
    laplacian(2 * c, 2 * c) += weight(3 * c);
    laplacian(2 * c + 1, 2 * c + 1) += weight(3 * c + 1);
    if (c == 0) continue;
    join(2 * c, 2 * c - 2);
    join(2 * c + 1, 2 * c - 1);
  }
  const MatrixXd inverse = laplacian.inverse();
  MatrixXcd period = MatrixXcd::Zero(g, g);
  period.imag() = inverse + inverse.transpose();
  return energyOfPeriod(period);
}

struct Vector {
  double energy;
  bool primitive;
};

/// All vectors but 0 with energies up to `radius`, from the box |v_i| <= sqrt(radius (E^-1)_ii),
/// ascending.
std::vector<Vector> bruteForce(const MatrixXd& energy, double radius) {
  const Index n = energy.rows();
  const Eigen::VectorXd box =
      (radius * energy.inverse().diagonal()).cwiseSqrt().unaryExpr([](double x) {
        return std::floor(x + 1e-9);
      });
  std::vector<Vector> vectors;
  Eigen::VectorXd v = -box;
  while (true) {
    const double value = v.dot(energy * v);
    int divisor = 0;
    for (const double x : v) divisor = std::gcd(divisor, static_cast<int>(x));
    if (divisor > 0 && value <= radius) vectors.push_back({value, divisor == 1});
    Index i = 0;
    while (i < n && v(i) == box(i)) {
      v(i) = -box(i);
      ++i;
    }
    if (i == n) break;
    v(i) += 1;
  }
  std::sort(vectors.begin(), vectors.end(),
            [](const Vector& a, const Vector& b) { return a.energy < b.energy; });
  return vectors;
}

/// The energies of one of each primitive pair.
std::vector<double> primitivePairs(const std::vector<Vector>& vectors) {
  std::vector<double> energies;
  for (const Vector& vector : vectors) {
    if (vector.primitive) energies.push_back(vector.energy);
  }
  for (std::size_t i = 0; 2 * i < energies.size(); ++i) energies[i] = energies[2 * i];
  energies.resize(energies.size() / 2);
  return energies;
}

std::vector<double> shortest(const MatrixXd& energy, std::size_t count) {
  Context context;
  const auto energies = shortestEnergies(context, energy, count);
  EXPECT_OK(energies);
  return energies.ok() ? *energies : std::vector<double>(count);
}

std::vector<double> theta(const MatrixXd& energy, const std::vector<double>& t) {
  Context context;
  const auto sums = thetaSums(context, energy, t);
  EXPECT_OK(sums);
  return sums.ok() ? *sums : std::vector<double>(t.size());
}

void expectNear(const std::vector<double>& found, const std::vector<double>& expected,
                double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i], expected[i], tolerance * expected[i]) << i;
  }
}

/// `count` vectors, that is half as many values, of each energy.
std::vector<double> spectrum(const std::vector<std::pair<double, int>>& shells) {
  std::vector<double> energies;
  for (const auto& [energy, count] : shells) energies.insert(energies.end(), count / 2, energy);
  return energies;
}

TEST(EnergyLattice, ShortestVectorsEqualBruteForce) {
  std::mt19937 random(1);
  for (const Index g : {1, 2, 3}) {
    for (int trial = 0; trial < 6; ++trial) {
      const MatrixXd energy = randomEnergy(random, g);
      const std::vector<double> expected = primitivePairs(bruteForce(energy, g == 3 ? 3 : 9));
      ASSERT_GT(expected.size(), 5);
      const auto found = shortest(energy, expected.size());
      expectNear(found, expected, 1e-13);
      // One more lies beyond the radius of the brute force.
      EXPECT_GT(shortest(energy, expected.size() + 1).back(), g == 3 ? 3 : 9);
    }
  }
}

TEST(EnergyLattice, CountsEachPairOnceAndMultiplesNever) {
  // In Z^2 with energies x^2 + y^2 the primitive pairs are 1, 1, 2, 2, 5 x 4, 10 x 4, 13 x 4: no 4,
  // 8 or 9.
  expectNear(shortest(MatrixXd::Identity(2, 2), 16),
             {1, 1, 2, 2, 5, 5, 5, 5, 10, 10, 10, 10, 13, 13, 13, 13}, 1e-15);
}

TEST(EnergyLattice, OneDimensionHasOnePair) {
  const MatrixXd energy = MatrixXd::Constant(1, 1, 0.7);
  expectNear(shortest(energy, 5), {0.7}, 1e-16);
  EXPECT_TRUE(shortest(energy, 0).empty());
  // pi^(1/4) / Gamma(3/4) = sum over n of exp(-pi n^2).
  expectNear(theta(MatrixXd::Ones(1, 1), {1}), {std::pow(kPi, 0.25) / std::tgamma(0.75)}, 1e-15);
}

TEST(EnergyLattice, KnownSurfacesHaveTheirSpectra) {
  const double r2 = std::sqrt(2.0);
  const double r3 = std::sqrt(3.0);
  const double r7 = std::sqrt(7.0);
  expectNear(shortest(bolza(), 24), spectrum({{r2, 24}, {2 * r2, 24}}), 1e-13);
  EXPECT_GT(shortest(bolza(), 25).back(), 2 * r2 + 0.1);
  expectNear(shortest(lawson(), 24), spectrum({{2 / r3, 12}, {4 / r3, 36}}), 1e-13);
  EXPECT_GT(shortest(lawson(), 25).back(), 4 / r3 + 0.1);
  expectNear(shortest(klein(), 49), spectrum({{4 / r7, 42}, {6 / r7, 56}}), 1e-13);
  EXPECT_GT(shortest(klein(), 50).back(), 6 / r7 + 0.1);
}

/// The four vectors of energy 8/3 are the doubles of those of 2/3.
TEST(EnergyLattice, ThreeSquaresLackTheDoubles) {
  const auto found = shortest(threeSquares(), 17);
  const std::vector<std::pair<double, int>> shells = {
      {2 / 3.0, 4}, {4 / 3.0, 4}, {5 / 3.0, 8}, {7 / 3.0, 16}};
  expectNear({found.begin(), found.end() - 1}, spectrum(shells), 1e-13);
  EXPECT_GT(found.back(), 8 / 3.0 + 0.1);
  const auto all = bruteForce(threeSquares(), 8 / 3.0 + 1e-9);
  EXPECT_EQ(all.size(), 36);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const Vector& v) { return !v.primitive; }), 4);
}

TEST(EnergyLattice, SpectrumAndThetaDoNotDependOnTheBasis) {
  std::mt19937 random(2);
  for (const Index g : {1, 2, 3, 4}) {
    const MatrixXd energy = randomEnergy(random, g);
    const auto expected = shortest(energy, 20);
    const auto sums = theta(energy, {1.25, 2});
    for (int trial = 0; trial < 5; ++trial) {
      const MatrixXd image = congruence(randomUnimodular(random, 2 * g, 10), energy);
      expectNear(shortest(image, 20), expected, 1e-10);
      expectNear(theta(image, {1.25, 2}), sums, 1e-10);
    }
  }
}

TEST(EnergyLattice, RootLatticeE8HasItsThetaSeries) {
  std::mt19937 random(3);
  const MatrixXd gram = congruence(randomUnimodular(random, 8, 30), e8());
  expectNear(
      shortest(gram, 1201),
      [] {
        auto energies = spectrum({{2, 240}, {4, 2160}});
        energies.push_back(6);
        return energies;
      }(),
      1e-13);
  // Its theta series is E4 = 1 + 240 sum n^3 q^n / (1 - q^n) with q = exp(-2 pi t).
  const std::vector<double> t = {0.8, 1, 1.5, 2};
  std::vector<double> expected;
  for (const double each : t) {
    double sum = 0;
    for (int n = 1; n < 30; ++n) {
      const double q = std::exp(-2 * kPi * each * n);
      sum += n * n * n * q / (1 - q);
    }
    expected.push_back(1 + 240 * sum);
  }
  expectNear(theta(gram, t), expected, 1e-14);
}

TEST(Theta, EqualsBruteForce) {
  std::mt19937 random(4);
  for (const Index g : {1, 2, 3}) {
    const MatrixXd energy = randomEnergy(random, g);
    const std::vector<double> t = {g == 3 ? 4.0 : 1.0, 5.0};
    std::vector<double> above = {0, 0};  // Theta - 1.
    for (const Vector& v : bruteForce(energy, g == 3 ? 4.5 : 16)) {
      for (int i = 0; i < 2; ++i) above[i] += std::exp(-kPi * t[i] * v.energy);
    }
    expectNear(theta(energy, t), {1 + above[0], 1 + above[1]}, 1e-14);
    Context context;
    const auto features = thetaFeatures(context, energy, t);
    ASSERT_OK(features);
    expectNear(*features, {-std::log(above[0]) / (kPi * t[0]), -std::log(above[1]) / (kPi * t[1])},
               1e-14);
  }
}

TEST(Theta, ThreeSquaresHaveTheirSums) {
  const auto sums = theta(threeSquares(), {1, 1.5, 2});
  expectNear(sums, {1.6087333276801, 1.1837233799423, 1.0618120503716}, 1e-13);
}

TEST(Theta, SatisfiesTheFunctionalEquation) {
  std::mt19937 random(5);
  std::vector<MatrixXd> energies = {bolza(), lawson(), klein(), threeSquares()};
  for (const Index g : {1, 2, 3, 4}) energies.push_back(randomEnergy(random, g));
  const std::vector<double> t = {1.25, 1.5, 2};
  for (const MatrixXd& energy : energies) {
    const auto sums = theta(energy, {1.25, 1.5, 2, 1 / 1.25, 1 / 1.5, 1 / 2.0});
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected = std::pow(t[i], static_cast<double>(energy.rows()) / 2) * sums[i];
      EXPECT_NEAR(sums[i + 3] / expected, 1, 1e-12);
    }
  }
}

TEST(Theta, SumsTogetherEqualSumsAlone) {
  const std::vector<double> t = {3, 1, 2};
  const auto together = theta(klein(), t);
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(together[i], theta(klein(), {t[i]})[0], 1e-15 * together[i]);
  }
  EXPECT_TRUE(theta(klein(), {}).empty());
}

TEST(Theta, FeaturesKeepTheirDigits) {
  Context context;
  const auto near = thetaFeatures(context, threeSquares(), {1, 2});
  ASSERT_OK(near);
  expectNear(*near, {-std::log(0.6087333276801) / kPi, -std::log(0.0618120503716) / (2 * kPi)},
             1e-12);
  // Four vectors of energy 2/3; Theta - 1 is 1e-90 at t = 100, and 0 in doubles at t = 1000.
  const auto far = thetaFeatures(context, threeSquares(), {100, 1000});
  ASSERT_OK(far);
  expectNear(*far, {2 / 3.0 - std::log(4) / (100 * kPi), 2 / 3.0 - std::log(4) / (1000 * kPi)},
             1e-14);
}

TEST(Theta, OfTheSpectrumIsThatOfAllUpToWhatIsLeftOut) {
  Context context;
  const std::vector<double> t = {1, 2, 4};
  std::mt19937 random(6);
  std::vector<MatrixXd> energies = {bolza(), lawson(), threeSquares(), randomEnergy(random, 2)};
  for (const MatrixXd& energy : energies) {
    const auto known = shortestEnergies(context, energy, 200);
    const auto more = shortestEnergies(context, energy, 2000);
    const auto whole = thetaFeatures(context, energy, t);
    ASSERT_TRUE(known.ok() && more.ok() && whole.ok());
    const auto features = spectrumThetaFeatures(*known, t);
    const auto nearly = spectrumThetaFeatures(*more, t);
    for (std::size_t i = 0; i < t.size(); ++i) {
      // The sum lacks terms, which makes its -log larger; the ten times longer list lacks few.
      const double above = std::exp(-kPi * t[i] * (*whole)[i]);
      double left_out = 0;
      for (std::size_t n = known->size(); n < more->size(); ++n) {
        for (int k = 1; k < 4; ++k) left_out += 2 * std::exp(-kPi * t[i] * k * k * (*more)[n]);
      }
      EXPECT_GE(features[i], (*whole)[i] - 1e-14);
      EXPECT_NEAR(nearly[i], (*whole)[i], 1e-9);
      EXPECT_NEAR(std::exp(-kPi * t[i] * features[i]) + left_out, above, 1e-9 * above);
    }
  }
}

TEST(Theta, OfTheSpectrumCountsMultiplesOfTheSmallestEnergies) {
  // 2 sum over k of exp(-pi t k^2 E), term by term; both ways of summing meet at t E = 1.
  for (const double energy : {1e-4, 1e-2, 0.999999, 1.0, 1.000001, 3.0}) {
    const double t = 1;
    double sum = 0;
    for (int k = 2000; k > 0; --k) sum += 2 * std::exp(-kPi * t * k * k * energy);
    EXPECT_NEAR(spectrumThetaFeatures({energy}, {t})[0], -std::log(sum) / kPi, 1e-13);
  }
  // Of energies that vanish it goes like the logarithm: 1 / sqrt(t E) - 1.
  EXPECT_NEAR(spectrumThetaFeatures({1e-20}, {1})[0], -std::log(1e10 - 1) / kPi, 1e-12);
  // Terms below what a double holds keep their digits.
  EXPECT_NEAR(spectrumThetaFeatures({300, 301}, {2})[0], 300 - std::log(2) / (2 * kPi), 1e-3);
}

TEST(EnergyLattice, ThreeCopiesOfE8InDimension24) {
  std::mt19937 random(6);
  const MatrixXd sum = directSum(directSum(e8(), e8()), e8());
  const MatrixXd gram = congruence(randomUnimodular(random, 24, 60), sum);
  const auto found = shortest(gram, 361);
  EXPECT_NEAR(found[0], 2, 1e-13);
  EXPECT_NEAR(found[359], 2, 1e-13);
  EXPECT_NEAR(found[360], 4, 1e-13);
  EXPECT_NEAR(theta(gram, {6})[0] / std::pow(theta(e8(), {6})[0], 3), 1, 1e-14);
}

TEST(EnergyLattice, PlateDoublesOfDimension24And52AgreeInEveryBasis) {
  std::mt19937 random(7);
  for (const Index columns : {6, 13}) {
    const MatrixXd energy = plateDouble(columns);
    const auto n = static_cast<int>(energy.rows());
    const auto expected = shortest(energy, 64);
    for (int trial = 0; trial < 3; ++trial) {
      const MatrixXd image = congruence(randomUnimodular(random, n, 2 * n), energy);
      expectNear(shortest(image, 64), expected, 1e-11);
    }
    // Orthogonal sums add their spectra, and the sums of vectors from both.
    const Index g = energy.rows() / 2;
    const double alpha = shortest(energy.topLeftCorner(g, g), 1)[0];
    const double beta = shortest(energy.bottomRightCorner(g, g), 1)[0];
    EXPECT_NEAR(expected[0], std::min(alpha, beta), 1e-14);
  }
}

TEST(EnergyLattice, GenericFormsOfDimension52AgreeInEveryBasis) {
  std::mt19937 random(8);
  const MatrixXd energy = randomEnergy(random, 26);
  const MatrixXd image = congruence(randomUnimodular(random, 52, 100), energy);
  expectNear(shortest(image, 16), shortest(energy, 16), 1e-11);
}

TEST(Faults, FormsThatAreNotPositiveDefiniteAreRefused) {
  Context context;
  MatrixXd not_a_number = MatrixXd::Identity(3, 3);
  not_a_number(1, 1) = std::nan("");
  const MatrixXd indefinite{{1, 2}, {2, 1}};
  for (const MatrixXd& energy : {not_a_number, indefinite, MatrixXd()}) {
    for (const std::size_t count : {0, 3}) {
      EXPECT_THAT(shortestEnergies(context, energy, count),
                  FailsWith(Reason::kNotPositiveDefinite));
    }
    EXPECT_THAT(thetaSums(context, energy, {1}), FailsWith(Reason::kNotPositiveDefinite));
    EXPECT_THAT(thetaFeatures(context, energy, {1}), FailsWith(Reason::kNotPositiveDefinite));
  }
  const Eigen::Matrix2d far{{1, 1e19}, {1e19, 2e38}};
  EXPECT_THAT(shortestEnergies(context, far, 1), FailsWith(Reason::kOverflow));
}

TEST(Faults, TimesThatAreNotPositiveAreRefused) {
  Context context;
  for (const double t : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(thetaSums(context, klein(), {1, t}), FailsWith(Reason::kInvalidOption));
    EXPECT_THAT(thetaFeatures(context, klein(), {t}), FailsWith(Reason::kInvalidOption));
  }
}

TEST(Faults, LimitOfNodesIsKeptAndNamed) {
  Context context;
  const auto few = shortestEnergies(context, klein(), 100, 50);
  EXPECT_THAT(few, FailsWith(Reason::kNoConvergence));
  EXPECT_THAT(few.status().message(), HasSubstr("more than 50 nodes"));
  EXPECT_THAT(thetaSums(context, klein(), {1}, 1000), FailsWith(Reason::kNoConvergence));
  EXPECT_OK(thetaSums(context, klein(), {1}, 1000000));
}

TEST(Faults, CancellationStopsTheEnumeration) {
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  std::mt19937 random(9);
  EXPECT_THAT(thetaSums(context, randomEnergy(random, 8), {1}), FailsWith(Reason::kCancelled));
}

}  // namespace
}  // namespace moduli
