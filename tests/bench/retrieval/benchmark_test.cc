#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/samples.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/bench/retrieval/deform.h"
#include "tests/bench/retrieval/descriptors.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/bench/retrieval/score.h"
#include "tests/bench/retrieval/variants.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Eigen::Vector3d;

TriangleSoup sample(const std::string& kind, double resolution) {
  return *makeSample(kind, {{"resolution", resolution}, {"seed", 3}});
}

double signedVolume(const TriangleSoup& soup) {
  double volume = 0;
  for (const Triangle& t : soup.faces) {
    volume += soup.vertices[t[0]].dot(soup.vertices[t[1]].cross(soup.vertices[t[2]])) / 6;
  }
  return volume;
}

// Per side of a face, its length afterwards over its length before.
std::vector<double> stretches(const TriangleSoup& before, const TriangleSoup& after) {
  std::vector<double> factors;
  for (const Triangle& t : before.faces) {
    for (int c = 0; c < 3; ++c) {
      const Index a = t[c], b = t[(c + 1) % 3];
      factors.push_back((after.vertices[a] - after.vertices[b]).norm() /
                        (before.vertices[a] - before.vertices[b]).norm());
    }
  }
  return factors;
}

TEST(Variants, AreOfAllKindsAndTheSameForTheSameSeed) {
  for (const auto& [kind, resolution] :
       {std::pair("sphere", 8.0), {"torus", 12.0}, {"genus", 4.0}}) {
    const BaseShape base{kind, sample(kind, resolution), sample(kind, resolution / 2)};
    const auto variants = makeVariants(base, 1);
    ASSERT_OK(variants);  // Topology is checked there.
    const auto again = makeVariants(base, 1), others = makeVariants(base, 2);
    ASSERT_EQ(variants->size(), variantKinds().size());
    for (std::size_t i = 0; i < variants->size(); ++i) {
      EXPECT_EQ((*variants)[i].kind, variantKinds()[i]);
      EXPECT_EQ((*variants)[i].soup.faces, (*again)[i].soup.faces);
      EXPECT_EQ((*variants)[i].soup.vertices, (*again)[i].soup.vertices);
      EXPECT_EQ((*variants)[i].soup.vertices == (*others)[i].soup.vertices, i == 0);
    }
  }
}

TEST(Variants, HaveTheirShareOfTheFaces) {
  const TriangleSoup torus = sample("torus", 20);
  const auto faces = torus.faces.size();
  EXPECT_EQ(simplified(torus, faces / 2).faces.size(), faces / 2);
  EXPECT_EQ(simplified(torus, faces / 4).faces.size(), faces / 4);
  SampleRandom random(1);
  EXPECT_EQ(refinedUnevenly(torus, random).faces.size(), faces + 2 * (faces / 4));
}

// A chord of length e of the unit sphere lies within e^2 / 8 of it, and so does every point of a
// polyhedron with such edges, to first order; moving and flipping can do that once more each.
TEST(Refined, StaysOnTheSurface) {
  const TriangleSoup sphere = sample("sphere", 12);
  double longest = 0;
  for (const Triangle& t : sphere.faces) {
    longest = std::max(longest, (sphere.vertices[t[0]] - sphere.vertices[t[1]]).norm());
  }
  SampleRandom random(1);
  const TriangleSoup refined = refinedUnevenly(sphere, random);
  std::size_t unmoved = 0;
  for (std::size_t v = 0; v < refined.vertices.size(); ++v) {
    EXPECT_LE(refined.vertices[v].norm(), 1 + 1e-12);
    EXPECT_GE(refined.vertices[v].norm(), 1 - 3 * longest * longest / 8);
    if (v < sphere.vertices.size() && refined.vertices[v] == sphere.vertices[v]) ++unmoved;
  }
  EXPECT_LT(unmoved, refined.vertices.size() / 50);
  EXPECT_GT(signedVolume(refined), 0.97 * signedVolume(sphere));
}

TEST(MovedAndRenumbered, KeepsShapeAndOrientation) {
  const TriangleSoup torus = sample("torus", 12);
  SampleRandom random(4);
  const TriangleSoup moved = movedAndRenumbered(torus, random);
  const auto a = TriangleMesh::fromSoup(torus), b = TriangleMesh::fromSoup(moved);
  ASSERT_OK(b);
  EXPECT_NE(a->connectivity().faces(), b->connectivity().faces());
  // Area^3 over volume^2, with its sign, has no scale; some thousand terms of rounding 1e-16, and
  // a shift by up to four diagonals.
  const auto ratio = [](const TriangleMesh& mesh, const TriangleSoup& soup) {
    return std::pow(mesh.area(), 1.5) / signedVolume(soup);
  };
  EXPECT_NEAR(ratio(*b, moved) / ratio(*a, torus), 1, 1e-11);
}

