#include "tests/bench/matching/errors.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/intrinsic/edge_graph.h"
#include "core/matching/map_report.h"
#include "core/matching/nearest_in_triangle.h"

namespace moduli {
namespace {

constexpr double kNear = 0.1;
constexpr double kShortWay = 4;  ///< Mean edges.

/// Ways along the edges of b, searched as far as need be.
class Ways {
 public:
  explicit Ways(const TriangleMesh& b)
      : b_(b), graph_(b.connectivity(), b.edgeLengths()), whole_(std::sqrt(b.area())) {
    const std::vector<double> lengths = b.edgeLengths();
    mean_ =
        std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
  }

  /// From the corner of its face that is nearest to a point in space to the nearest corner of
  /// another face; nothing where that is no longer than the edges on the way could be off. (The
  /// nearest vertex of all may be behind a thin part.)
  std::optional<double> from(const Eigen::Vector3d& point, Index own, Index face) const {
    const auto& positions = b_.positions();
    const Triangle& around = b_.connectivity().face(own);
    const Index start =
        *std::min_element(around.begin(), around.end(), [&](const Index v, const Index w) {
          return (positions[v] - point).squaredNorm() < (positions[w] - point).squaredNorm();
        });
    const Triangle& corners = b_.connectivity().face(face);
    const double unsure = std::max(kShortWay * mean_, longestAt(start) + longestAt(corners[0]));
    for (double radius = 0.05 * whole_;; radius *= 2) {
      const auto reached = graph_.within(start, radius);
      for (const auto& [vertex, distance] : reached) {
        if (std::find(corners.begin(), corners.end(), vertex) == corners.end()) continue;
        return distance > unsure ? std::optional(distance) : std::nullopt;
      }
      if (reached.size() == positions.size()) return std::numeric_limits<double>::infinity();
    }
  }

 private:
  double longestAt(Index vertex) const {
    double longest = 0;
    for (const auto& [other, length] : graph_.neighbours(vertex)) {
      longest = std::max(longest, length);
    }
    return longest;
  }

  const TriangleMesh& b_;
  EdgeGraph graph_;
  double whole_, mean_ = 0;
};

/// Nearest points of a surface in space, among all its faces.
class Surface {
 public:
  explicit Surface(const TriangleMesh& mesh) : mesh_(mesh) {
    const auto& p = mesh.positions();
    for (const auto& [i, j, k] : mesh.connectivity().faces()) {
      const Eigen::Vector3d centre = (p[i] + p[j] + p[k]) / 3;
      const auto away = [&](Index v) { return (p[v] - centre).norm(); };
      balls_.emplace_back(centre, std::max({away(i), away(j), away(k)}));
    }
  }

