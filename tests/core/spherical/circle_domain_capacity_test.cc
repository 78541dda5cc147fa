#include "core/spherical/circle_domain_capacity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/forms/bordered_period.h"
#include "core/spherical/koebe.h"
#include "core/topology/surface_topology.h"
#include "tests/core/spherical/plane_domains.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Complex = std::complex<double>;
using Loops = std::vector<std::vector<Index>>;
constexpr double kPi = std::numbers::pi;

const std::vector<Circle> kThreeHoles = {{0, 1}, {0, 0.25}, {0.6, 0.12}, {{-0.2, 0.65}, 0.08}};

Result<CircleDomainCapacity> capacityOf(const std::vector<Circle>& circles) {
  Context context;
  return circleDomainCapacity(context, circles);
}

double largest(const Eigen::MatrixXd& matrix) {
  return matrix.cwiseAbs().maxCoeff();
}

TEST(CircleDomainCapacity, OfAnnuliIsTheReciprocalLogarithm) {
  for (const double radius : {1e-6, 0.1, 0.5, 0.9}) {
    const auto result = capacityOf({{{3, 4}, 2}, {{3, 4}, 2 * radius}});
    ASSERT_OK(result);
    EXPECT_NEAR(result->capacity(0, 0) * std::log(1 / radius) / (2 * kPi), 1, 1e-12);
  }
  for (const Circle& hole : {Circle{0.5, 0.2}, Circle{{0, -0.7}, 0.29}, Circle{{0.3, 0.3}, 1e-4}}) {
    const auto result = capacityOf({{0, 1}, hole});
    ASSERT_OK(result);
    EXPECT_NEAR(result->capacity(0, 0) * std::log(1 / centeredRadius(hole)) / (2 * kPi), 1, 1e-11);
    EXPECT_LT(result->residual, 1e-11);
  }
}

TEST(CircleDomainCapacity, DoesNotDependOnMoebiusMaps) {
  const auto one = capacityOf(kThreeHoles);
  ASSERT_OK(one);
  EXPECT_LT(one->asymmetry, 1e-11 * largest(one->capacity));
  for (const Complex zero : {Complex(0.3, 0.1), Complex(-0.6, 0.5)}) {
    const DiskTranslation map{zero};
    std::vector<Circle> circles = {{0, 1}};
    for (std::size_t k = 1; k < 4; ++k) circles.push_back(map(kThreeHoles[k]));
    const auto other = capacityOf(circles);
    ASSERT_OK(other);
    EXPECT_LT(largest(other->capacity - one->capacity), 1e-10 * largest(one->capacity));
  }
  // An inversion that exchanges the outer circle with the first hole: the full matrix has zero row
  // sums, and its rows and columns change places.
  std::vector<Circle> turned = {{0, 4}};
  turned.push_back({0, 1});
  for (const std::size_t k : {2, 3}) {
    const Circle& hole = kThreeHoles[k];
    const double power = std::norm(hole.center) - hole.radius * hole.radius;
    turned.push_back({hole.center / power, hole.radius / power});
  }
  const auto other = capacityOf(turned);
  ASSERT_OK(other);
  const Eigen::MatrixXd sums = -one->capacity.rowwise().sum();
  EXPECT_NEAR(other->capacity(0, 0), -sums.sum(), 1e-10 * largest(one->capacity));
  EXPECT_NEAR(other->capacity(0, 1), sums(1), 1e-10 * largest(one->capacity));
  EXPECT_NEAR(other->capacity(1, 2), one->capacity(1, 2), 1e-10 * largest(one->capacity));
}

TEST(CircleDomainCapacity, ServesManyAndCloseCircles) {
  std::vector<Circle> circles = {{0, 1}};
  for (int k = 0; k < 26; ++k) {
    circles.push_back({std::polar(0.17 * std::sqrt(k + 0.5), 2.4 * k), 0.06});
  }
  const auto many = capacityOf(circles);
  ASSERT_OK(many);
  EXPECT_LT(many->residual, 1e-10);
  EXPECT_LT(many->asymmetry, 1e-9);
  // Gaps of 1 / 100 between the circles and to the outer one.
  const auto close = capacityOf({{0, 1}, {0.49, 0.49}, {-0.5, 0.49}});
  ASSERT_OK(close);
  EXPECT_LT(close->asymmetry, 1e-8 * largest(close->capacity));
  EXPECT_THAT(capacityOf({{0, 1}, {0.5, 0.5 - 1e-9}}), FailsWith(Reason::kUnsupportedContent));
}

