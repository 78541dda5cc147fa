#include "client/cli/map_svg.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/picture/sheet.h"
#include "core/picture/svg.h"

namespace moduli::cli {
namespace {

using namespace vec3;

using Kind = MapEdge::Kind;

constexpr std::size_t kMostFieldFaces = 30000;
constexpr std::size_t kMostEdges = 60000;
constexpr int kLargestRaster = 2048;

struct Place {
  double x, y;
  int width, height;
};

std::size_t countEdges(const MapDrawing& drawing, bool inner) {
  return static_cast<std::size_t>(
      std::count_if(drawing.edges.begin(), drawing.edges.end(),
                    [=](const MapEdge& edge) { return (edge.kind == Kind::kInner) == inner; }));
}

bool needsRaster(const MapPanels& map, PanelKind kind) {
  if (kind == PanelKind::kSurface) return true;
  if (!map.hasPattern() && map.drawing().mapped.size() > kMostFieldFaces) return true;
  return countEdges(map.drawing(), false) > kMostEdges;
}

Status addRaster(Svg& svg, const MapPanels& map, PanelKind kind, const Place& place) {
  const double zoom = std::min(2.0, double(kLargestRaster) / std::max(place.width, place.height));
  const auto zoomed = [zoom](int side) {
    return std::max(1, static_cast<int>(std::lround(zoom * side)));
  };
  const RenderOptions look = map.look(kind, zoomed(place.width), zoomed(place.height));
  ASSIGN_OR_RETURN(const std::string png,
                   encodePng(renderScene(map.scene(kind, look, zoom), look)));
  svg.image(png, place.x, place.y, place.width, place.height);
  return {};
}

/// An image of a map in outlines: of the plane, or what is seen of a sphere.
class ImageOutlines {
 public:
  ImageOutlines(Svg& svg, const MapPanels& map, PanelKind kind, const Place& place)
      : svg_(svg),
        map_(map),
        drawing_(map.drawing()),
        place_(place),
        front_(kind == PanelKind::kFront),
        look_(map.look(kind, place.width, place.height)),
        projection_(map.scene(kind, look_, 1), look_) {}

  void draw() {
    if (!projection_.valid()) return;
    if (map_.torus() != nullptr) addCopies(*map_.torus());
    if (map_.hasPattern()) {
      addPattern();
    } else {
      addFaces(false);
    }
    addFaces(true);
    if (drawing_.on_sphere) addBall();
    for (const DrawnCircle& circle : map_.circles()) {
      const Vec3 center = projected({circle.x, circle.y, 0});
      svg_.circle(center[0], center[1], circle.radius * projection_.scale(), circleStyle());
    }
    addEdges();
    if (map_.torus() != nullptr) {
      svg_.path(pathOf(map_.torus()->parallelogram()),
                {.stroke = kBoundaryColor, .stroke_width = kBoundaryWidth});
    }
    for (const MapPanels::DrawnCone& cone : map_.cones()) {
      const Vec3 place = projected(drawing_.points[cone.point]);
      svg_.circle(place[0], place[1], kConeWidth / 2, {.fill = cone.color});
    }
  }

 private:
  static SvgStyle circleStyle() { return {.stroke = kCircleColor, .stroke_width = kCircleWidth}; }

  Vec3 projected(const Vec3& point) const {
    return Vec3{place_.x, place_.y, 0} + projection_(point);
  }
  // Above 0 on the side of the sphere that is seen.
  double height(const Vec3& point) const { return front_ ? point[0] : -point[0]; }

  SvgPath pathOf(const std::vector<Vec3>& outline) const {
    SvgPath path;
    addTo(path, outline);
    return path;
  }
  void addTo(SvgPath& path, const std::vector<Vec3>& outline) const {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec3 p = projected(outline[i]);
      i == 0 ? path.moveTo(p[0], p[1]) : path.lineTo(p[0], p[1]);
    }
    if (!outline.empty()) path.close();
  }

