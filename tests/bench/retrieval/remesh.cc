#include "tests/bench/retrieval/remesh.h"

#include <Eigen/Geometry>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <queue>
#include <set>
#include <utility>
#include <vector>

#include "core/mesh/connectivity.h"

namespace moduli {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using EditableMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
using OpenMesh::Vec3d;

EditableMesh toEditable(const TriangleSoup& soup) {
  EditableMesh mesh;
  for (const Eigen::Vector3d& p : soup.vertices) mesh.add_vertex({p.x(), p.y(), p.z()});
  for (const Triangle& t : soup.faces) {
    mesh.add_face(mesh.vertex_handle(t[0]), mesh.vertex_handle(t[1]), mesh.vertex_handle(t[2]));
  }
  return mesh;
}

TriangleSoup toSoup(const EditableMesh& mesh) {
  TriangleSoup soup;
  for (const auto v : mesh.vertices()) {
    const Vec3d& p = mesh.point(v);
    soup.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces()) {
    Triangle triangle{};
    std::size_t corner = 0;
    for (const auto v : mesh.fv_range(f)) triangle[corner++] = v.idx();
    soup.faces.push_back(triangle);
  }
  return soup;
}

// Splits edges, longest first. `count` of them.
void splitLongest(std::size_t count, EditableMesh& mesh, SampleRandom& random) {
  std::priority_queue<std::pair<double, int>> queue;
  const auto offer = [&](EditableMesh::EdgeHandle e) {
    queue.emplace(mesh.calc_edge_sqr_length(e), -e.idx());
  };
  for (const auto e : mesh.edges()) offer(e);
  while (count > 0 && !queue.empty()) {
    const auto [length, number] = queue.top();
    queue.pop();
    const EditableMesh::EdgeHandle e(-number);
    if (mesh.calc_edge_sqr_length(e) != length) continue;  // Split since it was offered.
    const auto h = mesh.halfedge_handle(e, 0);
    const double t = 0.35 + 0.3 * random.uniform();
    const Vec3d place =
        mesh.point(mesh.from_vertex_handle(h)) * (1 - t) + mesh.point(mesh.to_vertex_handle(h)) * t;
    const auto v = mesh.split_copy(e, place);
    for (const auto around : mesh.ve_range(v)) offer(around);
    --count;
  }
}

// Twice the area of a face times its normal.
Vec3d faceVector(const EditableMesh& mesh, EditableMesh::FaceHandle f) {
  auto v = mesh.cfv_iter(f);
  const Vec3d a = mesh.point(*v), b = mesh.point(*++v), c = mesh.point(*++v);
  return (b - a) % (c - a);
}

// Whether every face at v keeps a good part of its area and its side.
bool keepsFaces(const std::vector<Vec3d>& before, const EditableMesh& mesh,
                EditableMesh::VertexHandle v) {
  std::size_t i = 0;
  for (const auto f : mesh.vf_range(v)) {
    const Vec3d after = faceVector(mesh, f);
    if ((after | before[i]) < 0.3 * before[i].sqrnorm()) return false;
    ++i;
  }
  return true;
}

// Moves every vertex to a place within one of its faces.
void moveWithin(EditableMesh& mesh, SampleRandom& random) {
  for (const auto v : mesh.vertices()) {
    std::vector<EditableMesh::FaceHandle> faces;
    std::vector<Vec3d> before;
    for (const auto f : mesh.vf_range(v)) {
      faces.push_back(f);
      before.push_back(faceVector(mesh, f));
    }
    const Vec3d start = mesh.point(v);
    Vec3d goal(0, 0, 0);
    std::array<double, 3> weights{};
    for (double& w : weights) w = random.uniform() + 1e-3;
    std::size_t corner = 0;
    for (const auto u : mesh.fv_range(faces[random.next() % faces.size()])) {
      goal += mesh.point(u) * (weights[corner++] / (weights[0] + weights[1] + weights[2]));
    }
    double step = 0.6 * random.uniform();
    for (int attempt = 0; attempt < 4; ++attempt, step /= 2) {
      mesh.set_point(v, start * (1 - step) + goal * step);
      if (keepsFaces(before, mesh, v)) break;
      mesh.set_point(v, start);
    }
  }
}

double angleOpposite(const EditableMesh& mesh, EditableMesh::HalfedgeHandle h) {
  return mesh.calc_sector_angle(mesh.next_halfedge_handle(h));
}

// Flips edges that are not Delaunay, where both pairs of faces are nearly in one plane.
void flipFlatEdges(EditableMesh& mesh) {
  constexpr double kFlat = 10 * std::numbers::pi / 180;
  for (int pass = 0; pass < 4; ++pass) {
    for (const auto e : mesh.edges()) {
      if (mesh.is_boundary(e) || !mesh.is_flip_ok(e)) continue;
      if (std::abs(mesh.calc_dihedral_angle(e)) > kFlat) continue;
      const auto h = mesh.halfedge_handle(e, 0), twin = mesh.halfedge_handle(e, 1);
      if (angleOpposite(mesh, h) + angleOpposite(mesh, twin) <= std::numbers::pi + 1e-9) continue;
      mesh.flip(e);
      if (std::abs(mesh.calc_dihedral_angle(e)) > kFlat) mesh.flip(e);
    }
  }
}

// Grows a disk of faces from a first one, nearest faces first.
class GrowingDisk {
 public:
  GrowingDisk(const Connectivity& surface, const std::vector<Eigen::Vector3d>& positions,
              Index first)
      : surface_(surface),
        positions_(positions),
        has_face_(surface.faceCount(), false),
        has_vertex_(surface.vertexCount(), false),
        centre_(centreOf(first)) {
    take(first);
  }

