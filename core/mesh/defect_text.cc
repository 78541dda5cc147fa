#include "core/mesh/defect_text.h"

#include "core/base/text.h"

namespace moduli {
namespace {

// "%": the count. "[one|many]": the form that fits it. "@": the first elements.
struct Text {
  std::string_view finding;
  std::string_view remedy;
};

Text textOf(DefectKind kind) {
  switch (kind) {
    case DefectKind::kEmpty:
      return {"the mesh has no faces", "save it with at least one face"};
    case DefectKind::kNonFiniteCoordinate:
      return {"% [vertex has|vertices have] a coordinate that is no finite number (@)",
              "correct [it|them] in the file"};
    case DefectKind::kDegenerateFace:
      return {"% [face repeats|faces repeat] a vertex (@)", "--repair drops [it|them]"};
    case DefectKind::kDuplicateFace:
      return {"% [face has|faces have] the same three vertices as an earlier one (@)",
              "--repair drops [it|them]"};
    case DefectKind::kNonManifoldEdge:
      return {"% [edge has|edges have] more than two faces (at [face|faces] @)",
              "separate the sheets that meet there in a modelling program"};
    case DefectKind::kNonOrientable:
      return {"% [component is|components are] one-sided ([it holds|they hold] [face|faces] @)",
              "cut [it|them] open along a loop in a modelling program"};
    case DefectKind::kInconsistentOrientation:
      return {
          "% [edge is|edges are] run through in the same direction by both faces (at "
          "[face|faces] @)",
          "--repair re-orients components that have two sides"};
    case DefectKind::kNonManifoldVertex:
      return {"% [vertex pinches|vertices pinch] the surface: several fans of faces meet there (@)",
              "--repair splits [it|them]"};
    case DefectKind::kIsolatedVertex:
      return {"% [vertex is|vertices are] used by no face (@)",
              "skipped in computing, kept in outputs"};
    case DefectKind::kDuplicateVertex:
      return {"% [vertex has|vertices have] the coordinates of an earlier one (@)",
              "--repair welds [it|them] where that leaves a surface"};
    case DefectKind::kZeroAreaFace:
      return {"% [face has|faces have] no area (@)", "computed by mollification"};
    case DefectKind::kMultipleComponents:
      return {"the surface has % components (with faces @)",
              "choose one by --component largest or --component N"};
  }
  return {};
}

std::string fillIn(std::string_view pattern, const Defect& defect) {
  std::string text;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] == '%') {
      text += std::to_string(defect.count);
    } else if (pattern[i] == '@') {
      text += defect.elements.empty()
                  ? "none of the file's own"
                  : listSome(defect.elements, static_cast<std::size_t>(defect.count));
    } else if (pattern[i] == '[') {
      const std::size_t bar = pattern.find('|', i);
      const std::size_t end = pattern.find(']', i);
      text += defect.count == 1 ? pattern.substr(i + 1, bar - i - 1)
                                : pattern.substr(bar + 1, end - bar - 1);
      i = end;
    } else {
      text += pattern[i];
    }
  }
  return text;
}

}  // namespace

std::string findingOf(const Defect& defect) {
  return fillIn(textOf(defect.kind).finding, defect);
}

std::string remedyOf(const Defect& defect) {
  return fillIn(textOf(defect.kind).remedy, defect);
}

std::string sentenceOf(const Defect& defect) {
  return findingOf(defect) + "; " + remedyOf(defect);
}

}  // namespace moduli