TEST(CircleDomainCapacity, RefusesCirclesThatMeet) {
  EXPECT_THAT(capacityOf({}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(capacityOf({{0, 1}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(capacityOf({{0, 1}, {0.5, 0.6}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(capacityOf({{0, 1}, {0.2, 0.2}, {-0.1, 0.2}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(capacityOf({{0, 1}, {0, -0.2}}), FailsWith(Reason::kInvalidOption));
  EXPECT_THAT(capacityOf({{0, 1}, {std::nan(""), 0.2}}), FailsWith(Reason::kInvalidOption));
}

/// The reduced flux matrix of a surface by linear finite elements, for loops in a given order of
/// which the first one is left out.
Eigen::MatrixXd meshCapacity(const Connectivity& surface, const std::vector<double>& lengths,
                             const Loops& loops) {
  Context context;
  const auto periods = computeBorderedPeriods(context, surface, lengths);
  EXPECT_OK(periods);
  const auto given = computeTopology(surface).boundary_loops;
  const auto count = static_cast<Eigen::Index>(given.size());
  // The full matrix: its rows sum to zero.
  Eigen::MatrixXd full(count, count);
  full.bottomRightCorner(count - 1, count - 1) = periods->capacity;
  full.bottomLeftCorner(count - 1, 1) = -periods->capacity.rowwise().sum();
  full.topRightCorner(1, count - 1) = -periods->capacity.colwise().sum();
  full(0, 0) = periods->capacity.sum();
  std::vector<Eigen::Index> place(loops.size(), -1);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    for (std::size_t j = 0; j < given.size(); ++j) {
      for (const Index h : given[j]) {
        if (surface.tail(h) == loops[k][0]) place[k] = static_cast<Eigen::Index>(j);
      }
    }
  }
  Eigen::MatrixXd reduced(count - 1, count - 1);
  for (Eigen::Index a = 1; a < count; ++a) {
    for (Eigen::Index b = 1; b < count; ++b) reduced(a - 1, b - 1) = full(place[a], place[b]);
  }
  return reduced;
}

// Linear elements on polygons inscribed in the circles: of second order both, and of opposite signs
// around holes, so that together they may fall faster.
TEST(CircleDomainCapacity, IsTheLimitOfFiniteElements) {
  const auto exact = capacityOf(kThreeHoles);
  ASSERT_OK(exact);
  std::vector<double> errors;
  for (const double h : {0.04, 0.02}) {
    const PlaneDomain domain = triangulateDomain(kThreeHoles, h);
    const auto surface =
        Connectivity::fromFaces(static_cast<Index>(domain.points.size()), domain.faces);
    ASSERT_OK(surface);
    const Eigen::MatrixXd mesh =
        meshCapacity(*surface, planeLengths(*surface, domain.points), domain.loops);
    errors.push_back(largest(mesh - exact->capacity) / largest(exact->capacity));
  }
  EXPECT_LT(errors.back(), 1e-3);
  RecordProperty("error", std::to_string(errors.back()));
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.75);
}

// A surface in space: the conformal image of the disk with three holes, lifted to a sphere. Its
// fluxes by finite elements are those of the circles that Koebe's iteration finds.
TEST(CircleDomainCapacity, OfASurfaceIsThatOfItsCircleDomain) {
  std::vector<double> errors;
  for (const double h : {0.04, 0.02}) {
    const PlaneDomain domain = triangulateDomain(kThreeHoles, h);
    const auto surface =
        Connectivity::fromFaces(static_cast<Index>(domain.points.size()), domain.faces);
    ASSERT_OK(surface);
    std::vector<Complex> plane;
    std::vector<Eigen::Vector3d> sphere;
    for (const Complex z : domain.points) {
      Complex w = z + 0.1 * z * z;
      for (std::size_t k = 1; k < 4; ++k) {
        const Circle& hole = kThreeHoles[k];
        w += 0.3 * hole.radius * hole.radius / (z - hole.center);
      }
      plane.push_back(w);
      sphere.push_back(Eigen::Vector3d(2 * w.real(), 2 * w.imag(), std::norm(w) - 1) /
                       (1 + std::norm(w)));
    }
    std::vector<double> lengths(surface->edgeCount());
    for (Index e = 0; e < surface->edgeCount(); ++e) {
      const Index side = surface->halfedge(e);
      lengths[e] = (sphere[surface->head(side)] - sphere[surface->tail(side)]).norm();
    }
    Context context;
    const auto circles = koebe(context, plane, domain.loops);
    ASSERT_OK(circles);
    const auto found = circleDomainCapacity(context, circles->circles);
    ASSERT_OK(found);
    errors.push_back(largest(meshCapacity(*surface, lengths, domain.loops) - found->capacity) /
                     largest(found->capacity));
  }
  EXPECT_LT(errors.back(), 1e-3);
  RecordProperty("error", std::to_string(errors.back()));
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.75);
}

}  // namespace
}  // namespace moduli
