#include "core/mesh/prepare.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/mesh/defect_text.h"
#include "core/mesh/inspect_soup.h"
#include "core/mesh/soup_structure.h"

namespace moduli {
namespace {

constexpr std::size_t kMostListed = 10;

// Repair renumbers; people know the numbers of their file.
void speakOfInput(const Repaired& repaired, Defect& defect) {
  const bool of_vertices = defect.kind == DefectKind::kNonFiniteCoordinate ||
                           defect.kind == DefectKind::kNonManifoldVertex ||
                           defect.kind == DefectKind::kIsolatedVertex ||
                           defect.kind == DefectKind::kDuplicateVertex;
  const std::vector<Index>& input = of_vertices ? repaired.input_vertex : repaired.input_face;
  for (Index& element : defect.elements) element = input[element];
  std::erase(defect.elements, kNone);
  defect.message = sentenceOf(defect);
}

std::string describe(Index number, const ComponentCounts& counts) {
  return std::to_string(number) + " (" + std::to_string(counts.faces) + " faces, genus " +
         std::to_string(counts.genus()) + ", " + std::to_string(counts.boundary_loops) +
         (counts.boundary_loops == 1 ? " boundary loop)" : " boundary loops)");
}

std::string listComponents(const std::vector<ComponentCounts>& components) {
  std::string text;
  for (std::size_t c = 0; c < std::min(components.size(), kMostListed); ++c) {
    text += (c == 0 ? "" : ", ") + describe(static_cast<Index>(c), components[c]);
  }
  if (components.size() > kMostListed) {
    text += " and " + std::to_string(components.size() - kMostListed) + " more";
  }
  return text;
}

// kNone for all of them.
Result<Index> chooseComponent(const std::vector<ComponentCounts>& components,
                              const std::string& choice) {
  const auto count = static_cast<Index>(components.size());
  if (choice == "all") return kNone;
  if (choice.empty()) {
    if (count == 1) return Index{0};
    return Status(
        Reason::kMultipleComponents,
        "the surface has " + std::to_string(count) + " components: " + listComponents(components),
        "choose one by --component largest or --component N; --to flat also takes --component all");
  }
  if (choice == "largest") {
    const auto largest = std::max_element(
        components.begin(), components.end(),
        [](const ComponentCounts& a, const ComponentCounts& b) { return a.faces < b.faces; });
    return static_cast<Index>(largest - components.begin());
  }
  const std::optional<long long> number = parseInteger(choice);
  if (!number) {
    return Status(Reason::kInvalidOption, "'" + choice + "' is no choice of a component",
                  "give \"largest\" or a number from 0");
  }
  if (*number < 0 || *number >= count) {
    return Status(Reason::kComponentNotFound,
                  "there is no component " + choice + ": the surface has " + std::to_string(count) +
                      ", " + listComponents(components),
                  "they are counted from 0");
  }
  return static_cast<Index>(*number);
}

// The faces of one component (kNone: of all) and their vertices, both in their old order.
Result<PreparedMesh> extract(Repaired repaired, const SoupStructure& structure, Index chosen) {
  std::vector<Index> number(repaired.soup.vertices.size(), kNone);
  TriangleSoup soup;
  std::vector<Index> input_face;
  for (std::size_t f = 0; f < repaired.soup.faces.size(); ++f) {
    if (chosen != kNone && structure.component[f] != chosen) continue;
    soup.faces.push_back(repaired.soup.faces[f]);
    input_face.push_back(repaired.input_face[f]);
    for (const Index v : repaired.soup.faces[f]) number[v] = 0;
  }
  std::vector<Index> input_vertex;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = static_cast<Index>(input_vertex.size());
    input_vertex.push_back(repaired.input_vertex[v]);
    soup.vertices.push_back(repaired.soup.vertices[v]);
  }
  for (Triangle& face : soup.faces) {
    for (Index& v : face) v = number[v];
  }
  ASSIGN_OR_RETURN(TriangleMesh mesh, TriangleMesh::fromSoup(std::move(soup)));
  return PreparedMesh{std::move(mesh),
                      std::move(input_vertex),
                      std::move(input_face),
                      std::move(repaired.actions),
                      {}};
}

}  // namespace

Result<PreparedMesh> prepareMesh(Context& context, const TriangleSoup& soup,
                                 const PrepareOptions& options) {
  ASSIGN_OR_RETURN(Repaired repaired, repairSoup(context, soup, options.repair));
  const SoupStructure structure =
      analyseSoup(static_cast<Index>(repaired.soup.vertices.size()), repaired.soup.faces);
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(Inspection inspection, inspectStructure(context, repaired.soup, structure));
  std::vector<std::string> warnings;
  for (Defect& defect : inspection.defects) {
    speakOfInput(repaired, defect);
    if (isBlocking(defect.kind)) continue;
    if (defect.kind == DefectKind::kMultipleComponents && options.component == "all") continue;
    warnings.push_back(std::string(defectName(defect.kind)) + ": " + defect.message);
  }
  RETURN_IF_ERROR(blockingError(inspection));
  ASSIGN_OR_RETURN(const Index chosen,
                   chooseComponent(countComponents(structure), options.component));
  RETURN_IF_ERROR(context.check());
  ASSIGN_OR_RETURN(PreparedMesh prepared, extract(std::move(repaired), structure, chosen));
  prepared.warnings = std::move(warnings);
  return prepared;
}

}  // namespace moduli