TEST(WithNoise, HasTheDeviationAskedFor) {
  const TriangleSoup sphere = sample("sphere", 24);
  SampleRandom random(5);
  const TriangleSoup noisy = withNoise(sphere, 0.01, random);
  double sum = 0, squares = 0;
  for (std::size_t v = 0; v < sphere.vertices.size(); ++v) {
    const Vector3d error = noisy.vertices[v] - sphere.vertices[v];
    sum += error.sum();
    squares += error.squaredNorm();
  }
  const double n = 3 * static_cast<double>(sphere.vertices.size());
  // Five standard errors of a mean and of a deviation.
  EXPECT_NEAR(sum / n, 0, 5 * 0.01 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.01, 5 * 0.01 / std::sqrt(2 * n));
}

// The map's principal stretches lie within 1 +- strain. A straight edge of length e becomes an arc
// of radius at least R / 2, R = 1 / curvature, whose chord is shorter by a share e^2 / (6 R^2).
TEST(Bent, StretchesNoEdgeByMoreThanItsStrain) {
  for (const char* kind : {"capped-cylinder", "torus", "genus"}) {
    const TriangleSoup soup = sample(kind, 16);
    SampleRandom random(6);
    const TriangleSoup result = bent(soup, 2.1, 0.2, random);
    const std::vector<double> factors = stretches(soup, result);
    const auto [low, high] = std::minmax_element(factors.begin(), factors.end());
    EXPECT_LE(*high, 1.2 + 1e-9) << kind;
    EXPECT_GE(*low, 0.8 - 0.01) << kind;
    EXPECT_GT(*high, 1.05) << kind;
    EXPECT_GT(signedVolume(result), 0) << kind;
  }
}

TEST(Articulated, IsNearlyIsometricYetMoves) {
  const TriangleSoup capsule = sample("capped-cylinder", 12);
  SampleRandom random(7);
  const TriangleSoup result = articulated(capsule, random);
  std::vector<double> factors = stretches(capsule, result);
  for (double& factor : factors) factor = std::max(factor, 1 / factor);
  std::sort(factors.begin(), factors.end());
  EXPECT_LE(factors[factors.size() * 49 / 50], 1.5);
  EXPECT_LE(factors[factors.size() / 2], 1.05);
  double farthest = 0;
  for (std::size_t v = 0; v < capsule.vertices.size(); ++v) {
    farthest = std::max(farthest, (result.vertices[v] - capsule.vertices[v]).norm());
  }
  EXPECT_GE(farthest, 0.05 * boundingDiagonal(capsule));
}

// |ab| |cd| / (|ac| |bd|) is what Möbius maps of space keep; a few products of distances that are
// good to 1e-14.
TEST(Inverted, KeepsCrossRatiosAndOrientation) {
  const TriangleSoup torus = sample("torus", 12);
  SampleRandom random(8);
  const TriangleSoup result = inverted(torus, 0.5, random);
  EXPECT_GT(signedVolume(result), 0);
  const auto ratio = [](const TriangleSoup& soup, const std::array<std::size_t, 4>& v) {
    const auto distance = [&](int i, int k) {
      return (soup.vertices[v[i]] - soup.vertices[v[k]]).norm();
    };
    return distance(0, 1) * distance(2, 3) / (distance(0, 2) * distance(1, 3));
  };
  for (std::size_t i = 0; i + 30 < torus.vertices.size(); i += 7) {
    const std::array<std::size_t, 4> v = {i, i + 5, i + 17, i + 30};
    EXPECT_NEAR(ratio(result, v) / ratio(torus, v), 1, 1e-11);
  }
  const auto factors = stretches(torus, result);
  const auto [low, high] = std::minmax_element(factors.begin(), factors.end());
  EXPECT_GT(*high / *low, 3);  // Not a similarity.
}

TEST(Punched, LeavesOneLoopAroundItsShareOfTheArea) {
  const TriangleSoup torus = sample("torus", 24);
  SampleRandom random(9);
  const auto result = punched(torus, 0.03, random);
  ASSERT_OK(result);
  const auto before = TriangleMesh::fromSoup(torus), after = TriangleMesh::fromSoup(*result);
  ASSERT_OK(after);
  EXPECT_EQ(after->connectivity().eulerCharacteristic(), -1);
  const auto areas = before->faceAreas();
  const double lost = before->area() - after->area();
  EXPECT_GE(lost, 0.03 * before->area() * (1 - 1e-12));
  EXPECT_LE(lost, 0.03 * before->area() + *std::max_element(areas.begin(), areas.end()));
}

