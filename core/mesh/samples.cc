#include "core/mesh/samples.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/mesh/sample_kinds.h"

namespace moduli {
namespace {

using Maker = Result<TriangleSoup> (*)(const SampleValues&);

struct Entry {
  SampleKind kind;
  Maker make;
};

SampleParameter seedParameter() {
  return {"seed", 0, "not 0: an irregular triangulation, the same for the same seed"};
}

std::vector<Entry> roundEntries() {
  const SampleParameter parts = {"resolution", 16, "parts of each edge of an icosahedron"};
  return {
      {{"sphere", "round sphere", {{"radius", 1, "radius"}, parts, seedParameter()}}, makeSphere},
      {{"ellipsoid",
        "ellipsoid with three half axes",
        {{"a", 1, "half axis along x"},
         {"b", 0.8, "half axis along y"},
         {"c", 0.6, "half axis along z"},
         parts,
         seedParameter()}},
       makeEllipsoid},
      {{"spheroid",
        "ellipsoid of revolution about z",
        {{"a", 1, "radius of the equator"},
         {"c", 0.5, "half axis along z"},
         parts,
         seedParameter()}},
       makeSpheroid},
      {{"capped-cylinder",
        "cylinder about z with hemispheres at its ends",
        {{"radius", 1, "radius"},
         {"half_length", 1, "half the length of the tube"},
         {"resolution", 16, "rows of a hemisphere"},
         seedParameter()}},
       makeCappedCylinder},
  };
}

std::vector<Entry> closedEntries() {
  return {
      {{"torus",
        "torus of revolution about z",
        {{"R", 2, "radius of the core circle"},
         {"r", 1, "radius of the tube"},
         {"resolution", 32, "vertices around the tube; twice as many along it"},
         {"rings", 0, "vertices along the core circle instead"},
         {"sides", 0, "vertices around the tube instead"},
         seedParameter()}},
       makeTorus},
      {{"diplotorus",
        "flat polyhedral torus: all angles around every vertex add up to a full turn",
        {{"n", 6, "vertices of its two regular polygons"},
         {"phi", 0.03, "angle between the polygons"},
         {"h", 0.6, "height between the polygons"},
         {"s", -2, "shift of the first band of faces"},
         {"s2", 0, "shift of the second band of faces"},
         {"resolution", 1, "parts of each edge"}}},
       makeDiplotorus},
      {{"genus",
        "smooth plate with holes, closed",
        {{"genus", 2, "number of holes, 0 to 100"},
         {"resolution", 8, "parts of an edge as long as a hole, rounded up to a power of two"},
         seedParameter()}},
       makeGenus},
  };
}

std::vector<Entry> borderedEntries() {
  return {
      {{"annulus",
        "flat ring",
        {{"r", 1, "inner radius"},
         {"R", 2, "outer radius"},
         {"resolution", 16, "rows between the circles"},
         {"sides", 0, "vertices on each circle; 0: for square cells"},
         seedParameter()}},
       makeAnnulus},
      {{"disk",
        "flat disk",
        {{"radius", 1, "radius"},
         {"resolution", 16, "rows from the centre to the rim"},
         seedParameter()}},
       makeDisk},
      {{"plate",
        "flat rectangle of unit cells with a row of rectangular holes",
        {{"cells_x", 0, "width in cells; 0: as the holes need"},
         {"cells_y", 0, "height in cells; 0: as the holes need"},
         {"holes", 1, "number of holes"},
         {"hole_x", 1, "left end of the first hole"},
         {"hole_y", 1, "lower end of the holes"},
         {"hole_width", 2, "width of a hole in cells"},
         {"hole_height", 2, "height of a hole in cells"},
         {"hole_step", 3, "cells from one hole's left end to the next one's"},
         {"resolution", 8, "parts of each edge of a cell"},
         seedParameter()}},
       makePlate},
  };
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = [] {
    std::vector<Entry> list = roundEntries();
    for (auto& more : {closedEntries(), borderedEntries()}) {
      list.insert(list.end(), more.begin(), more.end());
    }
    return list;
  }();
  return all;
}

template <typename List>
std::string namesOf(const List& list) {
  std::string names;
  for (const auto& item : list) names += (names.empty() ? "" : ", ") + item.name;
  return names;
}

Result<SampleValues> valuesOf(const SampleKind& kind,
                              const std::map<std::string, double>& parameters) {
  std::map<std::string, double> values;
  for (const SampleParameter& known : kind.parameters) values[known.name] = known.default_value;
  for (const auto& [name, value] : parameters) {
    const auto place = values.find(name);
    if (place == values.end()) {
      return sampleError(kind.name + " has no parameter '" + name + "'",
                         "its parameters are " + namesOf(kind.parameters));
    }
    place->second = value;
  }
  // Whole numbers up to 2^53 are exact.
  const auto seed = values.find("seed");
  if (seed != values.end() && (!(seed->second >= 0 && seed->second <= 0x1p53) ||
                               seed->second != std::floor(seed->second))) {
    return sampleError(
        "seed is " + shortestDouble(seed->second) + ", but must be a whole number from 0 to 2^53",
        "0 is for the regular triangulation");
  }
  return SampleValues(std::move(values));
}

}  // namespace

const std::vector<SampleKind>& sampleKinds() {
  static const std::vector<SampleKind> kinds = [] {
    std::vector<SampleKind> list;
    for (const Entry& entry : entries()) list.push_back(entry.kind);
    return list;
  }();
  return kinds;
}

Result<TriangleSoup> makeSample(const std::string& kind,
                                const std::map<std::string, double>& parameters) {
  const auto entry = std::ranges::find(entries(), kind, [](const Entry& e) { return e.kind.name; });
  if (entry == entries().end()) {
    return sampleError("there is no sample '" + kind + "'",
                       "the kinds are " + namesOf(sampleKinds()));
  }
  ASSIGN_OR_RETURN(const SampleValues values, valuesOf(entry->kind, parameters));
  Result<TriangleSoup> soup = entry->make(values);
  if (soup.ok()) return soup;
  const Status why = soup.status();
  const std::string hint =
      why.hint().empty() ? "the parameters are " + namesOf(entry->kind.parameters) : why.hint();
  return Status(why.reason(), kind + ": " + why.message(), hint);
}

}  // namespace moduli
