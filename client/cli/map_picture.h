#pragma once

#include <span>
#include <string>

#include "client/cli/picture_options.h"
#include "client/cpp/parameterized_mesh.h"
#include "core/base/status.h"

namespace moduli::cli {

/// What a picture of a map shows.
struct MapPicture {
  std::string name;                        ///< Of the surface, for the heading.
  const ParameterizedMesh* map = nullptr;  ///< With its arrays; not null.
  /// x y z of the surface's vertices in the file's order, which is that of the map's first
  /// vertices. Needed for maps to the sphere, whose own positions are those on the sphere. Empty:
  /// to the plane, the map's positions; to the sphere, the surface is not shown.
  std::span<const double> space;
  bool in_space = true;           ///< False for an intrinsic triangulation: the image alone.
  std::span<const double> field;  ///< One number per vertex, as `space`; or empty.
  std::string field_name = "field";
  PictureDraw draw = PictureDraw::kChecker;
  PictureFormat format = PictureFormat::kPng;
  PictureSize size;
  PictureView view;
};

/// Draws a surface and its image side by side (one above the other where that is larger), with what
/// was mapped and how well in words: the bytes of a file.
///
/// Both bear the same checkerboard (Pattern), or the field by colours. The image also shows the
/// edges, where a face has room for them, boundaries (dark), the circles that they lie on and cuts
/// (orange, also on the surface); folded faces are red. A sphere is shown from the positive and the
/// negative x axis, its third axis up. Pictures that leave less than 64 pixels for each have no
/// words.
///
/// With kDilatation and kScale both bear the colours of numbers (MapHeat), with a colour bar beside
/// them where there is room for words; folded faces are blue. With kLayout islands and seams are
/// told apart by colours (seam_chains.h). A field is shown with kChecker only.
///
/// Of a map to the Poincaré disk, with kChecker, the surface bears its cuts and closed geodesics;
/// the disk shows the image's copies, the axes of generators and the geodesics (disk_tiling.h).
///
/// A torus stands among parts of its copies, paler, with the parallelogram of its generators. Cones
/// are dots, magenta where their curvature is positive, teal where it is not; so are zeros of
/// forms.
///
/// SVG: the image is drawn in outlines, of a sphere what is not hidden; the surface is an embedded
/// raster, of twice the size up to 2048 pixels a side. The image is a raster too where outlines
/// would take too much: colours of numbers or islands on more than 30000 faces, cuts and boundaries
/// of more than 60000 edges; more edges than that are not drawn.
///
/// Vertices that were added to the surface have no `space` and no `field`; they get the mean of
/// their neighbours'. Same input, same bytes. Fails as checkDrawable does, and with kInternal where
/// the drawing library does. O(F log F + pixels).
Result<std::string> drawMap(const MapPicture& picture);

/// Fails with kInvalidOption for what cannot be drawn: numbers of a surface that has no place in
/// space, the layout of a map to the sphere.
Status checkDrawable(const MapPicture& picture);

}  // namespace moduli::cli
