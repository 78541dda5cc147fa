#pragma once

#include <optional>

#include "core/base/context.h"
#include "core/intrinsic/intrinsic_surface.h"
#include "core/mesh/prepare.h"
#include "core/signature/signature.h"

namespace moduli {

struct SignatureOptions {
  std::optional<Space> space;  ///< Only this space and the work that it needs; empty: all three.
  /// Whether the hyperbolic metric and the map to a circle domain start from the intrinsic Delaunay
  /// triangulation of a mesh, or from its own edges, whose discrete conformal class no Möbius map
  /// of space changes. Intrinsic triangulations that are not Euclidean start from their own edges
  /// in any case.
  bool initial_delaunay = true;
  /// Closed geodesics up to this length, > 0, as far as some million elements of the group tell;
  /// empty: up to a length that takes little time.
  std::optional<double> spectrum_length = {};
};

/// Signature of a connected oriented manifold surface. The conformal block is there for every
/// topology (of genus up to kMaxPeriodGenus), and so are the vectors of the metric and the shape
/// space (descriptor.h), which need no map; the spectra of the conformal factor and of the mean
/// curvature beside them compare the surface with the canonical one, unit sphere or flat torus,
/// both scaled to area 4 pi. The metric is the polyhedral one, mollified where faces have no area.
/// Where the metric or shape space fails, a warning SPACES_OMITTED says why and the rest stands.
///
/// Circle domains get their circles; where the map to them fails, a warning CIRCLES_OMITTED says
/// why and they are missing. Where the Euler characteristic is negative the certificate judges the
/// hyperbolic metric of the surface (of its double), whose group and shortest closed geodesics are
/// there; where they are not, a warning GEODESICS_OMITTED says why.
///
/// Orientation counts: turned inside out, a surface keeps its conformal factor and the power of its
/// mean curvature, the cross spectrum changes sign, tau becomes -conj(tau), a period matrix -conj
/// of it up to its marking, circles are mirrored in the real axis, and energy spectra stay. The
/// same holds for a mirror image with the normals kept outwards, but for the cross spectrum, which
/// then stays.
///
/// Fails with kUnsupportedTopology (several components), kResidualTooLarge (a sphere map that is
/// not centred to 1e-9, a holomorphic form of a torus that does not close to 1e-8 of a mean edge or
/// whose area check fails by more than one half), and as the solvers do. Same input, same bytes;
/// one space has the same bytes alone as among all three. About 7 F for spheres, 8 F with a
/// hyperbolic metric, 4 F for tori, and 12 F for the modes and the descriptor. Source: MATH 3 to
/// 5, 8.
Result<Signature> computeSignature(Context& context, const PreparedMesh& prepared,
                                   const SignatureOptions& options = {});

/// Signature of a surface without positions: topology (with the area of its own geometry) and
/// conformal block. Its metric and shape spaces are left out, and a warning says so. Periods are
/// those of the polyhedral surface of chords (chordLengths): of the surface itself where it is
/// Euclidean; elsewhere the warning CHORDAL_METRIC says so, and they tend to the surface's own as
/// the triangulation is refined.
///
/// Fails with kUnsupportedContent (the metric or shape space alone), as chordLengths and, but for
/// the sphere map, as computeSignature. Costs as that, less the fields.
Result<Signature> computeIntrinsicSignature(Context& context, const IntrinsicSurface& surface,
                                            const SignatureOptions& options = {});

}  // namespace moduli
