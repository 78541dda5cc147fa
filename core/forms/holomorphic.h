#pragma once

#include <complex>
#include <vector>

#include "core/forms/form_basis.h"
#include "core/forms/period_matrix.h"

/// Holomorphic 1-forms of closed surfaces as complex cochains.
namespace moduli {

using HolomorphicForms = ClosedForms<std::complex<double>>;

/// zeta_1 .. zeta_g of a surface: zeta_k = h_alpha_k + sum over j of Pi_kj h_beta_j. In the marking
/// of Pi the periods of zeta_k are delta_jk and Pi_jk. Closed to rounding; holomorphic up to the
/// error of the periods. O(V g^2). Source: MATH 4.5.
HolomorphicForms holomorphicForms(const ClosedPeriods& closed);

/// A vertex where a closed form vanishes.
struct FormZero {
  Index vertex = kNone;
  int index = 0;  ///< -m for a zero of order m of a holomorphic form; 1 at a local extremum.
};

/// Zeros of a real closed form given per edge along its direction, by the sign changes of its
/// values around each vertex: index 1 - changes / 2. On a closed surface the indices add up to its
/// Euler characteristic, exactly, for every closed form. For the real part of a holomorphic form
/// they are its zeros, each at a vertex of the face that holds it, up to pairs of indices 1 and -1
/// where obtuse triangles make extrema. An edge with the value 0 counts as one towards its higher
/// vertex. values: per edge, closed. Ascending by vertex. O(E). Source: Banchoff 1967; MATH 10.
std::vector<FormZero> zerosOfForm(const Connectivity& surface, const std::vector<double>& values);

/// The real part of sum of c_k zeta_k on every edge. c: one coefficient a form. O(E g).
std::vector<double> realPart(const Connectivity& surface, const HolomorphicForms& forms,
                             const std::vector<std::complex<double>>& c);

/// Hodge star of closed forms, face by face: on each face the covector of form a is turned by a
/// quarter, and the field so made, which is not closed, is projected orthogonally to the span of
/// the forms. Returns S with *h_a = sum over k of S(a, k) h_k. A second way to the conformal
/// structure: S J^-1 tends to the energy form from below as energyForm does from above.
/// forms: harmonic, in a symplectic basis. O(F k^2). Source: Gu and Yau 2003; MATH 0.10, 4.2.
Eigen::MatrixXd starByFaces(const Connectivity& surface, const std::vector<double>& lengths,
                            const FormBasis& forms);

}  // namespace moduli
