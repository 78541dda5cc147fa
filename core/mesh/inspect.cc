#include "core/mesh/inspect.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/mesh/defect_text.h"
#include "core/mesh/equal_vertices.h"
#include "core/mesh/inspect_soup.h"
#include "core/mesh/triangle_geometry.h"

namespace moduli {
namespace {

constexpr std::size_t kMostElements = 100;

// Collects what is wrong in one way; elements must come in ascending order.
class Finder {
 public:
  explicit Finder(DefectKind kind) : defect_{kind, 0, {}, {}} {}

  void add(Index element) {
    ++defect_.count;
    if (defect_.elements.size() < kMostElements) defect_.elements.push_back(element);
  }

  void addAll(std::vector<Index> elements) {
    std::sort(elements.begin(), elements.end());
    for (const Index element : elements) add(element);
  }

  void reportTo(std::vector<Defect>& defects) {
    if (defect_.count == 0) return;
    defect_.message = sentenceOf(defect_);
    defects.push_back(std::move(defect_));
  }

 private:
  Defect defect_;
};

class Inspector {
 public:
  Inspector(const TriangleSoup& soup, const SoupStructure& structure)
      : soup_(soup), structure_(structure) {}

  Result<Inspection> run(Context& context) {
    RETURN_IF_ERROR(context.check());
    findBadCoordinates();
    findBadFaces();
    RETURN_IF_ERROR(context.check());
    findBadEdges();
    findOneSidedSheets();
    RETURN_IF_ERROR(context.check());
    findVertexDefects();
    RETURN_IF_ERROR(context.check());
    measureFaces();
    countSurface();
    return finish();
  }

 private:
  void findBadCoordinates() {
    finite_.resize(soup_.vertices.size());
    Finder finder(DefectKind::kNonFiniteCoordinate);
    for (std::size_t v = 0; v < soup_.vertices.size(); ++v) {
      finite_[v] = soup_.vertices[v].allFinite();
      if (!finite_[v]) finder.add(static_cast<Index>(v));
    }
    finder.reportTo(defects_);
  }

  void findBadFaces() {
    if (soup_.faces.empty()) {
      Defect empty{DefectKind::kEmpty, 1, {}, {}};
      empty.message = sentenceOf(empty);
      defects_.push_back(std::move(empty));
    }
    const std::vector<bool> duplicate = findDuplicateFaces(soup_.faces, structure_);
    Finder degenerate(DefectKind::kDegenerateFace);
    Finder repeated(DefectKind::kDuplicateFace);
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      if (repeatsVertex(soup_.faces[f])) degenerate.add(static_cast<Index>(f));
      if (duplicate[f]) repeated.add(static_cast<Index>(f));
    }
    degenerate.reportTo(defects_);
    repeated.reportTo(defects_);
  }

  void findBadEdges() {
    std::vector<Index> crowded;
    std::vector<Index> clashing;
    for (std::size_t k = 0; k < structure_.edges.count(); ++k) {
      const auto group = structure_.edges.group(k);
      if (group.size() > 2) crowded.push_back(group[0] / 3);
      if (group.size() == 2 && tail(group[0]) == tail(group[1])) clashing.push_back(group[0] / 3);
    }
    has_crowded_edge_ = !crowded.empty();
    Finder crowded_finder(DefectKind::kNonManifoldEdge);
    crowded_finder.addAll(std::move(crowded));
    crowded_finder.reportTo(defects_);
    Finder clash_finder(DefectKind::kInconsistentOrientation);
    clash_finder.addAll(std::move(clashing));
    clash_finder.reportTo(defects_);
  }

  // Sheets are numbered by their lowest face.
  void findOneSidedSheets() {
    Finder finder(DefectKind::kNonOrientable);
    Index sheets_seen = 0;
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      if (structure_.sheet[f] != sheets_seen) continue;
      if (structure_.one_sided[sheets_seen]) finder.add(static_cast<Index>(f));
      ++sheets_seen;
    }
    finder.reportTo(defects_);
  }

  void findVertexDefects() {
    std::vector<Index> fans(soup_.vertices.size(), 0);
    std::vector<bool> used(soup_.vertices.size(), false);
    Index fans_seen = 0;
    for (Index k = 0; k < static_cast<Index>(structure_.fan.size()); ++k) {
      used[tail(k)] = true;
      if (structure_.fan[k] != fans_seen) continue;
      ++fans_seen;
      ++fans[tail(k)];
    }
    const std::vector<Index> lowest = lowestEqualVertices(soup_.vertices);
    Finder pinched(DefectKind::kNonManifoldVertex);
    Finder isolated(DefectKind::kIsolatedVertex);
    Finder repeated(DefectKind::kDuplicateVertex);
    for (Index v = 0; v < static_cast<Index>(fans.size()); ++v) {
      if (fans[v] > 1) pinched.add(v);
      if (!used[v]) isolated.add(v);
      if (lowest[v] != v) repeated.add(v);
    }
    pinched.reportTo(defects_);
    isolated.reportTo(defects_);
    repeated.reportTo(defects_);
  }

