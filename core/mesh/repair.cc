#include "core/mesh/repair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/mesh/fill_holes.h"
#include "core/mesh/inspect_soup.h"
#include "core/mesh/orient.h"
#include "core/mesh/soup_structure.h"
#include "core/mesh/weld.h"

namespace moduli {
namespace {

class Repairer {
 public:
  explicit Repairer(const TriangleSoup& input) : input_(input) {
    repaired_.soup = input;
    repaired_.input_vertex.resize(input.vertices.size());
    repaired_.input_face.resize(input.faces.size());
    std::iota(repaired_.input_vertex.begin(), repaired_.input_vertex.end(), 0);
    std::iota(repaired_.input_face.begin(), repaired_.input_face.end(), 0);
  }

  Status repair(Context& context) {
    ASSIGN_OR_RETURN(weld_target_, planWeld(context, soup()));
    for (Triangle& face : soup().faces) {
      for (Index& v : face) v = weld_target_[v];
    }
    const Index degenerate = dropFaces(degenerateFaces());
    RETURN_IF_ERROR(context.check());
    const Index duplicate = dropFaces(findDuplicateFaces(soup().faces, analyse()));
    RETURN_IF_ERROR(context.check());
    const Index turned = orientFaces(repaired_.soup, analyse());
    RETURN_IF_ERROR(context.check());
    const Index pinched = giveEachFanItsVertex();
    const auto [welded, isolated] = dropUnusedVertices();
    note("weld vertices", welded);
    note("drop degenerate faces", degenerate);
    note("drop duplicate faces", duplicate);
    note("re-orient faces", turned);
    note("split pinched vertices", pinched);
    note("drop isolated vertices", isolated);
    return context.check();
  }

  Status fillHoles(Context& context, double fraction) {
    ASSIGN_OR_RETURN(const Inspection inspection, inspectSoup(context, soup()));
    if (!inspection.valid) return {};
    ASSIGN_OR_RETURN(const Index filled, moduli::fillHoles(context, fraction, repaired_.soup));
    repaired_.input_vertex.resize(soup().vertices.size(), kNone);
    repaired_.input_face.resize(soup().faces.size(), kNone);
    note("fill holes", filled);
    return {};
  }

  Repaired take() { return std::move(repaired_); }

 private:
  TriangleSoup& soup() { return repaired_.soup; }

  SoupStructure analyse() {
    return analyseSoup(static_cast<Index>(soup().vertices.size()), soup().faces);
  }

  void note(const char* action, Index count) {
    if (count > 0) repaired_.actions.push_back({action, count});
  }

  std::vector<bool> degenerateFaces() {
    std::vector<bool> degenerate(soup().faces.size());
    for (std::size_t f = 0; f < degenerate.size(); ++f) {
      degenerate[f] = repeatsVertex(soup().faces[f]);
    }
    return degenerate;
  }

  Index dropFaces(const std::vector<bool>& dropped) {
    std::size_t kept = 0;
    for (std::size_t f = 0; f < dropped.size(); ++f) {
      if (dropped[f]) continue;
      soup().faces[kept] = soup().faces[f];
      repaired_.input_face[kept++] = repaired_.input_face[f];
    }
    soup().faces.resize(kept);
    repaired_.input_face.resize(kept);
    return static_cast<Index>(dropped.size() - kept);
  }

  // The vertex that a corner had before welding: of the three of its face the one welded to it.
  Index originOf(Index corner) const {
    const Index welded = repaired_.soup.faces[corner / 3][corner % 3];
    const Triangle& face = input_.faces[repaired_.input_face[corner / 3]];
    if (weld_target_[face[0]] == welded) return face[0];
    return weld_target_[face[1]] == welded ? face[1] : face[2];
  }

