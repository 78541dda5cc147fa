#include "server/service/geodesic_rows.h"

namespace moduli {
namespace {

/// Points of the surface that is sent, in space.
class Places {
 public:
  Places(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions,
         const Parameterization& map)
      : surface_(surface), positions_(positions), map_(map) {}

  Eigen::Vector3d on(Index h, double fraction) const {
    if (positions_.empty()) return Eigen::Vector3d::Zero();
    const Triangle& face =
        map_.subdivision ? map_.subdivision->faces[h / 3] : surface_.face(Connectivity::faceOf(h));
    return between(at(face[h % 3]), at(face[(h + 1) % 3]), fraction);
  }

 private:
  static Eigen::Vector3d between(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double t) {
    return a + t * (b - a);
  }

  Eigen::Vector3d at(Index v) const {
    if (v < surface_.vertexCount()) return positions_[v];
    const Subdivision::Vertex& vertex = map_.subdivision->vertices[v - surface_.vertexCount()];
    return between(positions_[surface_.tail(vertex.halfedge)],
                   positions_[surface_.head(vertex.halfedge)], vertex.fraction);
  }

  const Connectivity& surface_;
  const std::vector<Eigen::Vector3d>& positions_;
  const Parameterization& map_;
};

}  // namespace

std::vector<GeodesicRow> geodesicRows(const Connectivity& surface,
                                      const std::vector<Eigen::Vector3d>& positions,
                                      const Parameterization& map) {
  std::vector<GeodesicRow> rows;
  if (!map.hyperbolic) return rows;
  const Places places(surface, positions, map);
  for (const GeodesicPath& path : map.hyperbolic->geodesics) {
    for (const GeodesicPath::Step& step : path.steps) {
      const Eigen::Vector3d p = places.on(step.entry, step.fraction);
      rows.push_back({p.x(), p.y(), p.z(), step.from.real(), step.from.imag(), step.to.real(),
                      step.to.imag()});
    }
  }
  return rows;
}

}  // namespace moduli
