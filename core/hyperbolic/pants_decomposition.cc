#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/hyperbolic/cut_surface.h"
#include "core/hyperbolic/lifts.h"
#include "core/hyperbolic/pants.h"
#include "core/hyperbolic/piece_search.h"

namespace moduli {
namespace {

/// Lengths are compared to this, relative.
constexpr double kLengthTolerance = 1e-9;
/// An axis that touches the polygon may miss it by rounding.
constexpr double kTouching = 1e-6;
/// By how much more is searched each time; the work grows like e^{length}.
constexpr double kLonger = 0.5;
/// What is not found by then is lost: elements over it would not fit into doubles.
constexpr double kLongest = 60;
/// The geodesic that moves 0 least of its conjugates, with its word.
ClosedGeodesic geodesicOf(const OrbitPolygon& polygon, const std::vector<Lift>& conjugates,
                          const std::vector<std::int32_t>& pairings) {
  const auto best = std::min_element(
      conjugates.begin(), conjugates.end(),
      [](const Lift& x, const Lift& y) { return std::abs(x.shape.b) < std::abs(y.shape.b); });
  Word way;
  const auto append = [](Word& word, const Word& letters) {
    word.insert(word.end(), letters.begin(), letters.end());
  };
  std::vector<int> steps;
  for (const Lift* c = &*best; c->from >= 0; c = &conjugates[c->from]) steps.push_back(c->pairing);
  for (auto step = steps.rbegin(); step != steps.rend(); ++step)
    append(way, polygon.pairings[*step].word);
  Word word = inverseWord(way);
  for (const std::int32_t k : pairings) append(word, polygon.pairings[k].word);
  append(word, way);
  return {translationLength(best->shape), best->shape, reduceWord(word)};
}

bool isAmong(const Axis& axis, const std::vector<Axis>& axes) {
  return std::any_of(axes.begin(), axes.end(),
                     [&axis](const Axis& a) { return sameAxis(a, axis); });
}

/// An element over a closed geodesic that may be chosen.
struct Candidate {
  const std::vector<std::int32_t>* pairings = nullptr;
  WideSu11 map;
  double length = 0;
  Axis axis;
};

/// Those whose axes pass the polygon, ascending by length.
std::vector<Candidate> candidatesOf(const OrbitPolygon& polygon,
                                    const std::vector<std::vector<std::int32_t>>& elements) {
  std::vector<Candidate> result;
  for (const std::vector<std::int32_t>& pairings : elements) {
    const WideSu11 map = productOf(polygon, pairings);
    const Su11 shape = rounded(map);
    const Axis axis = axisOf(shape);
    if (!meetsPolygon(polygon, axis, kTouching)) continue;
    result.push_back({&pairings, map, translationLength(shape), axis});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Candidate& x, const Candidate& y) { return x.length < y.length; });
  return result;
}

/// Chooses curves, shortest first.
class Chooser {
 public:
  explicit Chooser(const OrbitPolygon& polygon) : polygon_(polygon) {}

  /// elements: over all simple closed geodesics longer than those seen before, up to some length,
  /// that are disjoint from those chosen, by their pairings.
  void choose(const std::vector<std::vector<std::int32_t>>& elements);

  std::vector<ClosedGeodesic> curves;
  Cuts cuts;  ///< Along these.

 private:
  struct Seen {
    double length = 0;
    std::vector<Axis> axes;
  };
  bool isKnown(const Candidate& candidate, const std::vector<Seen>& seen) const;

  const OrbitPolygon& polygon_;
};

/// Whether it runs over a geodesic that was seen, or is a power of a curve.
bool Chooser::isKnown(const Candidate& candidate, const std::vector<Seen>& seen) const {
  for (auto other = seen.rbegin(); other != seen.rend(); ++other) {
    if (other->length < candidate.length * (1 - 1e-6)) break;
    if (isAmong(candidate.axis, other->axes)) return true;
  }
  return std::any_of(cuts.lifts.begin(), cuts.lifts.end(),
                     [&candidate](const auto& axes) { return isAmong(candidate.axis, axes); });
}

void Chooser::choose(const std::vector<std::vector<std::int32_t>>& elements) {
  std::vector<Seen> seen;
  const std::size_t wanted = 3 * static_cast<std::size_t>(polygon_.genus) - 3;
  for (const Candidate& candidate : candidatesOf(polygon_, elements)) {
    if (curves.size() == wanted) return;
    if (isKnown(candidate, seen)) continue;
    const std::vector<Lift> conjugates = liftsAcross(polygon_, candidate.map);
    std::vector<Axis> axes;
    for (const Lift& lift : conjugates) axes.push_back(lift.axis());
    seen.push_back({candidate.length, axes});
    if (anyCross(axes, axes)) continue;
    if (std::any_of(cuts.lifts.begin(), cuts.lifts.end(),
                    [&axes](const auto& chosen) { return anyCross(axes, chosen); }))
      continue;
    curves.push_back(geodesicOf(polygon_, conjugates, *candidate.pairings));
    cuts.lifts.push_back(std::move(axes));
    cuts.lengths.push_back(curves.back().length);
  }
}

/// The shortest of the pairings, an upper bound of the systole.
double shortestPairing(const OrbitPolygon& polygon) {
  double least = translationLength(polygon.pairings.front().map);
  for (const GroupElement& g : polygon.pairings) least = std::min(least, translationLength(g.map));
  return least;
}

Status missingCurves(const CutSurface& cut, std::size_t found, double length) {
  std::string pieces;
  int missing = 0;
  for (const SurfacePiece& piece : cut.pieces) {
    if (piece.missing() == 0) continue;
    missing += piece.missing();
    pieces += (pieces.empty() ? "" : ", ") + std::to_string(piece.missing()) +
              " in a piece of genus " + std::to_string(piece.genus) + " with " +
              std::to_string(piece.cuffs.size()) + " cuffs";
  }
  return {Reason::kNoConvergence,
          "only " + std::to_string(found) + " of " +
              std::to_string(found + static_cast<std::size_t>(missing)) +
              " curves of a pants decomposition are no longer than " + std::to_string(length) +
              "; missing: " + pieces,
          "allow more parts"};
}

}  // namespace

Result<PantsDecomposition> pantsDecomposition(Context& context, const OrbitPolygon& polygon,
                                              const PantsOptions& options) {
  const std::size_t wanted = 3 * static_cast<std::size_t>(polygon.genus) - 3;
  Chooser chooser(polygon);
  {
    const Context::Stage stage(context, "pants curves");
    std::size_t left = options.most_parts;
    double known = 0;
    double upto = std::min(kLonger, shortestPairing(polygon) * (1 + 1e-5));
    for (; chooser.curves.size() < wanted; upto += kLonger) {
      RETURN_IF_ERROR(context.check());
      ASSIGN_OR_RETURN(const CutSurface cut, cutSurface(polygon, chooser.cuts));
      const auto disks = coverPieces(cut, chooser.cuts);
      ASSIGN_OR_RETURN(
          const PieceElements found,
          searchPieces(context, polygon, cut, disks, known * (1 - kLengthTolerance), upto, left));
      if (!found.complete || upto > kLongest)
        return missingCurves(cut, chooser.curves.size(), known);
      left -= found.visited;
      chooser.choose(found.elements);
      known = upto;
    }
  }
  PantsDecomposition result;
  result.curves = std::move(chooser.curves);
  ASSIGN_OR_RETURN(FenchelNielsenReading reading, fenchelNielsen(context, polygon, result.curves));
  result.coordinates = std::move(reading.coordinates);
  result.seam_error = reading.seam_error;
  return result;
}

}  // namespace moduli