  double area() const { return area_; }
  bool has(Index face) const { return has_face_[face]; }

  // False where no further face can be added.
  bool grow() {
    while (!offers_.empty()) {
      const Index face = -offers_.top().second;
      offers_.pop();
      if (has_face_[face] || !staysDisk(face)) continue;
      take(face);
      return true;
    }
    return false;
  }

 private:
  Eigen::Vector3d centreOf(Index face) const {
    const Triangle& t = surface_.face(face);
    return (positions_[t[0]] + positions_[t[1]] + positions_[t[2]]) / 3;
  }

  // A face with one edge in the disk must bring a new vertex; one with two closes a gap; one with
  // three, or with a vertex alone, would change the topology.
  bool staysDisk(Index face) const {
    int edges = 0, vertices = 0;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index twin = surface_.twin(h);
      if (twin != kNone && has_face_[twin / 3]) ++edges;
      if (has_vertex_[surface_.tail(h)]) ++vertices;
    }
    return (edges == 1 && vertices == 2) || (edges == 2 && vertices == 3);
  }

  void take(Index face) {
    has_face_[face] = true;
    const Triangle& t = surface_.face(face);
    for (const Index v : t) has_vertex_[v] = true;
    area_ +=
        (positions_[t[1]] - positions_[t[0]]).cross(positions_[t[2]] - positions_[t[0]]).norm() / 2;
    for (const Index f : t) {
      for (Index h = surface_.outgoing(f), first = h;;) {
        const Index near = h / 3;
        if (!has_face_[near]) offers_.emplace(-(centreOf(near) - centre_).norm(), -near);
        h = surface_.rotate(h);
        if (h == first || h == kNone) break;
      }
    }
  }

  const Connectivity& surface_;
  const std::vector<Eigen::Vector3d>& positions_;
  std::vector<bool> has_face_;
  std::vector<bool> has_vertex_;
  Eigen::Vector3d centre_;
  std::priority_queue<std::pair<double, Index>> offers_;
  double area_ = 0;
};

double areaOf(const TriangleSoup& soup) {
  double area = 0;
  for (const Triangle& t : soup.faces) {
    area += (soup.vertices[t[1]] - soup.vertices[t[0]])
                .cross(soup.vertices[t[2]] - soup.vertices[t[0]])
                .norm() /
            2;
  }
  return area;
}

// Drops vertices without faces and numbers the others in their order.
TriangleSoup compacted(const TriangleSoup& soup, const std::vector<Triangle>& faces) {
  std::vector<Index> number(soup.vertices.size(), kNone);
  for (const Triangle& t : faces) {
    for (const Index v : t) number[v] = 0;
  }
  TriangleSoup result;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = static_cast<Index>(result.vertices.size());
    result.vertices.push_back(soup.vertices[v]);
  }
  for (const Triangle& t : faces) {
    result.faces.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return result;
}

}  // namespace

TriangleSoup simplified(const TriangleSoup& soup, std::size_t faces) {
  if (soup.faces.size() <= faces) return soup;
  EditableMesh mesh = toEditable(soup);
  mesh.request_face_normals();
  mesh.update_face_normals();
  OpenMesh::Decimater::DecimaterT<EditableMesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<EditableMesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<EditableMesh>::Handle flipping;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  decimater.add(flipping);
  decimater.module(flipping).set_max_normal_deviation(75);
  decimater.initialize();
  decimater.decimate_to_faces(0, faces);
  mesh.garbage_collection();
  return toSoup(mesh);
}

TriangleSoup refinedUnevenly(const TriangleSoup& soup, SampleRandom& random) {
  EditableMesh mesh = toEditable(soup);
  splitLongest(soup.faces.size() / 4, mesh, random);
  moveWithin(mesh, random);
  flipFlatEdges(mesh);
  return toSoup(mesh);
}

Result<TriangleSoup> punched(const TriangleSoup& soup, double share, SampleRandom& random) {
  ASSIGN_OR_RETURN(const Connectivity surface,
                   Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), soup.faces));
  const auto first = static_cast<Index>(random.next() % soup.faces.size());
  GrowingDisk disk(surface, soup.vertices, first);
  const double goal = share * areaOf(soup);
  while (disk.area() < goal) {
    if (!disk.grow()) return Status(Reason::kInternal, "the hole cannot grow");
  }
  std::vector<Triangle> kept;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    if (!disk.has(f)) kept.push_back(surface.face(f));
  }
  return compacted(soup, kept);
}

}  // namespace moduli
