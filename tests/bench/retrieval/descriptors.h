#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/prepare.h"

/// What a mesh is turned into before meshes are compared.
namespace moduli {

/// Vectors are compared where their domains (such as a topology) and sizes are the same; elsewhere
/// the distance is infinite.
struct DescriptorVector {
  std::string domain;
  std::vector<double> values;
};

/// One computation that gives one or several vectors; nothing where one is not defined.
struct Descriptor {
  std::vector<std::string> names;  ///< One a vector.
  std::function<Result<std::vector<std::optional<DescriptorVector>>>(Context&, const PreparedMesh&)>
      compute;
};

/// Euclidean, or infinite.
double descriptorDistance(const std::optional<DescriptorVector>& a,
                          const std::optional<DescriptorVector>& b);

/// The three vectors of a signature: "conformal" (within one topology), "metric", "shape".
Descriptor moduliDescriptor();

/// For comparison, "D2": histogram of the distances of 2^19 pairs of random points of the surface,
/// over their mean, in 64 bins up to three times the mean; as cumulative shares times the width of
/// a bin. Source: Osada, Funkhouser, Chazelle, Dobkin, Shape distributions (2002).
Descriptor d2Descriptor();

/// For comparison, "LB": the first 50 eigenvalues above 0 of the Laplace-Beltrami operator (linear
/// elements, lumped masses, free boundary) times the area. Source: Reuter, Wolter, Peinecke,
/// Laplace-Beltrami spectra as shape-DNA of surfaces and solids (2006).
Descriptor laplaceDescriptor();

/// The first `count` eigenvalues above 0, ascending, times the area. Fails as the solver does, and
/// with kNoConvergence.
Result<std::vector<double>> laplaceSpectrum(Context& context, const TriangleMesh& mesh, int count);

}  // namespace moduli
