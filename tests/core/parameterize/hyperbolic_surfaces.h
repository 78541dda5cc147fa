#pragma once

#include <algorithm>
#include <iostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/hyperbolic/fuchsian_group.h"
#include "core/hyperbolic/length_spectrum.h"
#include "core/intrinsic/chordal_metric.h"
#include "core/parameterize/hyperbolic.h"
#include "core/topology/surface_topology.h"
#include "tests/core/hyperbolic/hexagon_pants.h"
#include "tests/core/hyperbolic/uniformized_samples.h"
#include "tests/core/parameterize/disk_checks.h"

/// Surfaces and their maps to the disk, for the tests of these.
namespace moduli {

/// The chords of a surface that is given hyperbolic.
inline MetricSurface chordsOf(const IntrinsicSurface& given) {
  const auto lengths = chordLengths(given);
  EXPECT_OK(lengths);
  return {given.connectivity, *lengths};
}

inline Result<Parameterization> mapped(const MetricSurface& given,
                                       const HyperbolicOptions& options = {}) {
  Context context;
  return parameterizeHyperbolic(context, given.surface, given.lengths, options);
}

/// The faces that a map is of.
inline Connectivity mappedFaces(const MetricSurface& given, const Parameterization& map) {
  if (!map.subdivision) return given.surface;
  const auto vertices =
      given.surface.vertexCount() + static_cast<Index>(map.subdivision->vertices.size());
  auto faces = Connectivity::fromFaces(vertices, map.subdivision->faces);
  EXPECT_OK(faces);
  return *std::move(faces);
}

inline std::vector<double> lengthsOf(const Parameterization& map) {
  std::vector<double> lengths;
  for (const GeodesicPath& path : map.hyperbolic->geodesics) lengths.push_back(path.length);
  return lengths;
}

inline void expectNear(const std::vector<double>& found, const std::vector<double>& expected,
                       double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i], expected[i], tolerance) << "entry " << i;
  }
}

/// Pieces lie where the given faces did, with their vertices.
inline void expectCutFaces(const MetricSurface& given, const Subdivision& subdivision) {
  const Index vertices = given.surface.vertexCount();
  std::vector<std::set<Index>> corners(given.surface.faceCount());
  ASSERT_EQ(subdivision.parent.size(), subdivision.faces.size());
  for (std::size_t f = 0; f < subdivision.faces.size(); ++f) {
    const Index parent = subdivision.parent[f];
    const Triangle& whole = given.surface.face(parent);
    for (const Index v : subdivision.faces[f]) {
      if (v < vertices) {
        ASSERT_NE(std::find(whole.begin(), whole.end(), v), whole.end());
        corners[parent].insert(v);
        continue;
      }
      const Index h = subdivision.vertices[v - vertices].halfedge;
      const Index twin = given.surface.twin(h);
      ASSERT_TRUE(h / 3 == parent || (twin != kNone && twin / 3 == parent));
    }
  }
  for (const std::set<Index>& all : corners) EXPECT_EQ(all.size(), 3U);
  for (const Subdivision::Vertex& vertex : subdivision.vertices) {
    EXPECT_GT(vertex.fraction, 0);
    EXPECT_LT(vertex.fraction, 1);
  }
}

/// All that an image with a boundary has.
inline void expectBorderedImage(const MetricSurface& given, const Parameterization& map) {
  ASSERT_TRUE(map.hyperbolic);
  const Connectivity faces = mappedFaces(given, map);
  const DiskFaces disk{{faces, map.points, map.corner}, map.hyperbolic->neighbours};
  expectSheet(disk, map.hyperbolic->radius);
  expectSeams(disk);
  expectGeodesics(disk, *map.hyperbolic);
  if (map.subdivision) expectCutFaces(given, *map.subdivision);
  const auto loops = computeTopology(faces).boundary_loops;
  EXPECT_GE(expectStraightBoundary(disk), static_cast<int>(loops.size()));
  expectNear(map.hyperbolic->boundary_lengths, imageBoundaryLengths(disk, loops), 1e-9);
  std::cout << given.surface.faceCount() << " faces in " << faces.faceCount() << ", radius "
            << map.hyperbolic->radius << ", " << map.hyperbolic->neighbours.size()
            << " neighbours, closure " << *map.certificate.layout_closure << ", "
            << map.hyperbolic->geodesics.size() << " geodesics\n";
}

/// The group of the generators is that of the neighbours.
inline void expectOneGroup(const HyperbolicDomain& domain, int genus) {
  ASSERT_EQ(domain.generators.size(), 2 * static_cast<std::size_t>(genus));
  EXPECT_LE(canonicalRelationResidual(domain.generators), 1e-8);
  Context context;
  const auto polygon = orbitPolygon(context, domain.neighbours, genus);
  ASSERT_OK(polygon);
  for (const Su11& g : domain.generators) EXPECT_TRUE(isInGroup(*polygon, g));
  // Generators move 0 farther than neighbours, the farther the higher the genus, so that products
  // of rounded ones soon are of no use.
  if (genus > 3) return;
  const auto other = orbitPolygon(context, domain.generators, genus);
  ASSERT_OK(other);
  for (const Su11& g : domain.neighbours) EXPECT_TRUE(isInGroup(*other, g));
}

/// All geodesics up to where the map knows them are those of its group.
inline void expectLengthsOfGroup(const Parameterization& map, int genus) {
  Context context;
  const auto polygon = orbitPolygon(context, map.hyperbolic->neighbours, genus);
  ASSERT_OK(polygon);
  const auto spectrum = lengthSpectrum(context, *polygon, *map.certificate.spectrum_complete_to);
  ASSERT_OK(spectrum);
  const std::vector<double> lengths = lengthsOf(map);
  ASSERT_FALSE(lengths.empty());
  ASSERT_LE(lengths.size(), spectrum->geodesics.size());
  if (lengths.size() < 12) {
    EXPECT_EQ(lengths.size(), spectrum->geodesics.size());
  }
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_NEAR(lengths[i], spectrum->geodesics[i].length, 1e-9);
  }
}

inline void expectClosedDomain(const MetricSurface& given, const Parameterization& map) {
  ASSERT_TRUE(map.hyperbolic);
  const Connectivity faces = mappedFaces(given, map);
  const DiskFaces disk{{faces, map.points, map.corner}, map.hyperbolic->neighbours};
  expectSheet(disk, map.hyperbolic->radius);
  expectSeams(disk);
  expectGeodesics(disk, *map.hyperbolic);
  const int genus = 1 - given.surface.eulerCharacteristic() / 2;
  expectOneGroup(*map.hyperbolic, genus);
  expectLengthsOfGroup(map, genus);
  EXPECT_TRUE(map.hyperbolic->boundary_lengths.empty());
  const MapCertificate& certificate = map.certificate;
  EXPECT_TRUE(certificate.warnings.empty());
  EXPECT_LT(*certificate.layout_closure, 1e-6);
  EXPECT_EQ(certificate.quality.flipped_faces, 0);
  EXPECT_LT(*certificate.cycle_residual, 1e-9);
  EXPECT_NEAR(*certificate.relation_residual, canonicalRelationResidual(map.hyperbolic->generators),
              1e-15);
  std::cout << faces.faceCount() << " faces, radius " << map.hyperbolic->radius << ", "
            << map.hyperbolic->neighbours.size() << " neighbours, area off by "
            << disk.area() + 2 * std::numbers::pi * faces.eulerCharacteristic() << ", closure "
            << *certificate.layout_closure << ", relation " << *certificate.relation_residual
            << ", " << map.hyperbolic->geodesics.size() << " geodesics\n";
}

}  // namespace moduli
