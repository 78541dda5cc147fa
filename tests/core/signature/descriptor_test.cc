#include "core/signature/descriptor.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/mesh/prepare.h"
#include "tests/core/signature/modes.h"
#include "tests/core/spherical/surfaces.h"

namespace moduli {
namespace {

using surfaces::mesh;
using surfaces::sample;

struct Vectors {
  std::vector<double> metric, shape;
};

Vectors vectorsOf(const TriangleMesh& surface) {
  Context context;
  const std::vector<double> lengths = surfaces::properLengths(surface);
  const SurfaceModes modes = surfaces::modesOf(surface);
  const auto parts = shapeParts(context, surface, lengths, modes);
  EXPECT_OK(parts);
  return {weighParts(metricParts(modes)), weighParts(*parts)};
}

Vectors vectorsOf(const TriangleSoup& soup) {
  return vectorsOf(mesh(soup));
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// Renumbered, turned, moved and scaled: nothing changes beyond the eigen-solver's tolerance.
void expectInvariant(const TriangleSoup& soup, const std::string& name) {
  const Vectors one = vectorsOf(soup);
  const Vectors two = vectorsOf(surfaces::moved(surfaces::renumbered(soup, 3), 37));
  EXPECT_LT(largestDifference(one.metric, two.metric), 1e-7) << name;
  EXPECT_LT(largestDifference(one.shape, two.shape), 1e-7) << name;
}

TEST(Descriptor, IsOfOneLengthForEveryTopology) {
  for (const TriangleSoup& soup :
       {sample("sphere", {{"resolution", 2}}), sample("torus", {{"resolution", 8}}),
        sample("genus", {{"genus", 3}, {"resolution", 2}}), sample("disk", {{"resolution", 8}}),
        sample("annulus", {{"resolution", 6}})}) {
    const Vectors vectors = vectorsOf(soup);
    EXPECT_EQ(vectors.metric.size(), std::size_t{kMetricLength});
    EXPECT_EQ(vectors.shape.size(), std::size_t{kShapeLength});
    for (const double number : vectors.shape) EXPECT_TRUE(std::isfinite(number));
    for (const double number : vectors.metric) EXPECT_TRUE(std::isfinite(number));
  }
}

TEST(Descriptor, HasAScaleForEveryPart) {
  std::set<std::string_view> names;
  for (const PartScale& part : kPartScales) {
    EXPECT_GT(part.scale, 0);
    names.insert(part.name);
  }
  EXPECT_EQ(names.size(), std::size_t{kPartCount});
}

TEST(Descriptor, DoesNotDependOnOrderPlaceOrScale) {
  // The last three have symmetries, and so multiplets, one of which the list of modes cuts through.
  expectInvariant(sample("ellipsoid", {{"b", 0.7}, {"c", 0.4}, {"resolution", 12}, {"seed", 2}}),
                  "ellipsoid");
  expectInvariant(sample("genus", {{"genus", 2}, {"resolution", 4}}), "genus 2");
  expectInvariant(sample("sphere", {{"resolution", 8}}), "sphere");
  expectInvariant(sample("torus", {{"R", 2}, {"resolution", 16}}), "torus");
}

TEST(Descriptor, DoesNotDependOnHandedness) {
  const TriangleSoup soup = sample("torus", {{"R", 2}, {"resolution", 16}, {"seed", 3}});
  TriangleSoup mirrored = surfaces::reversed(soup);
  for (Eigen::Vector3d& p : mirrored.vertices) p.x() = -p.x();
  const Vectors one = vectorsOf(soup), two = vectorsOf(mirrored);
  EXPECT_LT(largestDifference(one.shape, two.shape), 1e-7);
}

TEST(Descriptor, OfASmallHoleIsNearThatOfNone) {
  // One face in 1280 missing, against a capsule of another length.
  TriangleSoup soup = sample("capped-cylinder", {{"half_length", 2}, {"resolution", 12}});
  const Vectors whole = vectorsOf(soup);
  const Vectors other =
      vectorsOf(sample("capped-cylinder", {{"half_length", 3}, {"resolution", 12}}));
  soup.faces.erase(soup.faces.begin() + static_cast<int>(soup.faces.size() / 2));
  const Vectors holed = vectorsOf(soup);
  EXPECT_LT(distance(whole.metric, holed.metric), 0.1 * distance(whole.metric, other.metric));
  EXPECT_LT(distance(whole.shape, holed.shape), 0.1 * distance(whole.shape, other.shape));
}

TEST(Descriptor, OfRealSurfacesIsInvariantAndKeepsNoise) {
  std::vector<Vectors> all;
  for (const char* name :
       {"closed_g0/alec__spot.obj", "genus1/ceaedf__rocker-arm2500.off", "genus2/cfwen__eight.off",
        "multi_boundary/gpeyre__pipes.off", "disk/gpeyre__venus.off"}) {
    MODULI_NEED_SHARED_MESH(path, name);
    Context context;
    PrepareOptions options;
    options.component = "largest";
    const auto prepared = prepareMesh(context, surfaces::read(path), options);
    ASSERT_OK(prepared);
    TriangleSoup soup{prepared->mesh.positions(), prepared->mesh.connectivity().faces()};
    expectInvariant(soup, name);
    const Vectors exact = vectorsOf(soup);
    for (const Vectors& other : all) EXPECT_GT(distance(exact.shape, other.shape), 1) << name;
    all.push_back(exact);
    // Gaussian errors of 0.5 % of the bounding box's diagonal.
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : soup.vertices) box.extend(p);
    std::mt19937 random(1);
    std::normal_distribution<double> error(0, 0.005 * box.diagonal().norm() / std::sqrt(3.0));
    for (Eigen::Vector3d& p : soup.vertices) {
      p += Eigen::Vector3d(error(random), error(random), error(random));
    }
    const Vectors noisy = vectorsOf(soup);
    EXPECT_LT(distance(exact.shape, noisy.shape), 0.5) << name;
    EXPECT_LT(distance(exact.metric, noisy.metric), 0.5) << name;
  }
}

TEST(Descriptor, StopsWhenCancelled) {
  const TriangleMesh surface = mesh(sample("sphere", {{"resolution", 8}}));
  const SurfaceModes modes = surfaces::modesOf(surface);
  Context context;
  CancelToken token;
  token.cancel();
  context.setCancelToken(token);
  EXPECT_THAT(shapeParts(context, surface, surfaces::properLengths(surface), modes),
              FailsWith(Reason::kCancelled));
}

TEST(FamilyDistances, AddUpToTheDistanceAndNameWhatDiffers) {
  const TriangleSoup egg = sample("spheroid", {{"resolution", 6}, {"c", 1.7}});
  const TriangleSoup ring = sample("torus", {{"resolution", 10}});
  const Vectors a = vectorsOf(egg), b = vectorsOf(ring);
  const auto expectSum = [](const std::vector<double>& x, const std::vector<double>& y,
                            std::size_t families) {
    const std::vector<float> p(x.begin(), x.end()), q(y.begin(), y.end());
    const std::vector<FamilyDistance> parts = familyDistances(p, q);
    ASSERT_EQ(parts.size(), families);
    double sum = 0;
    for (const FamilyDistance& part : parts) sum += part.distance * part.distance;
    EXPECT_NEAR(std::sqrt(sum), distance(x, y), 1e-5 * distance(x, y));
  };
  expectSum(a.metric, b.metric, 3);
  expectSum(a.shape, b.shape, 6);
  // The families are those of the parts: a change of one part shows in its family alone.
  Context context;
  const SurfaceModes modes = surfaces::modesOf(mesh(egg));
  const auto parts = shapeParts(context, mesh(egg), surfaces::properLengths(mesh(egg)), modes);
  ASSERT_OK(parts);
  for (std::size_t i = 0; i < parts->size(); ++i) {
    std::vector<DescriptorPart> changed = *parts;
    for (double& value : changed[i].values) value += 1;
    const std::vector<double> x = weighParts(*parts), y = weighParts(changed);
    const std::string_view family = (*parts)[i].name.substr(0, (*parts)[i].name.find('-'));
    for (const FamilyDistance& part : familyDistances(std::vector<float>(x.begin(), x.end()),
                                                      std::vector<float>(y.begin(), y.end()))) {
      EXPECT_EQ(part.distance > 1e-3, part.name == family) << part.name << " " << family;
    }
  }
  EXPECT_TRUE(familyDistances({}, {}).empty());
}

}  // namespace
}  // namespace moduli
