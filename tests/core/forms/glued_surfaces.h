#pragma once

#include <array>
#include <complex>
#include <set>
#include <utility>
#include <vector>

#include "tests/core/forms/surfaces.h"

/// Flat surfaces with cone points whose period matrices are known, glued from plane triangles, and
/// plates with holes.
namespace moduli {

/// A side of a triangle: the triangle's number and the corner where the side starts.
using GluedSide = std::pair<Index, Index>;

/// Plane triangles, counter-clockwise, glued along pairs of sides, each in opposite directions.
/// Corners that come together become one vertex.
MetricSurface glueTriangles(const std::vector<std::array<std::complex<double>, 3>>& triangles,
                            const std::vector<std::pair<GluedSide, GluedSide>>& gluing);

/// Three unit squares in an L, opposite sides identified: genus 2, one cone of 6 pi.
MetricSurface squareTiledL();
/// Regular 2n-gon, opposite sides identified. 8: y^2 = x^5 - x (Bolza), 10: y^2 = x^5 - 1.
MetricSurface gluedPolygon(int sides);
/// Double cover of the doubled regular hexagon, branched over its corners: y^2 = x^6 - 1.
MetricSurface hexagonCover();
/// Double cover of the regular octahedron, branched over its corners: y^2 = x^5 - x (Bolza).
MetricSurface octahedronCover();
/// Klein's quartic from 56 equilateral triangles, seven around each of its 24 vertices.
MetricSurface kleinQuartic();

/// nx x ny unit cells without `holes` (by column and row), each cut along both diagonals, so that
/// no inner edge joins two boundary vertices.
MetricSurface plate(int nx, int ny, const std::set<std::pair<int, int>>& holes);
/// 2 half x 2 half cells without the central 2 m x 2 m ones: the square frame whose sides have the
/// ratio m / half.
MetricSurface squareFrame(int half, int m);

/// The double of a bordered surface.
MetricSurface doubled(const MetricSurface& bordered);

}  // namespace moduli
