#pragma once

#include <functional>
#include <vector>

#include "core/base/context.h"
#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/parameterize/flat.h"

/// Surfaces of several components, each flattened on its own, in one layout.
namespace moduli {

/// One component of a surface, with the numbers that its elements have there.
struct SurfaceComponent {
  Connectivity surface;
  std::vector<double> lengths;  ///< Per edge.
  std::vector<Index> vertices;  ///< Per vertex that of the whole; ascending, like the next two.
  std::vector<Index> faces;     ///< Corners keep their places.
  std::vector<Index> edges;
};

/// The components, by their lowest faces. lengths: per edge. O(V + F).
Result<std::vector<SurfaceComponent>> componentsOf(const Connectivity& surface,
                                                   const std::vector<double>& lengths);

/// How a component is flattened. options: those of the whole, with the cones and seams that are in
/// the component, by its numbers.
using FlattenComponent = std::function<Result<Parameterization>(
    Context& context, const SurfaceComponent& component, const FlatOptions& options)>;

/// Flattens every component and packs all islands side by side (packIslands), each component at the
/// scale of its own area. A connected surface is flattened as it is. The certificate is that of the
/// whole: its worst residuals, the quality of all faces. Fails with kInvalidOption (a cone
/// beside the surface), and as `flatten` does: a message begins with the component, counted from 0.
Result<Parameterization> flattenComponents(Context& context, const Connectivity& surface,
                                           const std::vector<double>& lengths,
                                           const FlatOptions& options,
                                           const FlattenComponent& flatten);

}  // namespace moduli