  void measureFaces() {
    Finder finder(DefectKind::kZeroAreaFace);
    for (std::size_t f = 0; f < soup_.faces.size(); ++f) {
      const Triangle& face = soup_.faces[f];
      if (!finite_[face[0]] || !finite_[face[1]] || !finite_[face[2]]) continue;
      const TriangleShape shape =
          triangleShape(soup_.vertices[face[0]], soup_.vertices[face[1]], soup_.vertices[face[2]]);
      counts_.area += shape.area;
      if (shape.relative_area < kZeroRelativeArea && !repeatsVertex(face)) {
        finder.add(static_cast<Index>(f));
      }
    }
    counts_.area = std::min(counts_.area, std::numeric_limits<double>::max());
    finder.reportTo(defects_);
  }

  void countSurface() {
    counts_.vertices = static_cast<Index>(soup_.vertices.size());
    counts_.faces = static_cast<Index>(soup_.faces.size());
    counts_.components = structure_.components;
    counts_.orientable = std::find(structure_.one_sided.begin(), structure_.one_sided.end(),
                                   true) == structure_.one_sided.end();
    Index genus = 0;
    Finder finder(DefectKind::kMultipleComponents);
    for (const ComponentCounts& component : countComponents(structure_)) {
      counts_.boundary_loops += component.boundary_loops;
      counts_.euler_characteristic += component.eulerCharacteristic();
      genus += component.genus();
      if (structure_.components > 1) finder.add(component.first_face);
    }
    if (counts_.orientable && !has_crowded_edge_) counts_.genus = genus;
    finder.reportTo(defects_);
  }

  Inspection finish() {
    std::sort(defects_.begin(), defects_.end(),
              [](const Defect& a, const Defect& b) { return a.kind < b.kind; });
    const bool valid = std::none_of(defects_.begin(), defects_.end(),
                                    [](const Defect& d) { return isBlocking(d.kind); });
    return {valid, counts_, std::move(defects_)};
  }

  Index tail(Index h) const { return soup_.faces[h / 3][h % 3]; }

  const TriangleSoup& soup_;
  const SoupStructure& structure_;
  std::vector<bool> finite_;
  bool has_crowded_edge_ = false;
  SurfaceCounts counts_;
  std::vector<Defect> defects_;
};

Reason reasonOf(DefectKind kind) {
  return reasonFromName(defectName(kind));
}

}  // namespace

std::string_view defectName(DefectKind kind) {
  switch (kind) {
    case DefectKind::kEmpty:
      return "EMPTY";
    case DefectKind::kNonFiniteCoordinate:
      return "NON_FINITE_COORDINATE";
    case DefectKind::kDegenerateFace:
      return "DEGENERATE_FACE";
    case DefectKind::kDuplicateFace:
      return "DUPLICATE_FACE";
    case DefectKind::kNonManifoldEdge:
      return "NON_MANIFOLD_EDGE";
    case DefectKind::kNonOrientable:
      return "NON_ORIENTABLE";
    case DefectKind::kInconsistentOrientation:
      return "INCONSISTENT_ORIENTATION";
    case DefectKind::kNonManifoldVertex:
      return "NON_MANIFOLD_VERTEX";
    case DefectKind::kIsolatedVertex:
      return "ISOLATED_VERTEX";
    case DefectKind::kDuplicateVertex:
      return "DUPLICATE_VERTEX";
    case DefectKind::kZeroAreaFace:
      return "ZERO_AREA_FACE";
    case DefectKind::kMultipleComponents:
      return "MULTIPLE_COMPONENTS";
  }
  return "";
}

bool isBlocking(DefectKind kind) {
  return kind < DefectKind::kIsolatedVertex;
}

std::vector<bool> findDuplicateFaces(const std::vector<Triangle>& faces,
                                     const SoupStructure& structure) {
  std::vector<bool> duplicate(faces.size(), false);
  const auto third = [&](Index h) { return faces[h / 3][(h % 3 + 2) % 3]; };
  std::vector<std::pair<Index, Index>> opposite;  // The third vertex at an edge, and its face.
  for (std::size_t k = 0; k < structure.edges.count(); ++k) {
    const auto group = structure.edges.group(k);
    if (group.size() < 2) continue;
    if (group.size() == 2) {
      if (third(group[0]) == third(group[1])) duplicate[group[1] / 3] = true;
      continue;
    }
    opposite.clear();
    for (const Index h : group) opposite.emplace_back(third(h), h / 3);
    std::sort(opposite.begin(), opposite.end());
    for (std::size_t i = 1; i < opposite.size(); ++i) {
      if (opposite[i].first == opposite[i - 1].first) duplicate[opposite[i].second] = true;
    }
  }
  return duplicate;
}

Result<Inspection> inspectStructure(Context& context, const TriangleSoup& soup,
                                    const SoupStructure& structure) {
  return Inspector(soup, structure).run(context);
}

Result<Inspection> inspectSoup(Context& context, const TriangleSoup& soup) {
  const SoupStructure structure = analyseSoup(static_cast<Index>(soup.vertices.size()), soup.faces);
  return inspectStructure(context, soup, structure);
}

Status blockingError(const Inspection& inspection) {
  for (const Defect& defect : inspection.defects) {
    if (!isBlocking(defect.kind)) continue;
    return {reasonOf(defect.kind), findingOf(defect), remedyOf(defect)};
  }
  return {};
}

}  // namespace moduli
