#pragma once

#include "client/cli/map_panels.h"
#include "client/cli/map_picture.h"
#include "core/picture/render.h"

/// Pictures of maps for tests to look at.
namespace moduli::cli {

inline MapPicture pictureOf(const ParameterizedMesh& map) {
  MapPicture picture;
  picture.name = "a<mesh>&\x01.obj";
  picture.map = &map;
  picture.space = map.positions;
  picture.size = {300, 200};
  return picture;
}

// A panel of a picture, to be asked what it shows at a point of its scene.
class Shown {
 public:
  Shown(const MapPanels& map, PanelKind kind)
      : look_(map.look(kind, 400, 400)),
        scene_(map.scene(kind, look_, 1)),
        projection_(scene_, look_),
        image_(renderScene(scene_, look_)) {}

  Color at(const Vec3& point) const {
    const Vec3 place = projection_(point);
    return image_.at(static_cast<int>(place[0]), static_cast<int>(place[1]));
  }

 private:
  RenderOptions look_;
  Scene scene_;
  Projection projection_;
  Image image_;
};

}  // namespace moduli::cli
