#include "client/cli/map_panels.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "client/cli/output.h"

namespace moduli::cli {
namespace {

using Options = v1::ParameterizationOptions;
using Kind = MapEdge::Kind;

constexpr double kLeastFace = 24;  // Square pixels: sides of some 7 pixels.

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// With its article.
std::string placeName(const v1::Parameterization& result) {
  switch (result.target()) {
    case Options::SPHERE:
      return "the sphere";
    case Options::DISK:
      return "the disk";
    case Options::RECTANGLE:
      return "a rectangle";
    case Options::CIRCLE_DOMAIN:
      return result.circles_size() == 2 ? "an annulus" : "a circle domain";
    case Options::HYPERBOLIC:
      return "the Poincaré disk";
    case Options::TORUS:
      return "a flat torus";
    case Options::POLYCUBE:
      return "a PolyCube";
    case Options::ATLAS:
      return "an affine atlas";
    case Options::QUADS:
      return "the unit squares";
    default:
      return "the plane";
  }
}

// "mean K 1.012, no folded faces", as far as it is known.
std::string qualityText(const v1::ParameterizationCertificate& certificate) {
  std::string text;
  if (certificate.has_mean_dilatation()) {
    text = "mean K " + number(certificate.mean_dilatation());
  }
  if (certificate.has_flipped_faces()) {
    if (!text.empty()) text += ", ";
    const int count = certificate.flipped_faces();
    text += count == 0 ? "no flipped faces" : counted(count, "flipped face", "flipped faces");
  }
  return text;
}

// What is drawn on a hyperbolic surface.
std::string tilingText(const v1::Parameterization& result) {
  const v1::HyperbolicDomain& domain = result.hyperbolic();
  std::string text = "cuts";
  if (domain.geodesics_size() > 0) {
    text += "; closed geodesics from length " + number(domain.geodesics(0).length());
  }
  if (domain.boundary_lengths_size() > 0) text += "; boundary geodesic";
  return text;
}

std::string patternText(Options::Target target) {
  switch (target) {
    case Options::SPHERE:
      return "meridians and parallels of the sphere";
    case Options::DISK:
    case Options::CIRCLE_DOMAIN:
      return "radii and circles of the plane";
    default:
      return "squares of the plane";
  }
}

// A horizontal ring of the sphere in the plane that the eye sees as its outline.
std::vector<Segment> outline(const DrawnCircle& circle, bool upright) {
  constexpr int kParts = 360;
  const auto at = [&](int i) -> Vec3 {
    const double angle = 2 * std::numbers::pi * i / kParts;
    const double x = circle.x + circle.radius * std::cos(angle);
    const double y = circle.y + circle.radius * std::sin(angle);
    return upright ? Vec3{0, x, y} : Vec3{x, y, 0};
  };
  std::vector<Segment> segments;
  for (int i = 0; i < kParts; ++i) segments.push_back({at(i), at((i + 1) % kParts)});
  return segments;
}

Segment segmentOf(const MapDrawing& drawing, const MapEdge& edge, bool in_space) {
  const std::vector<Vec3>& points = in_space ? drawing.surface : drawing.points;
  const std::array<int, 2>& ends = in_space ? edge.vertices : edge.points;
  return {points[ends[0]], points[ends[1]]};
}

std::vector<Segment> segmentsOf(const MapDrawing& drawing, Kind kind, bool in_space) {
  std::vector<Segment> segments;
  for (const MapEdge& edge : drawing.edges) {
    if (edge.kind == kind) segments.push_back(segmentOf(drawing, edge, in_space));
  }
  return segments;
}

std::vector<EdgeGroup> seamsInOneColor(const MapDrawing& drawing) {
  EdgeGroup group{kSeamColor, {}};
  for (std::size_t e = 0; e < drawing.edges.size(); ++e) {
    if (drawing.edges[e].kind == Kind::kSeam) group.edges.push_back(static_cast<int>(e));
  }
  return {std::move(group)};
}

}  // namespace

MapPanels::MapPanels(const MapPicture& picture)
    : drawing_(
          makeDrawing(*picture.map, picture.in_space ? picture.space : std::span<const double>())),
      pattern_(drawing_, picture.map->result.target()),
      name_(safe(picture.name)),
      place_(placeName(picture.map->result)),
      target_(picture.map->result.target()),
      view_(picture.view) {
  if (!picture.in_space) drawing_.surface.clear();
  const bool checker = picture.draw == PictureDraw::kChecker;
  if (checker && !picture.field.empty()) {
    field_.emplace(
        extendToVertices(picture.field, 1, picture.map->positions.size() / 3, drawing_.faces));
  }
  for (const int f : drawing_.mapped) image_faces_.push_back(drawing_.corners[f]);
  if (picture.map->result.has_torus() && hasPattern() && picture.draw == PictureDraw::kChecker) {
    torus_.emplace(drawing_, picture.map->result.torus());
    if (torus_->empty()) torus_.reset();
  }
  if (torus_) {
    tiled_points_ = drawing_.points;
    const int first = static_cast<int>(tiled_points_.size());
    tiled_points_.insert(tiled_points_.end(), torus_->points().begin(), torus_->points().end());
    for (const TorusTiling::Piece& piece : torus_->pieces()) {
      image_faces_.push_back(
          {first + piece.corners[0], first + piece.corners[1], first + piece.corners[2]});
    }
  }
  const bool hyperbolic = picture.map->result.has_hyperbolic();
  if (hyperbolic && checker) tiling_.emplace(drawing_, *picture.map);
  if (!drawing_.surface.empty() && picture.draw == PictureDraw::kDilatation) {
    heat_.emplace(MapHeat::ofDilatation(drawing_, hyperbolic));
  }
  if (!drawing_.surface.empty() && picture.draw == PictureDraw::kScale) {
    heat_.emplace(MapHeat::ofScale(drawing_, hyperbolic));
  }
  const bool layout = picture.draw == PictureDraw::kLayout;
  if (layout) islands_ = findIslands(drawing_);
  seams_ = layout ? seamChains(drawing_) : seamsInOneColor(drawing_);
  listCones(picture);
  listPanels(picture);
  listCircles(picture);
}

// An intrinsic triangulation has its vertices once for every point: where they are is not known.
void MapPanels::listCones(const MapPicture& picture) {
  if (!picture.in_space || drawing_.on_sphere) return;
  std::map<int, Color> colors;
  for (const v1::Cone& cone : picture.map->result.cone_metric().cones()) {
    if (cone.curvature() == 0) continue;
    colors[cone.vertex()] = cone.curvature() > 0 ? kConvexColor : kConcaveColor;
  }
  for (const v1::FormZero& zero : picture.map->result.quads().zeros()) {
    colors[zero.vertex()] = zero.index() > 0 ? kConvexColor : kConcaveColor;
  }
  if (colors.empty()) return;
  std::set<int> seen;
  for (const int f : drawing_.mapped) {
    for (int c = 0; c < 3; ++c) {
      const auto found = colors.find(drawing_.faces[f][c]);
      if (found == colors.end() || !seen.insert(drawing_.corners[f][c]).second) continue;
      cones_.push_back({found->first, drawing_.corners[f][c], found->second});
    }
  }
}

std::vector<LineSet> MapPanels::coneDots(bool in_space, double pixel) const {
  std::vector<LineSet> sets = {{{}, kConvexColor, kConeWidth * pixel},
                               {{}, kConcaveColor, kConeWidth * pixel}};
  for (const DrawnCone& cone : cones_) {
    const Vec3& p = in_space ? drawing_.surface[cone.vertex] : drawing_.points[cone.point];
    sets[cone.color == kConvexColor ? 0 : 1].segments.push_back({p, p});
  }
  std::erase_if(sets, [](const LineSet& set) { return set.segments.empty(); });
  return sets;
}

void MapPanels::addCopies(Scene& scene, double pixel) const {
  scene.points = tiled_points_;
  const std::size_t own = drawing_.mapped.size(), first = drawing_.points.size();
  scene.paint = [this, own, first](int face, const Vec3& weights) {
    const auto n = static_cast<std::size_t>(face);
    if (n < own) return colorAt(drawing_.mapped[n], weights);
    Vec3 point{};
    for (int k = 0; k < 3; ++k) {
      const Vec3& corner = tiled_points_[static_cast<std::size_t>(image_faces_[n][k])];
      for (int axis = 0; axis < 2; ++axis) point[axis] += weights[k] * corner[axis];
    }
    const Vec3& shift = torus_->shifts()[static_cast<std::size_t>(torus_->pieces()[n - own].shift)];
    for (int axis = 0; axis < 2; ++axis) point[axis] -= shift[axis];
    return paleColor(pattern_.at(point));
  };
  scene.lines.push_back({torus_->outlines(), kCircleColor, kCircleWidth * pixel});
}

void MapPanels::listPanels(const MapPicture& picture) {
  std::string shown = patternText(target_);
  if (field_) {
    shown =
        safe(picture.field_name) + ", " + number(field_->low()) + " to " + number(field_->high());
  }
  if (heat_) shown = heat_->summary();
  if (!islands_.empty()) shown = layoutText();
  const std::string quality = qualityText(picture.map->result.certificate());
  if (!drawing_.surface.empty()) panels_.push_back({PanelKind::kSurface, "Surface", shown});
  if (drawing_.on_sphere) {
    panels_.push_back({PanelKind::kFront, "Sphere, front",
                       quality.empty() ? "from the positive x axis" : quality});
    panels_.push_back({PanelKind::kBack, "Sphere, back",
                       drawing_.surface.empty() ? shown : "from the negative x axis"});
    return;
  }
  if (tiling_) {
    if (!drawing_.surface.empty()) panels_.front().subtitle = tilingText(picture.map->result);
    panels_.push_back({PanelKind::kDisk, "Poincaré disk, with copies beyond the cuts",
                       quality.empty() ? tilingText(picture.map->result) : quality});
    return;
  }
  std::string title = place_.substr(place_.find(' ') + 1);
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  if (torus_) {
    const v1::Complex& tau = picture.map->result.torus().tau();
    title += " with copies, tau " + number(tau.re()) + (tau.im() < 0 ? " - " : " + ") +
             number(std::abs(tau.im())) + " i";
  }
  if (!cones_.empty()) {
    const int count = picture.map->result.cone_metric().cones_size();
    const int zeros = picture.map->result.quads().zeros_size();
    title += ", " + (target_ == Options::POLYCUBE ? counted(count, "corner", "corners")
                     : target_ == Options::ATLAS
                         ? counted(count, "extraordinary point", "extraordinary points")
                     : target_ == Options::QUADS ? counted(zeros, "zero", "zeros")
                                                 : counted(count, "cone", "cones"));
  }
  if (picture.map->result.has_modulus()) {
    title += ", modulus " + number(picture.map->result.modulus());
  }
  panels_.push_back({PanelKind::kPlane, title, quality.empty() ? shown : quality});
}

void MapPanels::listCircles(const MapPicture& picture) {
  if (target_ == Options::DISK || target_ == Options::HYPERBOLIC) circles_.push_back({});
  if (target_ != Options::CIRCLE_DOMAIN) return;
  for (const v1::Circle& circle : picture.map->result.circles()) {
    const bool drawable = std::isfinite(circle.center().re()) &&
                          std::isfinite(circle.center().im()) && circle.radius() > 0 &&
                          std::isfinite(circle.radius());
    if (drawable) circles_.push_back({circle.center().re(), circle.center().im(), circle.radius()});
  }
}

std::string MapPanels::layoutText() const {
  int islands = 0;
  for (const int island : islands_) islands = std::max(islands, island + 1);
  long long seams = 0;
  for (const EdgeGroup& group : seams_) seams += static_cast<long long>(group.edges.size());
  // Each edge of the surface is drawn once for every side.
  if (seams == 0) return counted(islands, "island", "islands") + ", no seams";
  return counted(islands, "island", "islands") + ", seams along " +
         counted(seams / 2, "edge", "edges") + ", colours tell which belong together";
}

std::vector<LineSet> MapPanels::seamLines(bool in_space, double pixel) const {
  std::vector<LineSet> sets;
  for (const EdgeGroup& group : seams_) {
    LineSet lines{{}, group.color, seamWidth() * pixel};
    for (const int e : group.edges) {
      lines.segments.push_back(segmentOf(drawing_, drawing_.edges[e], in_space));
    }
    sets.push_back(std::move(lines));
  }
  return sets;
}

std::string MapPanels::heading() const {
  return name_ + ", mapped to " + place_;
}

Color MapPanels::colorAt(int face, const Vec3& weights) const {
  if (!field_ && (tiling_ || !drawing_.isMapped(face))) return kUnmappedColor;
  if (drawing_.folded[face]) return foldedColor();
  if (heat_) return heat_->at(face, weights);
  if (!islands_.empty()) return islandColor(islands_[face]);
  if (field_) return field_->at(drawing_.faces[face], weights);
  const CornerIndices& corners = drawing_.corners[face];
  Vec3 point{};
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] += weights[k] * drawing_.points[corners[k]][axis];
    }
  }
  return pattern_.at(point);
}

