#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"

/// Invariants of the lattice (Z^n, E) that do not depend on its basis: of an energy form, they are
/// invariants of the conformal structure without its marking, and continuous in it.
///
///   ASSIGN_OR_RETURN(const auto spectrum, shortestEnergies(context, energy, 16));
///   ASSIGN_OR_RETURN(const auto features, thetaFeatures(context, energy, {2, 3, 4}));
///
/// All of them enumerate lattice vectors after LLL. The number of nodes that are visited grows
/// exponentially with n, so it is limited; a node takes some 10 ns.
namespace moduli {

/// A second or two.
inline constexpr std::int64_t kLatticeNodes = 100'000'000;

/// The `count` smallest energies v^T E v of primitive vectors v of Z^n, ascending.
/// energy: n x n, n >= 1, symmetric positive definite. Primitive: gcd(v) = 1. v and -v count once,
/// other vectors each, so that values repeat. For n = 1 there is one value only. Relative error
/// about 1e-14 times what cancels in v^T E v on the reduced basis; of values that differ by less
/// than 1e-14, any may stand for the others.
/// Fails as reduceLattice does, with kNoConvergence when `node_limit` nodes were not enough, and as
/// context.check(). Source: Fincke, Pohst 1985; Schnorr, Euchner 1994; MATH 4.9.
Result<std::vector<double>> shortestEnergies(Context& context, const Eigen::MatrixXd& energy,
                                             std::size_t count,
                                             std::int64_t node_limit = kLatticeNodes);

/// Theta(t) = sum over v in Z^n of exp(-pi t v^T E v) for each t.
/// energy: as above; t: finite, > 0. Where E is symplectic, n = 2 g, Theta(1/t) = t^g Theta(t).
/// What the sum leaves out is at most 1e-15 of Theta(t) - 1; rounding is about 1e-16 Theta(t) and
/// pi t v^T E v 1e-15 of each term. One enumeration for all t, of the vectors below a radius that
/// falls as the smallest t grows. At t = 1 and for E of determinant 1 there are some 2e5 of them
/// for n = 8, 3e7 for n = 12 and 1e13 for n = 24, by t^(n/2) fewer at t. Fails as shortestEnergies
/// does, and with kInvalidOption where a t is not a number > 0. Source: Banaszczyk 1993 (what is
/// left out); MATH 8.5.
Result<std::vector<double>> thetaSums(Context& context, const Eigen::MatrixXd& energy,
                                      const std::vector<double>& t,
                                      std::int64_t node_limit = kLatticeNodes);

/// -log(Theta(t) - 1) / (pi t) for each t: a smooth minimum of the energies, which tends to the
/// smallest one as t grows. As thetaSums, but never loses digits where Theta(t) is near 1.
Result<std::vector<double>> thetaFeatures(Context& context, const Eigen::MatrixXd& energy,
                                          const std::vector<double>& t,
                                          std::int64_t node_limit = kLatticeNodes);

/// The same of the classes on the lines through the primitive ones whose energies are given:
/// Theta(t) - 1 = 2 sum over energies E and k >= 1 of exp(-pi t k^2 E). energies, t: > 0, finite;
/// energies ascending, one at least.
///
/// With all primitive energies up to some radius this is thetaFeatures up to what lies beyond; with
/// the n smallest ones it is continuous in the form whatever n is, for so is the i-th smallest
/// energy for every i, while a cut at a radius would jump where energies pass it. No more than some
/// ten terms an energy, however small it is. Relative error of the sum 1e-15.
std::vector<double> spectrumThetaFeatures(const std::vector<double>& energies,
                                          const std::vector<double>& t);

}  // namespace moduli
