#include "core/parameterize/components.h"

#include <cmath>
#include <vector>

#include "tests/core/parameterize/plane_targets.h"

namespace moduli {
namespace {

/// Surfaces beside one another, the faces of all of them interleaved: components are no ranges.
MetricSurface together(const std::vector<MetricSurface>& parts) {
  std::vector<Triangle> faces;
  std::vector<Index> twin, part_of, face_of;
  std::vector<double> lengths;
  std::vector<Index> first_vertex = {0};
  Index most = 0;
  for (const MetricSurface& part : parts) {
    first_vertex.push_back(first_vertex.back() + part.surface.vertexCount());
    most = std::max(most, part.surface.faceCount());
  }
  std::vector<std::vector<Index>> place(parts.size());
  for (Index f = 0; f < most; ++f) {
    for (std::size_t n = 0; n < parts.size(); ++n) {
      if (f >= parts[n].surface.faceCount()) continue;
      place[n].push_back(static_cast<Index>(faces.size()));
      Triangle face = parts[n].surface.face(f);
      for (Index& v : face) v += first_vertex[n];
      faces.push_back(face);
      part_of.push_back(static_cast<Index>(n));
      face_of.push_back(f);
    }
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const MetricSurface& part = parts[part_of[i]];
    for (Index h = 3 * face_of[i]; h < 3 * face_of[i] + 3; ++h) {
      const Index other = part.surface.twin(h);
      twin.push_back(
          other == kNone ? kNone : 3 * place[part_of[i]][Connectivity::faceOf(other)] + other % 3);
      lengths.push_back(part.lengths[part.surface.edge(h)]);
    }
  }
  return fromHalfedges(first_vertex.back(), std::move(faces), std::move(twin), lengths);
}

Result<Parameterization> alone(Context& context, const SurfaceComponent& component,
                               const FlatOptions& options) {
  return parameterizeFlat(context, component.surface, component.lengths, options);
}

TEST(Components, AreThePartsInTheirOwnNumbers) {
  const std::vector<MetricSurface> parts = {plate(3, 2, {}), flatTorus({0.2, 1.1}, 5, 4, 0.1, 1),
                                            doubled(plate(2, 2, {}))};
  const MetricSurface whole = together(parts);
  const auto components = componentsOf(whole.surface, whole.lengths);
  ASSERT_OK(components);
  ASSERT_EQ(components->size(), parts.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const SurfaceComponent& own = (*components)[n];
    EXPECT_EQ(own.surface.faces(), parts[n].surface.faces());
    EXPECT_EQ(own.lengths, parts[n].lengths);
    for (Index f = 0; f < own.surface.faceCount(); ++f) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(own.vertices[own.surface.face(f)[c]], whole.surface.face(own.faces[f])[c]);
      }
    }
    for (Index h = 0; h < own.surface.halfedgeCount(); ++h) {
      EXPECT_EQ(own.surface.twin(h), parts[n].surface.twin(h));
      EXPECT_EQ(own.edges[own.surface.edge(h)],
                whole.surface.edge(3 * own.faces[Connectivity::faceOf(h)] + h % 3));
    }
  }
}

TEST(FlattenComponents, PutsEachSideBySideAsItIsAlone) {
  const std::vector<MetricSurface> parts = {plate(4, 3, {{1, 1}}), torusOfRevolution(2, 0.7, 12, 9),
                                            plate(3, 2, {})};
  const MetricSurface whole = together(parts);
  Context context;
  const auto map = flattenComponents(context, whole.surface, whole.lengths, {}, alone);
  ASSERT_OK(map);
  const PlanarFaces faces{whole.surface, map->points, map->corner};
  expectFlatSheets(faces, *map);
  int islands = 0;
  const auto components = componentsOf(whole.surface, whole.lengths);
  ASSERT_OK(components);
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const auto own = parameterizeFlat(context, parts[n].surface, parts[n].lengths, {});
    ASSERT_OK(own);
    islands += *own->certificate.islands;
    const PlanarFaces own_faces{parts[n].surface, own->points, own->corner};
    for (Index h = 0; h < parts[n].surface.halfedgeCount(); ++h) {
      const Index there = 3 * (*components)[n].faces[Connectivity::faceOf(h)] + h % 3;
      EXPECT_LE(std::abs(faces.along(there) - own_faces.along(h)), 1e-12);
      EXPECT_EQ(faces.isSeam(there), own_faces.isSeam(h));
    }
    EXPECT_LE(own->certificate.quality.max_dilatation,
              map->certificate.quality.max_dilatation * (1 + 1e-12));
  }
  EXPECT_EQ(*map->certificate.islands, islands);
}