  void addPattern() {
    if (drawing_.on_sphere) {
      const Vec3 center = projected({});
      svg_.circle(center[0], center[1], projection_.scale(), {.fill = kPatternLight});
      for (const Pattern::Cell& cell : map_.pattern().darkCells()) {
        svg_.path(pathOf(visiblePart(cell.outline)), {.fill = cell.color});
      }
      return;
    }
    const SvgPath region = imageRegion();
    if (region.empty()) return;
    svg_.beginClip(region);
    svg_.path(region, {.fill = kPatternLight});
    for (const Pattern::Cell& cell : map_.pattern().darkCells()) {
      svg_.path(pathOf(cell.outline), {.fill = cell.color});
    }
    svg_.endClip();
  }

  // Within the window: the pattern as the image has it, moved, and the outline of each copy.
  void addCopies(const TorusTiling& torus) {
    const auto& [low, high] = torus.window();
    svg_.beginClip(pathOf({low, {high[0], low[1], 0}, high, {low[0], high[1], 0}}));
    const std::vector<Pattern::Cell> cells = map_.pattern().darkCells();
    for (const Vec3& shift : torus.shifts()) {
      const SvgPath region = imageRegion(shift);
      if (region.empty()) continue;
      svg_.beginClip(region);
      svg_.path(region, {.fill = paleColor(kPatternLight)});
      for (const Pattern::Cell& cell : cells) {
        std::vector<Vec3> outline = cell.outline;
        for (Vec3& point : outline) point = point + shift;
        svg_.path(pathOf(outline), {.fill = paleColor(cell.color)});
      }
      svg_.endClip();
      svg_.path(region, {.stroke = kCircleColor, .stroke_width = kCircleWidth});
    }
    svg_.endClip();
  }

  // What the faces cover: loops of the edges that have a face on one side. They balance at every
  // point, so that a walk along them ends where it began.
  SvgPath imageRegion(const Vec3& shift = {}) const {
    std::unordered_map<int, std::vector<int>> next;
    std::vector<int> starts;
    for (const MapEdge& edge : drawing_.edges) {
      if (edge.kind == Kind::kInner) continue;
      next[edge.points[0]].push_back(edge.points[1]);
      starts.push_back(edge.points[0]);
    }
    SvgPath path;
    for (const int start : starts) {
      std::vector<Vec3> loop;
      for (int at = start; !next[at].empty();) {
        loop.push_back(drawing_.points[at] + shift);
        const int to = next[at].back();
        next[at].pop_back();
        at = to;
      }
      addTo(path, loop);
    }
    return path;
  }

  // The part of a polygon on the sphere that lies on the side that is seen, closed along the rim.
  std::vector<Vec3> visiblePart(const std::vector<Vec3>& outline) const {
    std::vector<Vec3> part;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec3& a = outline[i];
      const Vec3& b = outline[(i + 1) % outline.size()];
      const double ha = height(a), hb = height(b);
      if (ha >= 0) part.push_back(a);
      if ((ha >= 0) == (hb >= 0)) continue;
      const Vec3 rim = normalized((ha / (ha - hb)) * (b - a) + a);
      // Back on the rim: along it from where the outline left.
      if (ha < 0 && !part.empty()) addArc(part, rim);
      part.push_back(rim);
    }
    // Where the outline began behind the sphere, the gap is between the last and the first point.
    if (!part.empty() && height(outline.front()) < 0) addArc(part, Vec3(part.front()));
    return part;
  }

  static void addArc(std::vector<Vec3>& part, const Vec3& to) {
    constexpr int kParts = 8;
    const Vec3 from = part.back();
    for (int k = 1; k < kParts; ++k) {
      part.push_back(normalized((1 - double(k) / kParts) * from + (double(k) / kParts) * to));
    }
  }

  bool seen(const CornerIndices& corners) const {
    if (!drawing_.on_sphere) return true;
    const Vec3 sum =
        drawing_.points[corners[0]] + drawing_.points[corners[1]] + drawing_.points[corners[2]];
    return height(sum) > 0;
  }

