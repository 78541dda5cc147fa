#include "tests/bench/matching_bench.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/side_by_side.h"
#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/matching/cover_inverse.h"
#include "core/matching/harmonic_match.h"
#include "core/matching/homeomorphism.h"
#include "core/matching/map_report.h"
#include "core/matching/match_surfaces.h"
#include "core/matching/settling.h"
#include "core/matching/spectral_guess.h"
#include "core/matching/unfold_sphere.h"
#include "core/matching/whole_map.h"
#include "core/spherical/landmark_alignment.h"
#include "core/spherical/robust_map.h"
#include "core/topology/surface_topology.h"
#include "tests/bench/retrieval/remesh.h"

namespace moduli {
namespace {

constexpr double kShare = 0.7;  // Of the faces.

/// What the steps of a match leave for those after them: of genus 0 spheres, of others covers.
struct Steps {
  std::optional<MatchPair> pair;
  std::optional<SpectralSurface> spectral_a, spectral_b;
  SpectralMatch match;
  std::vector<SurfacePoint> points;
  std::optional<SphereLocator> sphere_b;
  Points3 sphere_a, start, fitted;  ///< Of the thinned surface, where there is one.
  Points3 mapped;
  std::optional<CoverSurface> cover;
  HarmonicMatch harmonic;
  CoverMap map;
  std::vector<SurfacePoint> images, inverse;
};

/// The two surfaces, and the steps taken so far.
class Bench {
 public:
  explicit Bench(std::shared_ptr<Case> mesh) : mesh_(std::move(mesh)) {}

  const Case& mesh() const { return *mesh_; }

  /// Takes all steps, once for all benchmarks.
  const Status& prepare() {
    if (!prepared_) prepared_.emplace(takeAll());
    return *prepared_;
  }

  Status thin(Context& context) {
    // Taken from where it is: GCC 12 takes the parts of a moved result for uninitialized.
    Result<MatchPair> pair = makeMatchPair(context, a(), *b_);
    RETURN_IF_ERROR(pair.status());
    steps_.pair.emplace(*std::move(pair));
    return {};
  }

  Status spectral(Context& context) {
    std::optional<Result<SpectralSurface>> first, second;
    sideBySide(
        context, [&](Context& own) { first.emplace(makeSpectralSurface(own, coarseA())); },
        [&](Context& own) { second.emplace(makeSpectralSurface(own, steps_.pair->coarseB())); });
    RETURN_IF_ERROR(first->status());
    RETURN_IF_ERROR(second->status());
    steps_.spectral_a.emplace(**std::move(first));
    steps_.spectral_b.emplace(**std::move(second));
    return {};
  }

  Status spectra(Context& context) {
    ASSIGN_OR_RETURN(std::vector<SpectralMatch> found,
                     matchSpectra(context, *steps_.spectral_a, *steps_.spectral_b));
    if (found.empty()) return {Reason::kNoConvergence, "no correspondence was found"};
    steps_.match = std::move(found.front());
    return {};
  }

  Status points(Context& context) {
    ASSIGN_OR_RETURN(steps_.points,
                     correspondingPoints(context, *steps_.spectral_a, *steps_.spectral_b,
                                         steps_.match.functional));
    if (steps_.pair->thin_b) {
      steps_.points = onWhole(*b_, *steps_.pair->thin_b, steps_.points);
    }
    return {};
  }

  Status canonical(Context& context) {
    if (!isSphere()) {
      ASSIGN_OR_RETURN(CoverSurface cover,
                       straightCover(context, b_->connectivity(), b_->edgeLengths()));
      steps_.cover.emplace(std::move(cover));
      return {};
    }
    Result<SphereMap> first = SphereMap(), second = SphereMap();
    sideBySide(
        context, [&](Context& own) { first = sphereOf(own, coarseA()); },
        [&](Context& own) { second = sphereOf(own, *b_); });
    RETURN_IF_ERROR(first.status());
    RETURN_IF_ERROR(second.status());
    steps_.sphere_a = std::move(first->points);
    ASSIGN_OR_RETURN(SphereLocator locator,
                     SphereLocator::make(b_->connectivity(), std::move(second->points)));
    steps_.sphere_b.emplace(std::move(locator));
    return {};
  }

  Status fit(Context& context) {
    const TriangleMesh& from = coarseA();
    if (!isSphere()) {
      ASSIGN_OR_RETURN(steps_.harmonic,
                       matchHarmonically(context, from.connectivity(), from.edgeLengths(),
                                         *steps_.cover, steps_.points));
      return settle(context, from, *b_, *steps_.cover, steps_.points, steps_.harmonic.map);
    }
    RETURN_IF_ERROR(align());
    std::vector<VertexTarget> targets;
    for (Index v = 0; v < from.vertexCount(); ++v) targets.push_back({v, steps_.points[v], 1});
    ASSIGN_OR_RETURN(
        Homeomorphism map,
        fitHomeomorphism(context, {from.connectivity(), from.positions(), steps_.start}, target(),
                         targets));
    steps_.fitted = std::move(map.points);
    return {};
  }

  Status whole(Context& context) {
    const std::optional<ThinnedSurface>& thinned = steps_.pair->thin_a;
    steps_.images.clear();
    if (isSphere()) {
      steps_.mapped = steps_.fitted;
      if (thinned) {
        ASSIGN_OR_RETURN(steps_.mapped, mapWhole(context, *thinned, a(), target(), steps_.fitted));
      }
      for (const auto& p : steps_.mapped) steps_.images.push_back(steps_.sphere_b->locate(p));
      return {};
    }
    steps_.map = steps_.harmonic.map;
    if (thinned) {
      ASSIGN_OR_RETURN(steps_.map,
                       mapWhole(context, *thinned, a(), *b_, *steps_.cover, steps_.harmonic.map));
    }
    steps_.images = steps_.map.images;
    return {};
  }

