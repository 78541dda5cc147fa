#include "client/cli/picture_options.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/base/text.h"

namespace moduli::cli {
namespace {

constexpr int kLeastSide = 16;
constexpr int kLargestSide = 16384;

std::optional<int> parseSide(std::string_view text) {
  const std::optional<long long> side = parseInteger(text);
  if (!side || *side < kLeastSide || *side > kLargestSide) return std::nullopt;
  return static_cast<int>(*side);
}

// Three finite numbers between commas, not all 0; scaled so that the largest is 1.
std::optional<Vec3> parseDirection(std::string_view text) {
  Vec3 direction{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (axis == 2)) return std::nullopt;
    const std::optional<double> number = parseDouble(text.substr(0, comma));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    direction[axis] = *number;
    if (axis < 2) text.remove_prefix(comma + 1);
  }
  const double largest =
      std::max({std::abs(direction[0]), std::abs(direction[1]), std::abs(direction[2])});
  if (largest == 0) return std::nullopt;
  for (double& x : direction) x /= largest;
  return direction;
}

// Where y is seen along, or nearly so, another axis has to point up.
Vec3 upOf(const Vec3& eye) {
  const bool along_y = std::hypot(eye[0], eye[2]) < 1e-6 * std::abs(eye[1]);
  if (!along_y) return {0, 1, 0};
  return {0, 0, eye[1] > 0 ? -1.0 : 1.0};
}

}  // namespace

Result<PictureDraw> parsePictureDraw(const std::string& word) {
  static constexpr std::array<std::string_view, 4> kNames = {"checker", "dilatation", "scale",
                                                             "layout"};
  const auto found = std::find(kNames.begin(), kNames.end(), word);
  if (found != kNames.end()) return static_cast<PictureDraw>(found - kNames.begin());
  return Status(Reason::kInvalidOption,
                "'" + word + "' is nothing to draw: it is checker, dilatation, scale or layout");
}

Result<PictureFormat> parsePictureFormat(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  std::string extension = dot == std::string::npos ? "" : path.substr(dot);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".png") return PictureFormat::kPng;
  if (extension == ".svg") return PictureFormat::kSvg;
  return Status(
      Reason::kInvalidOption,
      "a picture is written as PNG or SVG: its file must end in .png or .svg, not '" + path + "'");
}

Result<PictureSize> parsePictureSize(const std::string& text) {
  const std::size_t cross = text.find('x');
  if (cross != std::string::npos) {
    const std::optional<int> width = parseSide(std::string_view(text).substr(0, cross));
    const std::optional<int> height = parseSide(std::string_view(text).substr(cross + 1));
    if (width && height) return PictureSize{*width, *height};
  }
  return Status(Reason::kInvalidOption,
                "'" + text + "' is no size of a picture: it is WIDTHxHEIGHT in pixels, each from " +
                    std::to_string(kLeastSide) + " to " + std::to_string(kLargestSide),
                "for example 1200x480");
}

Result<PictureView> parsePictureView(const std::string& text) {
  struct Named {
    std::string_view name;
    Vec3 towards_eye;
  };
  static constexpr std::array<Named, 6> kNamed = {{{"front", {0, 0, 1}},
                                                   {"back", {0, 0, -1}},
                                                   {"left", {-1, 0, 0}},
                                                   {"right", {1, 0, 0}},
                                                   {"top", {0, 1, 0}},
                                                   {"bottom", {0, -1, 0}}}};
  for (const Named& named : kNamed) {
    if (text == named.name) return PictureView{named.towards_eye, upOf(named.towards_eye)};
  }
  if (const std::optional<Vec3> eye = parseDirection(text)) return PictureView{*eye, upOf(*eye)};
  return Status(Reason::kInvalidOption,
                "'" + text +
                    "' is no view: it is front, back, left, right, top, bottom, or x,y,z, the "
                    "direction towards the eye",
                "for example 1,0.5,2");
}

}  // namespace moduli::cli
