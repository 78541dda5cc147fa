#pragma once

#include <vector>

#include "core/mesh/connectivity.h"
#include "core/topology/cochain.h"

/// Bases of the integer cohomology of a surface, adapted to its intersection form.
namespace moduli {

/// A basis alpha_1 .. alpha_g, beta_1 .. beta_g of H^1(M; Z) of a closed connected surface with
/// int alpha_i ^ beta_k = delta_ik and int alpha_i ^ alpha_k = int beta_i ^ beta_k = 0. Empty for
/// genus 0. Fails with kUnsupportedTopology (boundary, several components), kOverflow.
/// O(V + F + g n) for loops of n edges in all. Source: MATH 1.
Result<std::vector<Cochain>> symplecticCohomology(const Connectivity& surface);

/// The cohomology of a connected surface of genus g with b > 0 boundary loops.
struct BorderedCohomology {
  /// alpha_1 .. alpha_g, beta_1 .. beta_g: they vanish on the boundary's edges and meet each other
  /// as on a closed surface. With the differentials of the functions u_k that are 1 on loop k and 0
  /// on the other ones, k = 1 .. b - 1, they are a basis of H^1(M, dM; Z).
  std::vector<Cochain> handles;
  /// gamma_1 .. gamma_{b-1}: their period is 1 around loop k and -1 around loop 0, each in the
  /// direction of its halfedges, and they meet no alpha or beta: with these they are a basis of
  /// H^1(M; Z), and int gamma_i ^ du_k = -delta_ik.
  std::vector<Cochain> loops;
};

/// boundary_loops: those of computeTopology. Fails and costs as symplecticCohomology. Source: MATH
/// 1, 5.3.
Result<BorderedCohomology> borderedCohomology(
    const Connectivity& surface, const std::vector<std::vector<Index>>& boundary_loops);

}  // namespace moduli
