#pragma once

#include <cstdint>
#include <string>

#include "core/base/status.h"
#include "core/picture/vec3.h"

/// What the command line says about pictures.
namespace moduli::cli {

enum class PictureFormat : std::uint8_t { kPng, kSvg };

/// What a picture of a map shows.
enum class PictureDraw : std::uint8_t {
  kChecker,     ///< One pattern on the surface and its image.
  kDilatation,  ///< How far faces are from keeping their angles.
  kScale,       ///< How much longer lengths become.
  kLayout,      ///< Islands and seams, each seam in one colour on both of its sides.
};

/// "checker", "dilatation", "scale" or "layout". Fails with kInvalidOption.
Result<PictureDraw> parsePictureDraw(const std::string& word);

/// Of a file's name, by its extension in any case. Fails with kInvalidOption.
Result<PictureFormat> parsePictureFormat(const std::string& path);

struct PictureSize {
  int width = 1200;
  int height = 480;
};

/// "800x600": pixels, each 16 to 16384. Fails with kInvalidOption.
Result<PictureSize> parsePictureSize(const std::string& text);

/// How a surface in space is looked at. Both directions are not 0 and not parallel.
struct PictureView {
  Vec3 towards_eye = {0.55, 0.4, 1};
  Vec3 up = {0, 1, 0};  ///< As most mesh files mean it.
};

/// "front", "back" (the eye on the positive and the negative z axis), "left", "right" (negative,
/// positive x), "top", "bottom" (positive, negative y), or "x,y,z": the direction towards the eye.
/// y points up in the picture; seen along it, z down from the top and up from the bottom. Fails
/// with kInvalidOption.
Result<PictureView> parsePictureView(const std::string& text);

}  // namespace moduli::cli
