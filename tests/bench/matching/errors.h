#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/matching/match_surfaces.h"
#include "tests/bench/matching/pairs.h"

/// How far matches are from the truth.
namespace moduli {

/// Distances of points of b from where they ought to be, over the root of b's area, ascending.
/// Where b is another mesh of a's surface, that is the point of it that is nearest to the vertex of
/// a.
///
/// A distance is the larger one of the straight line and of the shortest way along edges of b from
/// the nearest corner of the triangle of the truth to the triangle of the point; where that way is
/// no longer than four edges (of b's mean length), or the longest edges at both ends, the straight
/// line: so near, a surface is nearly flat. It is never below the straight one, and longer ways are
/// off the distance within the surface by at most the edges there and the some percent that ways
/// along edges are too long. images: per vertex of a; one vertex of a in so many is asked that
/// there are about `samples`. O(samples V log V) at worst.
std::vector<double> matchErrors(const KnownPair& pair, const std::vector<SurfacePoint>& images,
                                std::size_t samples = 1500);

/// What became of a pair.
struct PairScore {
  std::string name, kind;
  Index vertices = 0;         ///< Of a.
  std::string failure;        ///< "REASON: message"; the rest below is 0 then.
  std::string method;         ///< triangulation, metric, Möbius, shape.
  double mean = 0, most = 0;  ///< Of the errors; most: of nine in ten.
  double near = 0;            ///< Share of errors below 0.1.
  Index folded = 0;           ///< Faces.
  double seconds = 0;
};

/// Matches a pair and measures.
PairScore scorePair(const KnownPair& pair, const MatchOptions& options);

/// Means of the pairs that have a map; failures are counted.
struct MeanScore {
  std::size_t pairs = 0, failures = 0;
  double mean = 0, most = 0, near = 0, folded = 0, seconds = 0;
};

/// kind: "" for all.
MeanScore meanScore(const std::vector<PairScore>& scores, const std::string& kind);

/// A line for a pair, the line above all of them, and the lines of means by kind and of all.
std::string scoreHead();
std::string scoreLine(const PairScore& score);
std::string meanLines(const std::vector<PairScore>& scores);

/// Everything as one JSON object.
std::string scoreJson(const std::vector<PairScore>& scores);

}  // namespace moduli
