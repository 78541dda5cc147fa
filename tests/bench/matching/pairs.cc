#include "tests/bench/matching/pairs.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "tests/bench/retrieval/deform.h"
#include "tests/bench/retrieval/remesh.h"
#include "tests/core/matching/renumbered.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

constexpr double kArticulatedFaces = 0.7, kRemeshedFaces = 0.5;  // Of the base's.
constexpr double kInversionGap = 0.5;                            // As inverted has it.

TriangleSoup toShare(const TriangleSoup& soup, double share) {
  return simplified(soup, static_cast<std::size_t>(share * static_cast<double>(soup.faces.size())));
}

/// The other surface, and where the vertices of the base are in it.
struct Changed {
  TriangleSoup soup;
  std::vector<Eigen::Vector3d> truth;
};

Changed inAnotherOrder(const TriangleSoup& soup, std::size_t seed) {
  Renumbered other = renumbered(moved(soup), seed);
  Changed result;
  for (const Index v : other.image) result.truth.push_back(other.soup.vertices[v]);
  result.soup = std::move(other.soup);
  return result;
}

Result<Changed> change(const TriangleSoup& soup, const std::string& kind, std::size_t seed) {
  SampleRandom random(seed);
  if (kind == "articulated") {
    TriangleSoup posed = articulated(soup, random);
    return Changed{toShare(posed, kArticulatedFaces), std::move(posed.vertices)};
  }
  if (kind == "remeshed") return Changed{toShare(soup, kRemeshedFaces), soup.vertices};
  if (kind == "inverted") {
    return inAnotherOrder(inverted(soup, kInversionGap, random), seed + 2);
  }
  if (kind == "copy") return inAnotherOrder(soup, seed + 2);
  return Status(Reason::kInvalidOption, "there is no kind '" + kind + "' of pairs",
                "kinds are articulated, remeshed, inverted and copy");
}

}  // namespace

const std::vector<std::string>& matchKinds() {
  static const std::vector<std::string> kinds = {"articulated", "remeshed", "inverted", "copy"};
  return kinds;
}

Result<MatchBase> readBase(Context& context, const std::string& path, std::size_t max_faces) {
  ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, path));
  auto prepared = prepareMesh(context, soup, {});
  if (!prepared.ok()) return prepared.status().withContext(path);
  const Connectivity& surface = prepared->mesh.connectivity();
  return MatchBase{std::filesystem::path(path).stem().string(),
                   simplified({prepared->mesh.positions(), surface.faces()}, max_faces)};
}

std::vector<MatchBase> sharedBases(Context& context, std::size_t max_faces) {
  std::vector<MatchBase> bases;
  for (const char* folder : {"brain", "closed_g0", "disk", "genus1", "genus2", "genus3plus",
                             "large", "multi_boundary"}) {
    for (const std::string& path : sharedMeshes(folder)) {
      Result<MatchBase> base = readBase(context, path, max_faces);
      if (base.ok()) bases.push_back(*std::move(base));
    }
  }
  return bases;
}

Result<KnownPair> makePair(const MatchBase& base, const std::string& kind,
                           const PairOptions& options) {
  ASSIGN_OR_RETURN(Changed changed, change(base.soup, kind, options.seed));
  ASSIGN_OR_RETURN(TriangleMesh a, TriangleMesh::fromSoup(base.soup));
  ASSIGN_OR_RETURN(TriangleMesh b, TriangleMesh::fromSoup(changed.soup));
  if (options.noise > 0) {
    SampleRandom random(options.seed + 3);
    const double deviation = options.noise * std::sqrt(b.area());
    ASSIGN_OR_RETURN(b, TriangleMesh::fromSoup(withNoise(changed.soup, deviation, random)));
  }
  return KnownPair{base.name, kind, std::move(a), std::move(b), std::move(changed.truth)};
}

}  // namespace moduli