TEST(FlattenComponents, GivesEachItsConesAndSeams) {
  // Two pillows, the second with seams along all edges of its first face.
  const std::vector<MetricSurface> parts = {doubled(plate(4, 3, {})), doubled(plate(3, 3, {}))};
  const MetricSurface whole = together(parts);
  FlatOptions options;
  const std::vector<double> curvatures = curvaturesOf(whole);
  for (Index v = 0; v < whole.surface.vertexCount(); ++v) {
    if (curvatures[v] > 1) options.cones.push_back({v, curvatures[v]});
  }
  ASSERT_EQ(options.cones.size(), 8U);
  options.seams.assign(whole.surface.edgeCount(), false);
  for (Index h = 3; h < 6; ++h) options.seams[whole.surface.edge(h)] = true;
  Context context;
  const auto map = flattenComponents(context, whole.surface, whole.lengths, options, alone);
  ASSERT_OK(map);
  const PlanarFaces faces{whole.surface, map->points, map->corner};
  expectFlatSheets(faces, *map);
  EXPECT_EQ(map->cones->cones.size(), 8U);
  EXPECT_EQ(*map->certificate.islands, 3);
  for (Index h = 3; h < 6; ++h) EXPECT_TRUE(faces.isSeam(h));
  // The metric was flat but for the cones: nothing is stretched.
  EXPECT_NEAR(map->certificate.quality.max_dilatation, 1, 1e-9);
}

TEST(FlattenComponents, CutsFacesOfOneAndKeepsTheOther) {
  const MetricSurface folding = insertNearCorners(
      planeSample("torus", {{"R", 1.2}, {"r", 1}, {"resolution", 6}, {"seed", 2}}), 0.02, 4);
  const MetricSurface simple = plate(4, 3, {});
  const MetricSurface whole = together({folding, simple});
  FlatOptions options;
  options.cones = {{0, 1}, {20, -1}};
  Context context;
  const auto map = flattenComponents(context, whole.surface, whole.lengths, options, alone);
  ASSERT_OK(map);
  ASSERT_TRUE(map->subdivision.has_value());
  const Connectivity surface = facesOfMap(whole, *map);
  expectFlatSheets({surface, map->points, map->corner}, *map);
  EXPECT_TRUE(std::is_sorted(map->subdivision->parent.begin(), map->subdivision->parent.end()));
  // All faces of the plate are there as they were; those of the torus are more.
  EXPECT_GT(surface.faceCount(), whole.surface.faceCount());
  Index kept = 0;
  for (Index f = 0; f < surface.faceCount(); ++f) {
    const Index parent = map->subdivision->parent[f];
    if (whole.surface.face(parent)[0] < folding.surface.vertexCount()) continue;
    EXPECT_EQ(surface.face(f), whole.surface.face(parent));
    ++kept;
  }
  EXPECT_EQ(kept, simple.surface.faceCount());
}

TEST(FlattenComponents, NamesTheComponentThatFails) {
  Context context;
  const MetricSurface whole = together({plate(3, 2, {}), doubled(plate(2, 2, {}))});
  const auto map = flattenComponents(context, whole.surface, whole.lengths, {}, alone);
  ASSERT_FALSE(map.ok());
  EXPECT_EQ(map.status().reason(), Reason::kInvalidOption);
  EXPECT_TRUE(map.status().message().starts_with("component 1: ")) << map.status().message();
  FlatOptions options;
  options.cones = {{whole.surface.vertexCount(), 1}};
  EXPECT_THAT(flattenComponents(context, whole.surface, whole.lengths, options, alone),
              FailsWith(Reason::kInvalidOption));
}

}  // namespace
}  // namespace moduli