RenderOptions MapPanels::look(PanelKind kind, int width, int height) const {
  if (kind == PanelKind::kSurface) return surfaceLook(view_, width, height);
  if (kind == PanelKind::kPlane) {
    RenderOptions options = planeView(width, height);
    options.supersampling = samplesFor(width, height);
    return options;
  }
  const PictureView view{{kind == PanelKind::kFront ? 1.0 : -1.0, 0, 0}, {0, 0, 1}};
  return surfaceLook(view, width, height);
}

bool MapPanels::showsEdges(double scale) const {
  const double area = drawing_.on_sphere ? 2 * std::numbers::pi : drawing_.image_area;
  const double shown = static_cast<double>(drawing_.mapped.size()) / (drawing_.on_sphere ? 2 : 1);
  return shown > 0 && area / shown * scale * scale >= kLeastFace;
}

Scene MapPanels::scene(PanelKind kind, const RenderOptions& look, double pixel) const {
  return kind == PanelKind::kSurface ? surfaceScene(pixel) : imageScene(kind, look, pixel);
}

std::vector<Shape> MapPanels::shapes(int width, int height) const {
  if (!tiling_) return {};
  // Area of the plane, not of the disk's metric: edges in its middle are larger than most.
  return tiling_->shapes(width, height, showsEdges(DiskTiling::scale(width, height)));
}

