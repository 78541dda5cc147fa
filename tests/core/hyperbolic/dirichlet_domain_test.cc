#include "core/hyperbolic/dirichlet_domain.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/hyperbolic/fuchsian_group.h"
#include "tests/core/hyperbolic/groups.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;

void expectDomain(const DirichletDomain& domain, int genus) {
  EXPECT_LE(domain.certificate.area_error, 1e-9);
  EXPECT_LE(domain.certificate.side_residual, 1e-9);
  EXPECT_LE(domain.certificate.cycle_residual, 1e-9);
  // Of a polygon with n sides and c points: c - n / 2 + 1 = 2 - 2 g, three corners or more a point.
  const int n = static_cast<int>(domain.sides.size());
  EXPECT_EQ(domain.cycles - n / 2 + 1, 2 - 2 * genus);
  EXPECT_GE(n, 4 * genus);
  EXPECT_LE(n, 12 * genus - 6);
  double area = (n - 2) * kPi;
  for (const DomainSide& side : domain.sides) {
    area -= side.angle;
    const DomainSide& partner = domain.sides[side.partner];
    EXPECT_NEAR(side.length, partner.length, 1e-9);
    EXPECT_LE(distanceUpToSign(side.neighbour * partner.neighbour, Su11{}), 1e-8);
    EXPECT_LE(hyperbolicDistance(side.corner, 0.0), domain.radius + 1e-12);
  }
  EXPECT_NEAR(area, 4 * kPi * (genus - 1), 1e-9);
}

class RegularPolygon : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Genera, RegularPolygon, testing::Values(2, 3, 5));

TEST_P(RegularPolygon, GroupHasADomainNoLargerThanThePolygon) {
  const int genus = GetParam();
  Context context;
  const auto domain = dirichletDomain(context, polygonGroup(genus), genus);
  ASSERT_OK(domain);
  expectDomain(*domain, genus);
  EXPECT_LE(domain->radius, polygonRadius(genus) + 1e-9);
}

TEST_P(RegularPolygon, GluesToOnePointAboutItsMiddle) {
  // The polygon itself, with its neighbours across the sides, as if it had been found about 0.
  const int genus = GetParam();
  const int n = 4 * genus;
  OrbitPolygon polygon;
  polygon.genus = genus;
  for (const Su11& g : polygonGroup(genus)) {
    polygon.pairings.push_back({g, {}});
    polygon.pairings.push_back({inverse(g), {}});
  }
  for (int k = 0; k < n; ++k) {
    polygon.corners.push_back(std::polar(std::tanh(polygonRadius(genus) / 2), 2 * kPi * k / n));
  }
  const auto domain = glueDomain(polygon);
  ASSERT_OK(domain);
  expectDomain(*domain, genus);
  EXPECT_EQ(domain->cycles, 1);
  EXPECT_NEAR(domain->radius, polygonRadius(genus), 1e-12);
  for (std::size_t k = 0; k < domain->sides.size(); ++k) {
    EXPECT_EQ(domain->sides[k].partner, static_cast<int>(k % 4 < 2 ? k + 2 : k - 2));
    EXPECT_NEAR(domain->sides[k].angle, 2 * kPi / n, 1e-12);
  }
  // A pairing that is off by more than is promised.
  polygon.pairings[0].map = polygon.pairings[0].map * translation(1e-5);
  EXPECT_THAT(glueDomain(polygon), FailsWith(Reason::kResidualTooLarge));
}

TEST(DirichletDomain, IsThatOfTheSurfaceForSymmetricOnes) {
  const struct {
    const char* kind;
    int genus;
  } samples[] = {{"bolza", 2}, {"klein", 3}};
  for (const auto& sample : samples) {
    SCOPED_TRACE(sample.kind);
    Context context;
    const auto group = computeFuchsianGroup(context, regularSample(sample.kind));
    ASSERT_OK(group);
    const auto domain = dirichletDomain(context, group->generators, sample.genus);
    ASSERT_OK(domain);
    expectDomain(*domain, sample.genus);
  }
}

TEST(DirichletDomain, RefusesAnotherGenus) {
  Context context;
  EXPECT_FALSE(dirichletDomain(context, polygonGroup(2), 3).ok());
  EXPECT_FALSE(dirichletDomain(context, polygonGroup(3), 2).ok());
}

}  // namespace
}  // namespace moduli
