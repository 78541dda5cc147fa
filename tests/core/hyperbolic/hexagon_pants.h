#pragma once

#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "core/hyperbolic/su11.h"
#include "core/hyperbolic/trigonometry.h"
#include "core/intrinsic/assemble_surface.h"
#include "core/intrinsic/delaunay.h"
#include "core/intrinsic/intrinsic_surface.h"
#include "tests/core/testing.h"

/// A pair of pants that is known exactly, glued of two right-angled hexagons.
namespace moduli {

/// Triangles of a right-angled hexagon in the disk.
struct HexagonMesh {
  std::vector<Complex> points;
  std::vector<Triangle> faces;
  std::vector<int> side;  ///< Per halfedge its side, 0 .. 5; -1 inside.
  double closing = 0;     ///< How far its sides, one after the other, miss the first corner.
};

inline Complex hyperbolicMidpoint(Complex p, Complex q) {
  const Su11 frame = edgeFrame(p, q);
  return imageOf(frame, std::tanh(hyperbolicDistance(p, q) / 4));
}

/// Six triangles around the middle; side k runs from corner k to the next.
inline HexagonMesh hexagonFan(const std::array<double, 6>& sides) {
  HexagonMesh mesh;
  Su11 frame;
  for (const double length : sides) {
    mesh.points.push_back(imageOf(frame, 0.0));
    frame = renormalized(frame * translation(length) * rotation(std::numbers::pi / 2));
  }
  mesh.closing = displacement(frame);
  mesh.points.push_back(hyperbolicMidpoint(hyperbolicMidpoint(mesh.points[0], mesh.points[2]),
                                           hyperbolicMidpoint(mesh.points[4], mesh.points[1])));
  for (int k = 0; k < 6; ++k) {
    mesh.faces.push_back({k, (k + 1) % 6, 6});
    mesh.side.insert(mesh.side.end(), {k, -1, -1});
  }
  return mesh;
}

/// Every face cut into four by the midpoints of its sides.
inline HexagonMesh halved(const HexagonMesh& coarse) {
  HexagonMesh fine{coarse.points, {}, {}, coarse.closing};
  const Connectivity surface =
      *Connectivity::fromFaces(static_cast<Index>(coarse.points.size()), coarse.faces);
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    fine.points.push_back(
        hyperbolicMidpoint(coarse.points[surface.tail(h)], coarse.points[surface.head(h)]));
  }
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const auto middle = [&](int c) { return surface.vertexCount() + surface.edge(3 * f + c); };
    for (int c = 0; c < 3; ++c) {
      fine.faces.push_back({surface.face(f)[c], middle(c), middle((c + 2) % 3)});
      fine.side.insert(fine.side.end(),
                       {coarse.side[3 * f + c], -1, coarse.side[3 * f + (c + 2) % 3]});
    }
    fine.faces.push_back({middle(0), middle(1), middle(2)});
    fine.side.insert(fine.side.end(), {-1, -1, -1});
  }
  return fine;
}

/// The Delaunay triangulation of the same points.
inline HexagonMesh flipped(const HexagonMesh& mesh) {
  const auto distance = [&](Index v, Index w) {
    return hyperbolicDistance(mesh.points[v], mesh.points[w]);
  };
  const Connectivity surface =
      *Connectivity::fromFaces(static_cast<Index>(mesh.points.size()), mesh.faces);
  std::vector<double> half_chords;
  std::vector<std::array<Index, 2>> rim;
  std::vector<int> rim_side;
  for (Index e = 0; e < surface.edgeCount(); ++e) {
    const Index h = surface.halfedge(e);
    half_chords.push_back(
        halfChord(Geometry::kHyperbolic, distance(surface.tail(h), surface.head(h))));
    if (!surface.isBoundaryEdge(e)) continue;
    rim.push_back({surface.tail(h), surface.head(h)});
    rim_side.push_back(mesh.side[h]);
  }
  IntrinsicTriangulation triangulation(surface, half_chords);
  for (bool changed = true; changed;) {
    changed = false;
    for (Index h = 0; h < triangulation.halfedgeCount(); ++h) {
      if (isDelaunay(triangulation, h)) continue;
      const Index left = triangulation.tail(Connectivity::previous(h));
      const Index right = triangulation.tail(Connectivity::previous(triangulation.twin(h)));
      triangulation.flip(h, halfChord(Geometry::kHyperbolic, distance(left, right)));
      changed = true;
    }
  }
  const Connectivity better = triangulation.connectivity();
  HexagonMesh result{mesh.points, better.faces(), {}, mesh.closing};
  result.side.assign(better.halfedgeCount(), -1);
  for (Index h = 0; h < better.halfedgeCount(); ++h) {
    for (std::size_t i = 0; i < rim.size(); ++i) {
      if (rim[i][0] == better.tail(h) && rim[i][1] == better.head(h)) result.side[h] = rim_side[i];
    }
  }
  return result;
}

