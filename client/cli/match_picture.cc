#include "client/cli/match_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "client/cli/map_pattern.h"
#include "client/cli/output.h"
#include "client/cli/panel_sheet.h"

namespace moduli::cli {
namespace {

constexpr double kCubes = 16;  // Along the longest side.

/// Colours of points in space, over a box.
class SpaceColors {
 public:
  explicit SpaceColors(const std::vector<Vec3>& points) {
    low_.fill(std::numeric_limits<double>::infinity());
    Vec3 high = {-low_[0], -low_[0], -low_[0]};
    for (const Vec3& p : points) {
      for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = std::min(low_[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      size_[axis] = high[axis] - low_[axis];
      longest_ = std::max(longest_, size_[axis]);
    }
  }

  Color at(const Vec3& p) const {
    // Planes of symmetry, which many models have, are in the middle of cubes.
    long long cubes = 0;
    double channel[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double share = size_[axis] > 0 ? (p[axis] - low_[axis]) / size_[axis] : 0.5;
      channel[axis] = 110 + 145 * std::clamp(share, 0.0, 1.0);
      const double middle = low_[axis] + size_[axis] / 2;
      const double place = longest_ > 0 ? (p[axis] - middle) / longest_ * kCubes : 0;
      cubes += static_cast<long long>(std::floor(place + 0.5));
    }
    const double light = cubes % 2 == 0 ? 1 : 0.76;
    const auto byte = [light](double x) { return static_cast<std::uint8_t>(x * light); };
    return {byte(channel[0]), byte(channel[1]), byte(channel[2])};
  }

 private:
  Vec3 low_{}, size_{};
  double longest_ = 0;
};

std::vector<Vec3> placesOf(const TriangleSoup& soup) {
  std::vector<Vec3> places;
  places.reserve(soup.vertices.size());
  for (const Eigen::Vector3d& p : soup.vertices) places.push_back({p.x(), p.y(), p.z()});
  return places;
}

/// Where the vertices of a surface go in space; NaN for those that go nowhere.
std::optional<std::vector<Vec3>> imagesOf(const VertexMap& map, const TriangleSoup& target) {
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> images;
  images.reserve(map.faces.size());
  for (std::size_t v = 0; v < map.faces.size(); ++v) {
    if (map.faces[v] < 0) {
      images.push_back({kNowhere, kNowhere, kNowhere});
      continue;
    }
    if (static_cast<std::size_t>(map.faces[v]) >= target.faces.size()) return std::nullopt;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      p += map.weights[3 * v + c] * target.vertices[target.faces[map.faces[v]][c]];
    }
    images.push_back({p.x(), p.y(), p.z()});
  }
  return images;
}

/// A surface in the colours of the places given for its vertices.
Image drawColored(const TriangleSoup& soup, const std::vector<Vec3>& points,
                  const std::vector<Vec3>& places, const SpaceColors& colors,
                  const RenderOptions& look) {
  Scene scene;
  scene.points = points;
  scene.faces = soup.faces;
  scene.paint = [&](int face, const Vec3& weights) {
    Vec3 place{};
    for (int c = 0; c < 3; ++c) {
      const Vec3& corner = places[soup.faces[face][c]];
      for (int axis = 0; axis < 3; ++axis) place[axis] += weights[c] * corner[axis];
    }
    const bool known =
        std::isfinite(place[0]) && std::isfinite(place[1]) && std::isfinite(place[2]);
    return known ? colors.at(place) : kUnmappedColor;
  };
  return renderScene(scene, look);
}

std::string qualityText(const v1::SurfaceMatch& result) {
  const v1::MatchCertificate& certificate = result.certificate();
  std::string text = "distance " + brief(result.distance());
  if (certificate.has_mean_dilatation()) {
    text += ", mean K " + brief(certificate.mean_dilatation());
  }
  if (certificate.has_flipped_faces()) {
    const int count = certificate.flipped_faces();
    text +=
        count == 0 ? ", no flipped faces" : ", " + counted(count, "flipped face", "flipped faces");
  }
  return text;
}

}  // namespace

Result<std::string> drawMatch(const MatchPicture& picture) {
  const std::optional<std::vector<Vec3>> images = imagesOf(picture.match.map, picture.b);
  if (!images || images->size() != picture.a.vertices.size()) {
    return Status(Reason::kInternal, "the map does not fit the surfaces",
                  "try again; if it stays, update the server or this client");
  }
  const PanelLayout layout = layOutPanels(picture.size, 2);
  const RenderOptions look = surfaceLook(picture.view, layout.width, layout.height);
  const std::vector<Vec3> points_a = placesOf(picture.a), points_b = placesOf(picture.b);
  const SpaceColors colors(points_b);
  const std::string a = safe(picture.name_a), b = safe(picture.name_b);
  std::vector<SheetCell> cells;
  cells.push_back({drawColored(picture.a, points_a, *images, colors, look), a,
                   qualityText(picture.match.result), false});
  std::vector<Vec3> shown_b = points_b;
  if (picture.mirror) {
    for (Vec3& p : shown_b) p[0] = -p[0];
  }
  cells.push_back({drawColored(picture.b, shown_b, points_b, colors, look),
                   b + (picture.mirror ? ", mirrored" : ""), "colours by the place in space",
                   false});
  ASSIGN_OR_RETURN(const Image image,
                   composePanels(a + ", matched to " + b, picture.size, layout, cells));
  return encodePng(image);
}

}  // namespace moduli::cli