  // Splits what is pinched, and takes back the welds that only pinched: each fan keeps its lowest
  // vertex if that is free, else any free one of its own, else gets a copy behind all others.
  // Returns how many vertices had to be copied.
  Index giveEachFanItsVertex() {
    const SoupStructure structure = analyse();
    std::vector<Index> origin(structure.fan.size());
    std::vector<Index> lowest(structure.fans, std::numeric_limits<Index>::max());
    for (Index k = 0; k < static_cast<Index>(origin.size()); ++k) {
      origin[k] = originOf(k);
      lowest[structure.fan[k]] = std::min(lowest[structure.fan[k]], origin[k]);
    }
    std::vector<bool> taken(input_.vertices.size(), false);
    std::vector<Index> vertex(structure.fans, kNone);
    const auto take_if_free = [&](Index fan, Index v) {
      if (vertex[fan] != kNone || taken[v]) return;
      vertex[fan] = v;
      taken[v] = true;
    };
    for (Index fan = 0; fan < structure.fans; ++fan) take_if_free(fan, lowest[fan]);
    for (std::size_t k = 0; k < origin.size(); ++k) take_if_free(structure.fan[k], origin[k]);

    std::vector<bool> copied(input_.vertices.size(), false);
    for (Index fan = 0; fan < structure.fans; ++fan) {
      if (vertex[fan] != kNone) continue;
      vertex[fan] = copyVertex(lowest[fan]);
      copied[lowest[fan]] = true;
    }
    for (std::size_t k = 0; k < origin.size(); ++k) {
      soup().faces[k / 3][k % 3] = vertex[structure.fan[k]];
    }
    return static_cast<Index>(std::count(copied.begin(), copied.end(), true));
  }

  Index copyVertex(Index v) {
    soup().vertices.push_back(Eigen::Vector3d(soup().vertices[v]));
    repaired_.input_vertex.push_back(repaired_.input_vertex[v]);
    return static_cast<Index>(soup().vertices.size()) - 1;
  }

  struct Dropped {
    Index welded = 0;  // Another vertex took their place.
    Index isolated = 0;
  };

  Dropped dropUnusedVertices() {
    std::vector<bool> used(soup().vertices.size(), false);
    for (const Triangle& face : soup().faces) {
      for (const Index v : face) used[v] = true;
    }
    std::vector<bool> place_taken(weld_target_.size(), false);
    for (std::size_t v = 0; v < weld_target_.size(); ++v) {
      if (used[v]) place_taken[weld_target_[v]] = true;
    }
    Dropped dropped;
    std::vector<Index> number(used.size(), kNone);
    Index kept = 0;
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) {
        ++(place_taken[weld_target_[v]] ? dropped.welded : dropped.isolated);
        continue;
      }
      number[v] = kept;
      soup().vertices[kept] = Eigen::Vector3d(soup().vertices[v]);
      repaired_.input_vertex[kept++] = repaired_.input_vertex[v];
    }
    soup().vertices.resize(kept);
    repaired_.input_vertex.resize(kept);
    for (Triangle& face : soup().faces) {
      for (Index& v : face) v = number[v];
    }
    return dropped;
  }

  const TriangleSoup& input_;
  Repaired repaired_;
  std::vector<Index> weld_target_;
};

}  // namespace

Result<Repaired> repairSoup(Context& context, const TriangleSoup& soup,
                            const RepairOptions& options) {
  if (options.fill_holes && !(*options.fill_holes > 0 && std::isfinite(*options.fill_holes))) {
    return Status(Reason::kInvalidOption, "the fraction for filling holes must be positive",
                  "0.5 is usual");
  }
  Repairer repairer(soup);
  if (options.repair) RETURN_IF_ERROR(repairer.repair(context));
  if (options.fill_holes) RETURN_IF_ERROR(repairer.fillHoles(context, *options.fill_holes));
  return repairer.take();
}

Result<std::vector<RepairAction>> proposeRepair(Context& context, const TriangleSoup& soup) {
  ASSIGN_OR_RETURN(Repaired repaired, repairSoup(context, soup, {true, {}}));
  return std::move(repaired.actions);
}

}  // namespace moduli