Scene MapPanels::surfaceScene(double pixel) const {
  Scene scene;
  scene.points = drawing_.surface;
  scene.faces = drawing_.faces;
  scene.paint = [this](int face, const Vec3& weights) { return colorAt(face, weights); };
  scene.lines.push_back(
      {segmentsOf(drawing_, Kind::kBoundary, true), kBoundaryColor, kBoundaryWidth * pixel});
  if (tiling_) {
    for (LineSet& lines : tiling_->surfaceLines(pixel)) scene.lines.push_back(std::move(lines));
    return scene;
  }
  for (LineSet& lines : seamLines(true, pixel)) scene.lines.push_back(std::move(lines));
  for (LineSet& lines : coneDots(true, pixel)) scene.lines.push_back(std::move(lines));
  return scene;
}

Scene MapPanels::imageScene(PanelKind kind, const RenderOptions& look, double pixel) const {
  Scene scene;
  scene.points = drawing_.points;
  scene.faces = image_faces_;
  scene.paint = [this](int face, const Vec3& weights) {
    return colorAt(drawing_.mapped[face], weights);
  };
  if (torus_) addCopies(scene, pixel);
  if (kind != PanelKind::kPlane) {
    scene.lines.push_back({outline({}, true), kCircleColor, kCircleWidth * pixel});
  }
  for (const DrawnCircle& circle : circles_) {
    scene.lines.push_back({outline(circle, false), kCircleColor, kCircleWidth * pixel});
  }
  if (showsEdges(Projection(scene, look).scale() / pixel)) {
    scene.lines.push_back(
        {segmentsOf(drawing_, Kind::kInner, false), kEdgeColor, kEdgeWidth * pixel});
  }
  scene.lines.push_back(
      {segmentsOf(drawing_, Kind::kBoundary, false), kBoundaryColor, kBoundaryWidth * pixel});
  for (LineSet& lines : seamLines(false, pixel)) scene.lines.push_back(std::move(lines));
  if (torus_) {
    LineSet cell{{}, kBoundaryColor, kBoundaryWidth * pixel};
    const std::vector<Vec3>& corners = torus_->parallelogram();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      cell.segments.push_back({corners[i], corners[(i + 1) % corners.size()]});
    }
    scene.lines.push_back(std::move(cell));
  }
  for (LineSet& lines : coneDots(false, pixel)) scene.lines.push_back(std::move(lines));
  return scene;
}

SheetPlan planSheet(const MapPanels& map, const PictureSize& size) {
  constexpr int kLegendWidth = 84;
  const int count = static_cast<int>(map.panels().size());
  SheetPlan plan{size, layOutPanels(size, count)};
  if (map.legend() == nullptr || !plan.layout.words || size.width < 4 * kLegendWidth) return plan;
  const PictureSize rest{size.width - kLegendWidth, size.height};
  const PanelLayout beside = layOutPanels(rest, count);
  if (!beside.words) return plan;
  const int rows = (count + beside.columns - 1) / beside.columns;
  return {rest, beside, kLegendWidth - kSheetMargin,
          rows * (beside.height + kSheetWords) - kSheetWords};
}

}  // namespace moduli::cli