/// A halfedge on the rim whose mirror image's face does not meet its own in a Delaunay edge: the
/// angle opposite is obtuse in the triangle of chords.
inline Index encroachedSide(const HexagonMesh& mesh) {
  for (Index h = 0; h < static_cast<Index>(mesh.side.size()); ++h) {
    if (mesh.side[h] < 0) continue;
    std::array<double, 3> chord{};
    for (int c = 0; c < 3; ++c) {
      const Triangle& face = mesh.faces[h / 3];
      chord[c] = halfChord(
          Geometry::kHyperbolic,
          hyperbolicDistance(mesh.points[face[(h + c) % 3]], mesh.points[face[(h + c + 1) % 3]]));
    }
    if (delaunaySlack(chord[0], chord[1], chord[2], chord[1], chord[2]) < 0) return h;
  }
  return kNone;
}

/// A side of a face on the rim cut at its middle.
inline HexagonMesh cutAt(HexagonMesh mesh, Index h) {
  const Index f = h / 3, middle = static_cast<Index>(mesh.points.size());
  const Index a = mesh.faces[f][h % 3], b = mesh.faces[f][(h + 1) % 3];
  const Index c = mesh.faces[f][(h + 2) % 3];
  const std::array<int, 3> side{mesh.side[h], mesh.side[Connectivity::next(h)],
                                mesh.side[Connectivity::previous(h)]};
  mesh.points.push_back(hyperbolicMidpoint(mesh.points[a], mesh.points[b]));
  mesh.faces[f] = {a, middle, c};
  mesh.faces.push_back({middle, b, c});
  mesh.side[3 * f] = side[0];
  mesh.side[3 * f + 1] = -1;
  mesh.side[3 * f + 2] = side[2];
  mesh.side.insert(mesh.side.end(), {side[0], side[1], -1});
  return mesh;
}

/// Two copies of a hexagon, the second turned over, glued along its odd sides. Face f + F of the
/// second copy has the corners 0, 2, 1 of face f.
inline SurfaceTables gluedAlongSeams(const HexagonMesh& hexagon) {
  const auto vertices = static_cast<Index>(hexagon.points.size());
  const auto faces = static_cast<Index>(hexagon.faces.size());
  const Connectivity surface = *Connectivity::fromFaces(vertices, hexagon.faces);
  const auto mirrored = [&](Index h) { return 3 * (h / 3 + faces) + 2 - h % 3; };
  SurfaceTables tables;
  tables.geometry = Geometry::kHyperbolic;
  tables.twin.emplace(6 * faces, kNone);
  tables.lengths.resize(6 * faces);
  std::vector<bool> on_seam(vertices, false);
  for (Index h = 0; h < 3 * faces; ++h) {
    tables.lengths[h] = tables.lengths[mirrored(h)] =
        hyperbolicDistance(hexagon.points[surface.tail(h)], hexagon.points[surface.head(h)]);
    const Index twin = surface.twin(h);
    if (twin != kNone) {
      (*tables.twin)[h] = twin;
      (*tables.twin)[mirrored(h)] = mirrored(twin);
    } else if (hexagon.side[h] % 2 == 1) {
      (*tables.twin)[h] = mirrored(h);
      (*tables.twin)[mirrored(h)] = h;
      on_seam[surface.tail(h)] = on_seam[surface.head(h)] = true;
    }
  }
  std::vector<Index> copy(vertices);
  tables.vertex_count = vertices;
  for (Index v = 0; v < vertices; ++v) copy[v] = on_seam[v] ? v : tables.vertex_count++;
  tables.faces = hexagon.faces;
  for (const Triangle& face : hexagon.faces) {
    tables.faces.push_back({copy[face[0]], copy[face[2]], copy[face[1]]});
  }
  return tables;
}

/// The pair of pants with these cuffs in 12 * 4^levels triangles and some more, such that they and
/// the pants' double are Delaunay.
inline IntrinsicSurface hexagonPants(const std::array<double, 3>& cuffs, int levels = 2) {
  const std::array<double, 3> seams = *pantsSeams(cuffs);
  HexagonMesh mesh =
      hexagonFan({cuffs[0] / 2, seams[2], cuffs[1] / 2, seams[0], cuffs[2] / 2, seams[1]});
  EXPECT_LT(mesh.closing, 1e-13);
  for (int n = 0; n < levels; ++n) mesh = halved(mesh);
  mesh = flipped(mesh);
  for (Index h = encroachedSide(mesh); h != kNone; h = encroachedSide(mesh)) {
    mesh = flipped(cutAt(std::move(mesh), h));
  }
  Context context;
  auto pants = assembleSurface(context, gluedAlongSeams(mesh));
  EXPECT_OK(pants);
  return *std::move(pants);
}

}  // namespace moduli
