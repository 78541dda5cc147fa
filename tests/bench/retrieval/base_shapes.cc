#include <map>
#include <string>

#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/bench/retrieval/variants.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

struct Sample {
  std::string label;
  std::string kind;
  std::map<std::string, double> parameters;
};

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = {
      {"sphere", "sphere", {{"resolution", 12}, {"seed", 1}}},
      {"ellipsoid", "ellipsoid", {{"b", 0.7}, {"c", 0.4}, {"resolution", 16}, {"seed", 2}}},
      {"lens", "spheroid", {{"c", 0.3}, {"resolution", 14}, {"seed", 3}}},
      {"capsule", "capped-cylinder", {{"half_length", 3}, {"resolution", 12}, {"seed", 4}}},
      {"ring", "torus", {{"R", 3}, {"r", 0.6}, {"resolution", 24}, {"seed", 5}}},
      {"fat-torus", "torus", {{"R", 1.5}, {"r", 1}, {"resolution", 36}, {"seed", 6}}},
      {"flat-torus", "diplotorus", {{"resolution", 10}}},
      {"plate-2", "genus", {{"genus", 2}, {"resolution", 8}, {"seed", 7}}},
      {"plate-4", "genus", {{"genus", 4}, {"resolution", 8}, {"seed", 8}}}};
  return all;
}

struct File {
  std::string label;
  std::string path;
  std::string other;  ///< "" or a file with the same shape in another triangulation.
};

const std::vector<File>& files() {
  static const std::vector<File> all = {
      {"bunny", "closed_g0/odedstein__bunny.obj", ""},
      {"goathead", "closed_g0/odedstein__goathead.obj", ""},
      {"penguin", "closed_g0/odedstein__penguin.obj", ""},
      {"maxplanck", "closed_g0/cfwen__maxplanck.nf25k.off", ""},
      {"spot", "closed_g0/alec__spot.obj", ""},
      {"homer", "closed_g0/alec__homer.obj", ""},
      {"fandisk", "closed_g0/libigl-data__fandisk.off", ""},
      {"screwdriver", "closed_g0/libigl-data__screwdriver.off", ""},
      {"knight", "closed_g0/libigl-data__decimated-knight.off", ""},
      {"igea", "large/alec__igea.ply", ""},
      {"cortex", "brain/nilearn__pial_left.ply", ""},
      {"inflated-cortex", "brain/nilearn__infl_left.ply", ""},
      {"kitten", "genus1/cfwen__kitten.nf20k.off", "genus1/ceaedf__Kitten.off"},
      {"knot", "genus1/cfwen__knot.obj", ""},
      {"rocker-arm", "genus1/alec__rocker-arm.obj", "genus1/ceaedf__rocker-arm2500.off"},
      {"eight", "genus2/ceaedf__eight.off", "genus2/cfwen__eight.off"},
      {"skull", "genus2/odedstein__skull_low_resolution.obj", ""},
      {"cup", "genus2/ceaedf__cup_input_simple_10000.off", ""},
      {"3holes", "genus3plus/libigl-data__3holes.off", ""},
      {"genus3", "genus3plus/ceaedf__genus3.off", ""},
      {"fertility", "genus3plus/ceaedf__fertility_input.off",
       "genus3plus/libigl-data__fertility.off"},
      {"botijo", "genus3plus/ceaedf__botijo.off", ""},
      {"boot", "genus3plus/odedstein__boot.obj", ""}};
  return all;
}

Result<TriangleSoup> closedSurface(Context& context, const TriangleSoup& soup,
                                   std::size_t max_faces) {
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, {}));
  const Connectivity& surface = prepared.mesh.connectivity();
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    if (surface.isBoundaryEdge(e)) return Status(Reason::kNotClosed, "the surface has a boundary");
  }
  return simplified({prepared.mesh.positions(), surface.faces()}, max_faces);
}

Result<TriangleSoup> readClosed(Context& context, const std::string& path, std::size_t max_faces) {
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  Result<TriangleSoup> closed = closedSurface(context, soup, max_faces);
  if (!closed.ok()) return closed.status().withContext(path);
  return closed;
}

}  // namespace

Result<std::vector<BaseShape>> loadBaseShapes(Context& context, const BaseOptions& options) {
  std::vector<BaseShape> shapes;
  for (const Sample& sample : samples()) {
    ASSIGN_OR_RETURN(const TriangleSoup soup, makeSample(sample.kind, sample.parameters));
    ASSIGN_OR_RETURN(TriangleSoup closed, closedSurface(context, soup, options.max_faces));
    shapes.push_back({sample.label, std::move(closed), {}});
  }
  for (const File& file : files()) {
    const auto path = sharedMesh(file.path);
    if (!path) continue;
    BaseShape shape{file.label, {}, {}};
    ASSIGN_OR_RETURN(shape.soup, readClosed(context, *path, options.max_faces));
    if (const auto other = file.other.empty() ? std::nullopt : sharedMesh(file.other)) {
      ASSIGN_OR_RETURN(shape.other, readClosed(context, *other, options.max_faces));
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace moduli
