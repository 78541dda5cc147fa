#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cli/disk_tiling.h"
#include "client/cli/map_drawing.h"
#include "client/cli/map_heat.h"
#include "client/cli/map_pattern.h"
#include "client/cli/map_picture.h"
#include "client/cli/panel_sheet.h"
#include "client/cli/seam_chains.h"
#include "client/cli/torus_tiling.h"
#include "core/picture/render.h"

/// The parts of a map's picture, whatever file they go to.
namespace moduli::cli {

inline constexpr Color kEdgeColor = {72, 80, 94};
inline constexpr Color kBoundaryColor = {34, 40, 52};
inline constexpr Color kCircleColor = {150, 158, 170};
inline constexpr Color kSeamColor = {217, 115, 26};
inline constexpr double kEdgeWidth = 0.5, kBoundaryWidth = 1.4, kCircleWidth = 1.2,
                        kSeamWidth = 1.6;

enum class PanelKind : std::uint8_t {
  kSurface,
  kPlane,
  kDisk,   ///< The Poincaré disk, in outlines: see shapes().
  kFront,  ///< The sphere from the positive first axis, the third one up.
  kBack,   ///< From the negative one.
};

struct Panel {
  PanelKind kind = PanelKind::kSurface;
  std::string title, subtitle;
};

/// Cones of positive and of negative curvature; zeros of forms by the sign of their index.
inline constexpr Color kConvexColor = {168, 28, 116}, kConcaveColor = {0, 122, 140};
inline constexpr double kConeWidth = 8;

struct DrawnCircle {
  double x = 0, y = 0, radius = 1;
};

/// A map ready to be drawn.
class MapPanels {
 public:
  explicit MapPanels(const MapPicture& picture);

  const MapDrawing& drawing() const { return drawing_; }
  const std::vector<Panel>& panels() const { return panels_; }
  /// "NAME, mapped to the sphere".
  std::string heading() const;

  const Pattern& pattern() const { return pattern_; }
  /// False where faces have colours of their own instead of the pattern.
  bool hasPattern() const { return !field_ && !heat_ && islands_.empty(); }
  /// Of the colours, where they need one.
  const Legend* legend() const { return heat_ ? &heat_->legend() : nullptr; }
  /// Seams by their colours.
  const std::vector<EdgeGroup>& seams() const { return seams_; }
  /// Wider where they are what is shown.
  double seamWidth() const { return islands_.empty() ? kSeamWidth : 2.2; }
  Color foldedColor() const { return heat_ ? kFoldedInHeat : kFoldedColor; }
  /// Copies around a torus; null where none are shown.
  const TorusTiling* torus() const { return torus_ ? &*torus_ : nullptr; }
  /// The images of cones and zeros, one for every corner of the image there.
  struct DrawnCone {
    int vertex = 0, point = 0;
    Color color;
  };
  const std::vector<DrawnCone>& cones() const { return cones_; }
  /// The colour of a point of a face.
  Color colorAt(int face, const Vec3& weights) const;

  /// How a panel is seen.
  RenderOptions look(PanelKind kind, int width, int height) const;
  /// What is seen there. Valid while this object is. Lines that would be hidden are among the
  /// scene's. pixel: what counts as one for the width of lines, in pixels of the picture.
  Scene scene(PanelKind kind, const RenderOptions& look, double pixel) const;

  /// What is seen in a panel kDisk.
  std::vector<Shape> shapes(int width, int height) const;

  /// True where edges leave room between them at this scale (pixels per unit of length).
  bool showsEdges(double scale) const;
  /// The circles of the boundary, of the plane.
  const std::vector<DrawnCircle>& circles() const { return circles_; }

 private:
  void listPanels(const MapPicture& picture);
  void listCircles(const MapPicture& picture);
  void listCones(const MapPicture& picture);
  void addCopies(Scene& scene, double pixel) const;
  std::vector<LineSet> coneDots(bool in_space, double pixel) const;
  std::string layoutText() const;
  std::vector<LineSet> seamLines(bool in_space, double pixel) const;
  Scene imageScene(PanelKind kind, const RenderOptions& look, double pixel) const;
  Scene surfaceScene(double pixel) const;

  MapDrawing drawing_;
  Pattern pattern_;
  std::optional<FieldColors> field_;
  std::optional<MapHeat> heat_;
  std::vector<int> islands_;  ///< Per face, where islands are shown.
  std::vector<EdgeGroup> seams_;
  std::optional<DiskTiling> tiling_;  ///< Of a map to the Poincaré disk.
  std::optional<TorusTiling> torus_;
  /// The corners of `mapped`; with the pieces of copies behind them, whose points follow the
  /// image's.
  std::vector<CornerIndices> image_faces_;
  std::vector<Vec3> tiled_points_;
  std::vector<DrawnCone> cones_;
  std::vector<Panel> panels_;
  std::vector<DrawnCircle> circles_;
  std::string name_, place_;
  v1::ParameterizationOptions::Target target_;
  PictureView view_;
};

/// Where the parts of a map's picture go: panels at the left, a legend at the right of them.
struct SheetPlan {
  PictureSize panels;  ///< What is left for them.
  PanelLayout layout;
  int legend_width = 0, legend_height = 0;  ///< 0: there is none. It begins below the heading.
};

/// A legend is left out where there are no words, and where it would take a quarter of the width.
SheetPlan planSheet(const MapPanels& map, const PictureSize& size);

}  // namespace moduli::cli