  // Those that are folded, or the others, in the colour of their middle.
  void addFaces(bool folded) {
    SvgPath folds;
    for (const int f : drawing_.mapped) {
      const CornerIndices& c = drawing_.corners[f];
      if (drawing_.folded[f] != folded || !seen(c)) continue;
      const std::vector<Vec3> outline = {drawing_.points[c[0]], drawing_.points[c[1]],
                                         drawing_.points[c[2]]};
      if (folded) {
        addTo(folds, outline);
        continue;
      }
      const Color color = map_.colorAt(f, {1.0 / 3, 1.0 / 3, 1.0 / 3});
      // A hairline closes the cracks that anti-aliasing leaves between neighbours.
      svg_.path(pathOf(outline), {.fill = color, .stroke = color, .stroke_width = 0.4});
    }
    const Color color = map_.foldedColor();
    svg_.path(folds, {.fill = color, .stroke = color, .stroke_width = 0.4});
  }

  void addBall() {
    const Vec3 center = projected({});
    svg_.shadeBall(center[0], center[1], projection_.scale());
    svg_.circle(center[0], center[1], projection_.scale(), circleStyle());
  }

  void addEdges() {
    const bool inner =
        map_.showsEdges(projection_.scale()) && countEdges(drawing_, true) <= kMostEdges;
    if (inner) addEdges(Kind::kInner, {.stroke = kEdgeColor, .stroke_width = kEdgeWidth});
    addEdges(Kind::kBoundary, {.stroke = kBoundaryColor, .stroke_width = kBoundaryWidth});
    for (const EdgeGroup& group : map_.seams()) {
      SvgPath path;
      for (const int e : group.edges) addTo(path, drawing_.edges[e]);
      svg_.path(path, {.stroke = group.color, .stroke_width = map_.seamWidth()});
    }
  }

  void addEdges(Kind kind, const SvgStyle& style) {
    SvgPath path;
    for (const MapEdge& edge : drawing_.edges) {
      if (edge.kind == kind) addTo(path, edge);
    }
    svg_.path(path, style);
  }

  void addTo(SvgPath& path, const MapEdge& edge) const {
    const Vec3& a = drawing_.points[edge.points[0]];
    const Vec3& b = drawing_.points[edge.points[1]];
    if (drawing_.on_sphere && height(a + b) <= 0) return;
    const Vec3 p = projected(a), q = projected(b);
    path.moveTo(p[0], p[1]).lineTo(q[0], q[1]);
  }

  Svg& svg_;
  const MapPanels& map_;
  const MapDrawing& drawing_;
  Place place_;
  bool front_;
  RenderOptions look_;
  Projection projection_;
};

}  // namespace

Result<std::string> drawMapSvg(const MapPanels& map, const PictureSize& size) {
  const std::vector<Panel>& panels = map.panels();
  const SheetPlan plan = planSheet(map, size);
  const PanelLayout& layout = plan.layout;
  const int margin = layout.words ? kSheetMargin : 0;
  const int words = layout.words ? kSheetWords : 0;
  const Color dark = {26, 26, 26}, grey = {102, 102, 102};
  Svg svg(size.width, size.height);
  if (layout.words)
    svg.text(map.heading(), margin, 29, 18, dark, true, plan.panels.width - 2 * margin);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const int column = static_cast<int>(i) % layout.columns;
    const int row = static_cast<int>(i) / layout.columns;
    const Place place = {double(margin + column * (layout.width + margin)),
                         double((layout.words ? kSheetHeading : 0) + row * (layout.height + words)),
                         layout.width, layout.height};
    if (panels[i].kind == PanelKind::kDisk) {
      addShapes(svg, map.shapes(place.width, place.height), place.x, place.y);
    } else if (needsRaster(map, panels[i].kind)) {
      RETURN_IF_ERROR(addRaster(svg, map, panels[i].kind, place));
    } else {
      ImageOutlines(svg, map, panels[i].kind, place).draw();
    }
    if (!layout.words) continue;
    const double below = place.y + place.height;
    svg.text(panels[i].title, place.x, below + 17, 13, dark, true, place.width);
    svg.text(panels[i].subtitle, place.x, below + 34, 12, grey, false, place.width);
  }
  if (plan.legend_width > 0) {
    const LegendDrawing legend = makeLegend(*map.legend(), plan.legend_width, plan.legend_height);
    addShapes(svg, legend.shapes, plan.panels.width, kSheetHeading, legend.words);
  }
  return std::move(svg).finish();
}

}  // namespace moduli::cli
