#include "core/hyperbolic/dirichlet_domain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace moduli {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kShortestSide = 1e-7;
constexpr double kWorstFit = 1e-6;

std::vector<Complex> cornersApart(const std::vector<Complex>& corners) {
  std::vector<Complex> apart;
  for (const Complex& z : corners) {
    if (apart.empty() || hyperbolicDistance(apart.back(), z) > kShortestSide) apart.push_back(z);
  }
  while (apart.size() > 1 && hyperbolicDistance(apart.back(), apart.front()) <= kShortestSide) {
    apart.pop_back();
  }
  return apart;
}

/// Between the sides to the previous and to the next corner.
double angleAt(Complex corner, Complex previous, Complex next) {
  const Su11 back = inverse(translationTo(corner));
  const double angle = std::arg(imageOf(back, previous) / imageOf(back, next));
  return angle < 0 ? angle + 2 * kPi : angle;
}

/// The pairing on whose bisector both points lie: they are as far from its image of 0 as from 0.
Su11 neighbourAcross(const OrbitPolygon& polygon, Complex p, Complex q) {
  Su11 best;
  double least = std::numeric_limits<double>::infinity();
  for (const GroupElement& g : polygon.pairings) {
    const Complex image = imageOf(g.map, 0.0);
    const double off = std::abs(hyperbolicDistance(p, image) - hyperbolicDistance(p, 0.0)) +
                       std::abs(hyperbolicDistance(q, image) - hyperbolicDistance(q, 0.0));
    if (off >= least) continue;
    least = off;
    best = g.map;
  }
  return best;
}

std::vector<DomainSide> sidesOf(const OrbitPolygon& polygon) {
  const std::vector<Complex> corners = cornersApart(polygon.corners);
  const std::size_t n = corners.size();
  std::vector<DomainSide> sides(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Complex next = corners[(i + 1) % n];
    sides[i].corner = corners[i];
    sides[i].length = hyperbolicDistance(corners[i], next);
    sides[i].angle = angleAt(corners[i], corners[(i + n - 1) % n], next);
    sides[i].neighbour = neighbourAcross(polygon, corners[i], next);
  }
  return sides;
}

/// Finds the partner of side i; returns how far the corners are from where they should be.
double pairSide(std::vector<DomainSide>& sides, std::size_t i) {
  const std::size_t n = sides.size();
  const Su11 back = inverse(sides[i].neighbour);
  const Complex from = imageOf(back, sides[i].corner);
  const Complex to = imageOf(back, sides[(i + 1) % n].corner);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < n; ++j) {
    const double off = std::max(hyperbolicDistance(to, sides[j].corner),
                                hyperbolicDistance(from, sides[(j + 1) % n].corner));
    if (off >= least) continue;
    least = off;
    sides[i].partner = static_cast<int>(j);
  }
  return least;
}

bool isInvolution(const std::vector<DomainSide>& sides) {
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto partner = static_cast<std::size_t>(sides[i].partner);
    if (partner == i || static_cast<std::size_t>(sides[partner].partner) != i) return false;
  }
  return true;
}

/// Numbers the points that the corners make, and returns the largest error of an angle sum. The
/// corner where side i begins is glued to the one where its partner ends.
double numberCycles(DirichletDomain& domain) {
  std::vector<DomainSide>& sides = domain.sides;
  for (DomainSide& side : sides) side.cycle = -1;
  double worst = 0;
  for (std::size_t start = 0; start < sides.size(); ++start) {
    double sum = 0;
    std::size_t i = start;
    while (sides[i].cycle < 0) {
      sides[i].cycle = domain.cycles;
      sum += sides[i].angle;
      i = (static_cast<std::size_t>(sides[i].partner) + 1) % sides.size();
    }
    if (sum == 0) continue;
    ++domain.cycles;
    worst = std::max(worst, std::abs(sum - 2 * kPi));
  }
  return worst;
}

double areaByAngles(const std::vector<DomainSide>& sides) {
  double area = (static_cast<double>(sides.size()) - 2) * kPi;
  for (const DomainSide& side : sides) area -= side.angle;
  return area;
}

Status misfit(const std::string& what, double residual) {
  return {Reason::kResidualTooLarge,
          "the sides of the domain do not glue: " + what + " miss by " + std::to_string(residual)};
}

}  // namespace

Result<DirichletDomain> glueDomain(const OrbitPolygon& polygon) {
  DirichletDomain domain;
  domain.base = polygon.base;
  domain.sides = sidesOf(polygon);
  DomainCertificate& certificate = domain.certificate;
  for (std::size_t i = 0; i < domain.sides.size(); ++i) {
    certificate.side_residual = std::max(certificate.side_residual, pairSide(domain.sides, i));
    domain.radius = std::max(domain.radius, hyperbolicDistance(domain.sides[i].corner, 0.0));
  }
  if (!(certificate.side_residual < kWorstFit)) return misfit("corners", certificate.side_residual);
  if (!isInvolution(domain.sides)) {
    return Status(Reason::kResidualTooLarge, "the sides of the domain do not come in pairs");
  }
  certificate.cycle_residual = numberCycles(domain);
  if (!(certificate.cycle_residual < kWorstFit)) {
    return misfit("angles around a point", certificate.cycle_residual);
  }
  const int characteristic = domain.cycles - static_cast<int>(domain.sides.size()) / 2 + 1;
  if (characteristic != 2 - 2 * polygon.genus) {
    return Status(Reason::kResidualTooLarge, "the domain is glued to a surface of characteristic " +
                                                 std::to_string(characteristic));
  }
  certificate.area_error = std::abs(areaByAngles(domain.sides) + 2 * kPi * characteristic);
  return domain;
}

Result<DirichletDomain> dirichletDomain(Context& context, const std::vector<Su11>& generators,
                                        int genus) {
  ASSIGN_OR_RETURN(const OrbitPolygon polygon, orbitPolygon(context, generators, genus));
  return glueDomain(polygon);
}

}  // namespace moduli