  Status inverse(Context& context) {
    if (isSphere()) {
      ASSIGN_OR_RETURN(steps_.inverse, invertHomeomorphism(context, a().connectivity(),
                                                           steps_.mapped, *steps_.sphere_b));
    } else {
      ASSIGN_OR_RETURN(steps_.inverse,
                       invertCoverMap(context, a().connectivity(), *steps_.cover, steps_.map));
    }
    return {};
  }

  Status judge(Context&) {
    std::vector<Eigen::Vector3d> places;
    for (const SurfacePoint& point : steps_.images) {
      places.push_back(spacePoint(b_->connectivity(), b_->positions(), point));
    }
    report_ = measureSpaceMap(a().connectivity(), a().positions(), places);
    distance_ = isometricDistortion(a().connectivity(), a().positions(), places);
    cycle_ = cycleError(a().connectivity(), a().positions(), steps_.images, b_->connectivity(),
                        steps_.inverse);
    return {};
  }

  Status all(Context& context) {
    MatchOptions options;
    options.same_triangulation = false;
    return matchSurfaces(context, a(), *b_, options).status();
  }

 private:
  const TriangleMesh& a() const { return mesh_->prepared.mesh; }
  const TriangleMesh& coarseA() const { return steps_.pair->coarseA(); }
  SphericalTarget target() const { return {*steps_.sphere_b, b_->positions()}; }
  bool isSphere() const { return a().connectivity().eulerCharacteristic() == 2; }

  Status takeAll() {
    const TriangleSoup soup{a().positions(), a().connectivity().faces()};
    const auto wanted = static_cast<std::size_t>(kShare * static_cast<double>(soup.faces.size()));
    ASSIGN_OR_RETURN(TriangleMesh simpler, TriangleMesh::fromSoup(simplified(soup, wanted)));
    b_.emplace(std::move(simpler));
    Context context;
    RETURN_IF_ERROR(thin(context));
    RETURN_IF_ERROR(spectral(context));
    RETURN_IF_ERROR(spectra(context));
    RETURN_IF_ERROR(points(context));
    RETURN_IF_ERROR(canonical(context));
    RETURN_IF_ERROR(fit(context));
    RETURN_IF_ERROR(whole(context));
    return inverse(context);
  }

  static Result<SphereMap> sphereOf(Context& context, const TriangleMesh& mesh) {
    ASSIGN_OR_RETURN(const MollifiedLengths mollified,
                     mollify(mesh.connectivity(), mesh.edgeLengths()));
    ASSIGN_OR_RETURN(SphereMap map,
                     mapToSphereRobust(context, mesh.connectivity(), unitLengths(mollified.lengths),
                                       mesh.positions(), true));
    if (map.quality.flipped_faces > 0) {
      ASSIGN_OR_RETURN(map.points, unfoldSphere(context, mesh, std::move(map.points)));
    }
    return map;
  }

  Status align() {
    std::vector<PointPair> pairs;
    for (const Index v : steps_.spectral_a->coarse.vertices) {
      pairs.push_back(
          {steps_.sphere_a[v],
           spherePoint(b_->connectivity(), steps_.sphere_b->points(), steps_.points[v])});
    }
    ASSIGN_OR_RETURN(const LandmarkAlignment best, alignLandmarks(pairs, {}));
    steps_.start.clear();
    for (const Eigen::Vector3d& p : steps_.sphere_a) {
      steps_.start.push_back(best.map(p).normalized());
    }
    return {};
  }

  std::shared_ptr<Case> mesh_;
  std::optional<TriangleMesh> b_;
  Steps steps_;
  std::optional<Status> prepared_;
  MapReport report_;
  double distance_ = 0, cycle_ = 0;
};

}  // namespace

void registerMatching(const std::shared_ptr<Case>& mesh) {
  const SurfaceTopology topology = computeTopology(mesh->prepared.mesh.connectivity());
  if (topology.components != 1 || !topology.boundary_loops.empty()) return;
  const auto bench = std::make_shared<Bench>(mesh);
  const auto add = [&](const std::string& name, Status (Bench::*step)(Context&)) {
    registerTimed("match/" + name, mesh, [=](benchmark::State& state) {
      if (const Status& status = bench->prepare(); !status.ok()) {
        state.SkipWithError(status.toString().c_str());
        return;
      }
      std::map<std::string, double> stages;
      runTimed(state, bench->mesh(), [&] {
        Context context;
        const Status status = ((*bench).*step)(context);
        for (const auto& [stage, seconds] : context.timing()) stages[stage] += seconds;
        return status;
      });
      for (const auto& [stage, seconds] : stages) count(state, stage, seconds, bench->mesh());
      state.counters["faces"] = mesh->prepared.mesh.faceCount();
      state.counters["genus"] = topology.genus;
    });
  };
  add("thin", &Bench::thin);
  add("spectral", &Bench::spectral);
  add("spectra", &Bench::spectra);
  add("points", &Bench::points);
  add("canonical", &Bench::canonical);
  add("fit", &Bench::fit);
  add("whole", &Bench::whole);
  add("inverse", &Bench::inverse);
  add("judge", &Bench::judge);
  add("all", &Bench::all);
}

}  // namespace moduli
