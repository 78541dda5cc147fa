#pragma once

#include <string>

#include "client/cli/picture_options.h"
#include "client/cpp/matched_surfaces.h"
#include "core/base/status.h"
#include "core/mesh/triangle_soup.h"

namespace moduli::cli {

/// What a picture of a match shows.
struct MatchPicture {
  std::string name_a, name_b;  ///< Of the files, for the words.
  const TriangleSoup& a;       ///< As the files number them.
  const TriangleSoup& b;
  const MatchedSurfaces& match;  ///< With its map from a to b.
  PictureSize size;
  PictureView view;
  bool mirror = false;  ///< The map goes to the mirror image of the second: it is drawn so.
};

/// Draws both surfaces side by side: the second in colours by the place in space, under a
/// checkerboard of cubes, the first in those of the points that its own go to. Faces with a corner
/// that goes nowhere are grey. The bytes of a PNG file. Same input, same bytes. Fails with
/// kInternal where the map names faces that are not there, and where the drawing library does. O(V
/// + F + pixels).
Result<std::string> drawMatch(const MatchPicture& picture);

}  // namespace moduli::cli