// Disks so large that they meet themselves around the torus.
TEST(Punched, IsADiskAlsoWhereItWrapsAround) {
  const TriangleSoup torus = sample("torus", 8);
  for (int seed = 1; seed <= 10; ++seed) {
    for (const double share : {0.02, 0.2, 0.5}) {
      SampleRandom random(seed);
      const auto result = punched(torus, share, random);
      ASSERT_OK(result);
      const auto mesh = TriangleMesh::fromSoup(*result);
      ASSERT_OK(mesh);
      EXPECT_EQ(mesh->connectivity().eulerCharacteristic(), -1) << seed << ", " << share;
    }
  }
}

// Eigenvalues of the unit sphere are l (l + 1), 2 l + 1 times, here times the area 4 pi; linear
// elements with edges h are off by a share of about l (l + 1) h^2 / 12, so twice the resolution
// takes the error to a quarter.
TEST(LaplaceSpectrum, OfTheSphereConvergesAtSecondOrder) {
  Context context;
  std::array<double, 2> errors{};
  for (int i = 0; i < 2; ++i) {
    const auto mesh = TriangleMesh::fromSoup(sample("sphere", 10 * (i + 1)));
    ASSERT_OK(mesh);
    const auto spectrum = laplaceSpectrum(context, *mesh, 50);
    ASSERT_OK(spectrum);
    ASSERT_EQ(spectrum->size(), 50U);
    std::size_t k = 0;
    for (int l = 1; k < 48; ++l) {
      for (int m = -l; m <= l && k < 48; ++m, ++k) {
        const double exact = 4 * std::numbers::pi * l * (l + 1);
        errors[i] = std::max(errors[i], std::abs((*spectrum)[k] / exact - 1));
      }
    }
  }
  EXPECT_LT(errors[0], 0.1);
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.8);
}

// Of two random points of the unit sphere, P(distance < d) = d^2 / 4 and the mean is 4/3. The mean
// of 2^19 shares is off by less than five times 0.5 / 2^9.5, and the polyhedron by its h^2.
TEST(D2, OfTheSphereIsThatOfRandomChords) {
  Context context;
  const auto prepared = prepareMesh(context, sample("sphere", 24), {});
  ASSERT_OK(prepared);
  const auto vectors = d2Descriptor().compute(context, *prepared);
  ASSERT_OK(vectors);
  const std::vector<double>& values = (*vectors)[0]->values;
  ASSERT_EQ(values.size(), 64U);
  for (std::size_t i = 0; i < 64; ++i) {
    const double d = 4.0 / 3 * 3 / 64 * static_cast<double>(i + 1);
    EXPECT_NEAR(values[i] * 64 / 3, std::min(1.0, d * d / 4), 0.006);
  }
}

// Labels as a descriptor: perfect but where "other" vectors are of another domain.
TEST(Score, OfTheLabelItselfIsPerfect) {
  std::vector<Variant> variants;
  std::vector<double> distances;
  for (const char* kind : {"original", "rigid", "half"}) {
    for (const char* label : {"a", "b"}) variants.push_back({"", label, kind, {}});
  }
  for (const Variant& a : variants) {
    for (const Variant& b : variants) distances.push_back(a.label == b.label ? 1 : 2);
  }
  Context context;
  const auto scores = scoreDistances(context, "label", variants, distances);
  ASSERT_OK(scores);
  EXPECT_EQ(scores->evaluation.scores.mean_average_precision, 1);
  EXPECT_EQ(scores->by_kind.at("half").nearest_original, 1);
  EXPECT_EQ(scores->by_kind.at("half").queries, 2U);
  EXPECT_EQ(scores->by_kind.at("original").nearest_original, 0);
  EXPECT_EQ(scores->by_kind.at("original").scores.first_tier, 1);
}

TEST(DescriptorDistance, IsInfiniteAcrossDomains) {
  const DescriptorVector a{"x", {0, 3}}, b{"x", {4, 0}}, c{"y", {4, 0}}, d{"x", {1}};
  EXPECT_EQ(descriptorDistance(a, b), 5);
  EXPECT_TRUE(std::isinf(descriptorDistance(a, c)));
  EXPECT_TRUE(std::isinf(descriptorDistance(a, d)));
  EXPECT_TRUE(std::isinf(descriptorDistance(a, {})));
}

}  // namespace
}  // namespace moduli
