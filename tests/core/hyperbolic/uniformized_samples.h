#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/ricci/uniformize.h"
#include "tests/core/forms/surfaces.h"
#include "tests/core/testing.h"

/// Surfaces in space and their hyperbolic metrics.
namespace moduli {

inline Result<MetricSurface> metricOf(const TriangleSoup& soup) {
  Context context;
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, {}));
  const Connectivity& surface = prepared.mesh.connectivity();
  ASSIGN_OR_RETURN(MollifiedLengths mollified, mollify(surface, prepared.mesh.edgeLengths()));
  return MetricSurface{surface, std::move(mollified.lengths)};
}

inline Result<MetricSurface> metricOfFile(const std::string& path) {
  Context context;
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  return metricOf(soup);
}

inline MetricSurface metricOfSample(const std::string& kind,
                                    const std::map<std::string, double>& parameters) {
  auto surface = metricOf(*makeSample(kind, parameters));
  EXPECT_OK(surface);
  return *std::move(surface);
}

/// nx x ny unit cells without `holes` (by column and row), each cut along one diagonal, so that
/// two corners of the plate are ears: faces with two boundary edges. Cells may be sheared and have
/// another width.
inline MetricSurface plateWithEars(int nx, int ny, const std::set<std::pair<int, int>>& holes,
                                   double shear = 0, double width = 1) {
  std::vector<Eigen::Vector3d> positions;
  std::map<std::pair<int, int>, Index> number;
  const auto at = [&](int x, int y) {
    const auto [place, fresh] = number.try_emplace({x, y}, static_cast<Index>(positions.size()));
    if (fresh) positions.emplace_back(width * x + shear * y, y, 0);
    return place->second;
  };
  std::vector<Triangle> faces;
  for (int y = 0; y < ny; ++y) {
    for (int x = 0; x < nx; ++x) {
      if (holes.count({x, y}) != 0) continue;
      // The diagonal that cuts the corners off at the lower right and the upper left.
      faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return fromPositions(positions, faces);
}

inline Uniformization uniformized(const MetricSurface& given, bool initial_delaunay = true) {
  Context context;
  UniformizeOptions options;
  options.initial_delaunay = initial_delaunay;
  auto found = uniformize(context, given.surface, given.lengths, options);
  EXPECT_OK(found);
  return *std::move(found);
}

}  // namespace moduli
