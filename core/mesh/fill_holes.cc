#include "core/mesh/fill_holes.h"

#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <cmath>
#include <string>
#include <utility>

#include "core/mesh/soup_structure.h"
#include "core/mesh/triangle_geometry.h"
#include "core/mesh/triangulate_loop.h"

namespace moduli {
namespace {

constexpr std::size_t kLongestTriangulated = 256;
constexpr std::size_t kCheckEvery = 10000;

// Half-edges alone: positions stay in the soup, where nothing can round them.
using EditableMesh = OpenMesh::TriConnectivity;
using Loop = std::vector<OpenMesh::HalfedgeHandle>;

class HoleFiller {
 public:
  HoleFiller(double fraction, TriangleSoup& soup, const SoupStructure& structure)
      : fraction_(fraction), soup_(soup), structure_(structure) {}

  Result<Index> run(Context& context) {
    RETURN_IF_ERROR(build(context));
    measureComponents();
    Index filled = 0;
    for (const Loop& loop : shortLoops()) {
      RETURN_IF_ERROR(fill(context, loop));
      ++filled;
    }
    return filled;
  }

 private:
  Status build(Context& context) {
    mesh_.reserve(soup_.vertices.size(), structure_.edges.count(), soup_.faces.size());
    for (std::size_t v = 0; v < soup_.vertices.size(); ++v) mesh_.add_vertex();
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      if (f % kCheckEvery == 0) RETURN_IF_ERROR(context.check());
      RETURN_IF_ERROR(addToMesh(soup_.faces[f]));
    }
    return {};
  }

  Status addToMesh(const Triangle& face) {
    const auto handle = mesh_.add_face(mesh_.vertex_handle(face[0]), mesh_.vertex_handle(face[1]),
                                       mesh_.vertex_handle(face[2]));
    if (handle.is_valid()) return {};
    return {Reason::kInternal, "the half-edge structure refused face " +
                                   std::to_string(mesh_.n_faces()) + " of a sound surface"};
  }

  Status addFace(const Triangle& face) {
    RETURN_IF_ERROR(addToMesh(face));
    soup_.faces.push_back(face);
    return {};
  }

  void measureComponents() {
    areas_.assign(structure_.components, 0);
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      const Triangle& face = soup_.faces[f];
      areas_[structure_.component[f]] +=
          triangleShape(soup_.vertices[face[0]], soup_.vertices[face[1]], soup_.vertices[face[2]])
              .area;
    }
  }

  // All loops first: filling one changes no other, as no vertex lies on two.
  std::vector<Loop> shortLoops() const {
    std::vector<Loop> loops;
    std::vector<bool> traced(mesh_.n_halfedges(), false);
    for (const auto start : mesh_.halfedges()) {
      if (!mesh_.is_boundary(start) || traced[start.idx()]) continue;
      Loop loop;
      double length = 0;
      for (OpenMesh::HalfedgeHandle h = start; !traced[h.idx()];
           h = mesh_.next_halfedge_handle(h)) {
        traced[h.idx()] = true;
        loop.push_back(h);
        length += (point(head(h)) - point(tail(h))).stableNorm();
      }
      const Index face = mesh_.opposite_face_handle(start).idx();
      const double size = std::sqrt(areas_[structure_.component[face]]);
      if (length < fraction_ * size) loops.push_back(std::move(loop));
    }
    return loops;
  }

  Status fill(Context& context, const Loop& loop) {
    if (loop.size() > kLongestTriangulated || isAloneTriangle(loop)) return fillByFan(loop);
    const auto blocked = [&](Index i, Index j) {
      return mesh_
          .find_halfedge(mesh_.from_vertex_handle(loop[i]), mesh_.from_vertex_handle(loop[j]))
          .is_valid();
    };
    ASSIGN_OR_RETURN(const auto triangles, triangulateLoop(context, spaceLoop(loop), blocked));
    if (!triangles) return fillByFan(loop);
    for (const Triangle& t : *triangles) {
      RETURN_IF_ERROR(addFace({tail(loop[t[0]]), tail(loop[t[1]]), tail(loop[t[2]])}));
    }
    return {};
  }

  // The rim of a single triangle, whose filling would be that triangle again.
  bool isAloneTriangle(const Loop& loop) const {
    return loop.size() == 3 &&
           mesh_.opposite_face_handle(loop[0]) == mesh_.opposite_face_handle(loop[1]) &&
           mesh_.opposite_face_handle(loop[1]) == mesh_.opposite_face_handle(loop[2]);
  }

  // A new vertex at the rim's centre of mass.
  Status fillByFan(const Loop& loop) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double length = 0;
    const Eigen::Vector3d& origin = point(tail(loop[0]));
    for (const OpenMesh::HalfedgeHandle h : loop) {
      const double edge = (point(head(h)) - point(tail(h))).stableNorm();
      sum += edge * (0.5 * (point(head(h)) - origin) + 0.5 * (point(tail(h)) - origin));
      length += edge;
    }
    const Eigen::Vector3d centre = length > 0 ? Eigen::Vector3d(origin + sum / length) : origin;
    const auto hub = static_cast<Index>(soup_.vertices.size());
    soup_.vertices.push_back(centre);
    mesh_.add_vertex();
    std::vector<Triangle> fan;
    for (const OpenMesh::HalfedgeHandle h : loop) fan.push_back({tail(h), head(h), hub});
    for (const Triangle& face : fan) RETURN_IF_ERROR(addFace(face));
    return {};
  }

  SpaceLoop spaceLoop(const Loop& loop) const {
    SpaceLoop space;
    for (const OpenMesh::HalfedgeHandle h : loop) {
      const Index f = mesh_.opposite_face_handle(h).idx();
      const Eigen::Vector3d& a = point(soup_.faces[f][0]);
      const Eigen::Vector3d ab = point(soup_.faces[f][1]) - a;
      const Eigen::Vector3d ac = point(soup_.faces[f][2]) - a;
      space.points.push_back(point(tail(h)));
      space.rim_normals.push_back(ab.cross(ac).stableNormalized());
    }
    return space;
  }

  Index tail(OpenMesh::HalfedgeHandle h) const { return mesh_.from_vertex_handle(h).idx(); }
  Index head(OpenMesh::HalfedgeHandle h) const { return mesh_.to_vertex_handle(h).idx(); }
  const Eigen::Vector3d& point(Index v) const { return soup_.vertices[v]; }

  const double fraction_;
  TriangleSoup& soup_;
  const SoupStructure& structure_;
  EditableMesh mesh_;
  std::vector<double> areas_;
};

}  // namespace

Result<Index> fillHoles(Context& context, double fraction, TriangleSoup& soup) {
  const SoupStructure structure = analyseSoup(static_cast<Index>(soup.vertices.size()), soup.faces);
  bool has_boundary = false;
  for (Index h = 0; h < static_cast<Index>(structure.partner.size()); ++h) {
    if (structure.partner[h] == h) has_boundary = true;
  }
  if (!has_boundary) return Index{0};
  return HoleFiller(fraction, soup, structure).run(context);
}

}  // namespace moduli