  /// With its face.
  std::pair<Eigen::Vector3d, Index> nearest(const Eigen::Vector3d& point) const {
    const auto& p = mesh_.positions();
    std::pair<Eigen::Vector3d, Index> result(point, 0);
    double least = std::numeric_limits<double>::infinity();
    for (Index f = 0; f < mesh_.faceCount(); ++f) {
      const auto& [centre, radius] = balls_[f];
      const double reach = least + radius;
      if ((centre - point).squaredNorm() > reach * reach) continue;
      const auto& [i, j, k] = mesh_.connectivity().face(f);
      const auto weights = nearestInTriangle(point, p[i], p[j], p[k]);
      const Eigen::Vector3d place = weights[0] * p[i] + weights[1] * p[j] + weights[2] * p[k];
      if ((place - point).norm() >= least) continue;
      least = (place - point).norm();
      result = {place, f};
    }
    return result;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<std::pair<Eigen::Vector3d, double>> balls_;  ///< Around faces: centre, radius.
};

std::string methodName(MatchMethod method) {
  switch (method) {
    case MatchMethod::kSameTriangulation:
      return "triangulation";
    case MatchMethod::kNearIsometry:
      return "metric";
    case MatchMethod::kMobius:
      return "Moebius";
    case MatchMethod::kShape:
      return "shape";
  }
  return "";
}

template <typename... Values>
std::string printed(const char* format, Values... values) {
  std::string text(static_cast<std::size_t>(std::snprintf(nullptr, 0, format, values...)), '\0');
  std::snprintf(text.data(), text.size() + 1, format, values...);
  return text;
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + '"';
}

std::string meanLine(const std::string& what, const MeanScore& score) {
  const std::string title = printed("mean of %zu %s", score.pairs, what.c_str());
  std::string line = printed("%-54s %7.4f %7.4f %7.3f %7.2f %8.2f", title.c_str(), score.mean,
                             score.most, score.near, score.folded, score.seconds);
  if (score.failures > 0) line += printed("  (%zu without a map)", score.failures);
  return line + '\n';
}

std::string jsonMean(const std::string& kind, const MeanScore& score) {
  return quoted(kind) +
         printed(
             ":{\"pairs\":%zu,\"failures\":%zu,\"mean\":%.6f,\"most\":%.6f,\"near\":%.6f,"
             "\"folded\":%.6f,\"seconds\":%.4f}",
             score.pairs, score.failures, score.mean, score.most, score.near, score.folded,
             score.seconds);
}

}  // namespace

std::vector<double> matchErrors(const KnownPair& pair, const std::vector<SurfacePoint>& images,
                                std::size_t samples) {
  const Ways ways(pair.b);
  const Surface surface(pair.b);
  const double whole = std::sqrt(pair.b.area());
  const std::size_t stride = std::max<std::size_t>(1, pair.truth.size() / samples);
  std::vector<double> errors;
  for (std::size_t v = 0; v < pair.truth.size(); v += stride) {
    const Eigen::Vector3d place = spacePoint(pair.b.connectivity(), pair.b.positions(), images[v]);
    const auto [truth, own] = surface.nearest(pair.truth[v]);
    const double straight = (place - truth).norm();
    const auto way = ways.from(truth, own, images[v].face);
    errors.push_back((way ? std::max(straight, *way) : straight) / whole);
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

PairScore scorePair(const KnownPair& pair, const MatchOptions& options) {
  using Clock = std::chrono::steady_clock;
  PairScore score;
  score.name = pair.name;
  score.kind = pair.kind;
  score.vertices = pair.a.vertexCount();
  Context context;
  const auto start = Clock::now();
  const Result<SurfaceMatch> match = matchSurfaces(context, pair.a, pair.b, options);
  score.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (!match.ok()) {
    score.failure = match.status().toString();
    return score;
  }
  const std::vector<double> errors = matchErrors(pair, match->images);
  const auto count = static_cast<double>(errors.size());
  score.method = methodName(match->method);
  score.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / count;
  score.most = errors[errors.size() * 9 / 10];
  score.near =
      static_cast<double>(std::lower_bound(errors.begin(), errors.end(), kNear) - errors.begin()) /
      count;
  score.folded = match->report.folded_faces;
  return score;
}

MeanScore meanScore(const std::vector<PairScore>& scores, const std::string& kind) {
  MeanScore mean;
  for (const PairScore& score : scores) {
    if (!kind.empty() && score.kind != kind) continue;
    ++(score.failure.empty() ? mean.pairs : mean.failures);
    if (!score.failure.empty()) continue;
    mean.mean += score.mean;
    mean.most += score.most;
    mean.near += score.near;
    mean.folded += score.folded;
    mean.seconds += score.seconds;
  }
  const double count = std::max(1.0, static_cast<double>(mean.pairs));
  for (double* value : {&mean.mean, &mean.most, &mean.near, &mean.folded, &mean.seconds}) {
    *value /= count;
  }
  return mean;
}

std::string scoreHead() {
  return printed("%-26s %6s %-11s %8s %7s %7s %7s %7s %8s\n", "mesh", "V", "kind", "by", "mean",
                 "90 %", "< 0.1", "folded", "seconds");
}

std::string scoreLine(const PairScore& score) {
  const std::string begin =
      printed("%-26.26s %6d %-11s ", score.name.c_str(), score.vertices, score.kind.c_str());
  if (!score.failure.empty()) return begin + score.failure + '\n';
  return begin + printed("%8.8s %7.4f %7.4f %7.3f %7d %8.2f\n", score.method.c_str(), score.mean,
                         score.most, score.near, score.folded, score.seconds);
}

std::string meanLines(const std::vector<PairScore>& scores) {
  std::string text;
  for (const std::string& kind : matchKinds()) {
    const MeanScore mean = meanScore(scores, kind);
    if (mean.pairs + mean.failures > 0) text += meanLine(kind, mean);
  }
  return text + meanLine("pairs", meanScore(scores, ""));
}

std::string scoreJson(const std::vector<PairScore>& scores) {
  std::string text = "{\"pairs\":[";
  for (const PairScore& score : scores) {
    if (text.back() != '[') text += ',';
    text += "{\"mesh\":" + quoted(score.name) + ",\"kind\":" + quoted(score.kind) +
            printed(",\"vertices\":%d,\"seconds\":%.4f", score.vertices, score.seconds);
    if (score.failure.empty()) {
      text += ",\"method\":" + quoted(score.method) +
              printed(",\"mean\":%.6f,\"most\":%.6f,\"near\":%.6f,\"folded\":%d", score.mean,
                      score.most, score.near, score.folded);
    } else {
      text += ",\"failure\":" + quoted(score.failure);
    }
    text += '}';
  }
  text += "],\"means\":{";
  for (const std::string& kind : matchKinds()) {
    const MeanScore mean = meanScore(scores, kind);
    if (mean.pairs + mean.failures > 0) text += jsonMean(kind, mean) + ',';
  }
  return text + jsonMean("all", meanScore(scores, "")) + "}}\n";
}

}  // namespace moduli
