#include "server/service/landmarks.h"

#include <set>
#include <string>
#include <utility>

#include "server/service/named_vertex.h"

namespace moduli {
namespace {

Status refuse(const std::string& what, const std::string& hint) {
  return {Reason::kInvalidOption, what, hint};
}

/// One of the two surfaces and what messages say before they speak of it.
class Side {
 public:
  Side(const Subject& subject, std::string prefix) : subject_(subject), prefix_(std::move(prefix)) {
    if (!subject.prepared) return;
    halfedge_.assign(3 * subject.soup.faces.size(), kNone);
    for (std::size_t h = 0; h < subject.input_corners.size(); ++h) {
      if (subject.input_corners[h] != kNone) {
        halfedge_[subject.input_corners[h]] = static_cast<Index>(h);
      }
    }
  }

  Result<SurfacePoint> place(const v1::SurfacePoint& point, const std::string& name) const {
    auto placed = point.has_vertex() ? atVertex(point.vertex()) : inFace(point);
    if (!placed.ok()) return named(placed.status(), name);
    return placed;
  }

  Result<std::vector<Index>> path(const google::protobuf::RepeatedField<std::int32_t>& vertices,
                                  const std::string& name) const {
    std::vector<Index> path;
    for (int i = 0; i < vertices.size(); ++i) {
      auto place = namedVertex("a curve", vertices[i], subject_.places);
      if (!place.ok()) return named(place.status(), name);
      if (i > 0 && !areJoined(path.back(), *place)) {
        return named(refuse("no edge joins vertices " + std::to_string(vertices[i - 1]) + " and " +
                                std::to_string(vertices[i]) + " of the curve",
                            "name the vertices of a path along edges"),
                     name);
      }
      path.push_back(*place);
    }
    return path;
  }

 private:
  Status named(const Status& status, const std::string& name) const {
    const std::string prefix = name.empty()      ? prefix_
                               : prefix_.empty() ? name
                                                 : name + ": " + prefix_;
    return prefix.empty() ? status : status.withContext(prefix);
  }

  Result<SurfacePoint> atVertex(Index vertex) const {
    ASSIGN_OR_RETURN(const Index place, namedVertex("a landmark", vertex, subject_.places));
    return vertexPoint(subject_.surface(), place);
  }

  Result<SurfacePoint> inFace(const v1::SurfacePoint& message) const {
    const Index face = message.face();
    const auto faces = subject_.prepared ? static_cast<Index>(subject_.soup.faces.size())
                                         : subject_.surface().faceCount();
    const std::string what = "a landmark in face " + std::to_string(face);
    if (face < 0 || face >= faces) {
      return refuse(what + ", but the mesh has faces 0 to " + std::to_string(faces - 1),
                    "faces are counted from 0 in the file's order, polygons as fans");
    }
    double sum = 0;
    for (const double weight : message.barycentric()) sum += weight;
    SurfacePoint point;
    for (int c = 0; c < 3; ++c) {
      const Index h = subject_.prepared ? halfedge_[3 * face + c] : 3 * face + c;
      if (h == kNone) {
        return refuse(what + ", which is in another component, or was dropped by repair",
                      "take its component with --component, or put the landmark elsewhere");
      }
      point.face = Connectivity::faceOf(h);
      point.barycentric[h % 3] = message.barycentric(c) / sum;
    }
    return point;
  }

  bool areJoined(Index a, Index b) const {
    const Connectivity& surface = subject_.surface();
    const Index first = surface.outgoing(a);
    Index h = first;
    do {
      if (surface.head(h) == b || surface.tail(Connectivity::previous(h)) == b) return a != b;
      h = surface.rotate(h);
    } while (h != kNone && h != first);
    return false;
  }

  const Subject& subject_;
  const std::string prefix_;
  std::vector<Index> halfedge_;  ///< Per corner of the input's faces; kNone where it has none.
};

/// The vertex that a point is; kNone within edges and faces.
Index vertexOf(const Connectivity& surface, const SurfacePoint& point) {
  for (int c = 0; c < 3; ++c) {
    if (point.barycentric[c] == 1) return surface.face(point.face)[c];
  }
  return kNone;
}

/// Puts landmarks of a match together.
class MatchLandmarks {
 public:
  explicit MatchLandmarks(const LandmarkSurfaces& surfaces) : surfaces_(surfaces) {}

  void add(SphereLandmark landmark) {
    vertices_.insert(verticesOf(landmark));
    found_.push_back({landmark.point, landmark.reference, std::move(landmark.name)});
  }

  Status add(const SphereCurve& curve) {
    auto a = points(surfaces_.first, curve.pair.path_a, curve.pair.count);
    if (!a.ok()) return a.status().withContext(curve.name);
    auto b = points(surfaces_.second, curve.pair.path_b, curve.pair.count);
    if (!b.ok()) return b.status().withContext(curve.name + ": on " + surfaces_.second_name);
    for (std::size_t i = 0; i < a->size(); ++i) {
      SphereLandmark landmark{(*a)[i], (*b)[i],
                              curve.name + " (point " + std::to_string(i + 1) + " of the curve)"};
      const auto ends = verticesOf(landmark);
      const bool known = ends.first != kNone && ends.second != kNone && vertices_.contains(ends);
      if (!known) add(std::move(landmark));
    }
    return {};
  }

  std::vector<MatchLandmark> take() { return std::move(found_); }

 private:
  static Result<std::vector<SurfacePoint>> points(const Subject& subject,
                                                  const std::vector<Index>& path, int count) {
    return resampleCurve(subject.surface(), subject.lengths, path, count);
  }

  std::pair<Index, Index> verticesOf(const SphereLandmark& landmark) const {
    return {vertexOf(surfaces_.first.surface(), landmark.point),
            vertexOf(surfaces_.second.surface(), landmark.reference)};
  }

  const LandmarkSurfaces& surfaces_;
  std::set<std::pair<Index, Index>> vertices_;
  std::vector<MatchLandmark> found_;
};

}  // namespace

Result<std::vector<SphereLandmark>> landmarksOnSurfaces(
    const google::protobuf::RepeatedPtrField<v1::LandmarkPair>& pairs,
    const LandmarkSurfaces& surfaces) {
  std::vector<SphereLandmark> landmarks;
  const Side here(surfaces.first, ""), there(surfaces.second, "on " + surfaces.second_name);
  for (const v1::LandmarkPair& pair : pairs) {
    SphereLandmark landmark;
    ASSIGN_OR_RETURN(landmark.point, here.place(pair.point(), pair.name()));
    ASSIGN_OR_RETURN(landmark.reference, there.place(pair.reference(), pair.name()));
    landmark.name =
        pair.name().empty() ? "landmark " + std::to_string(landmarks.size()) : pair.name();
    landmarks.push_back(std::move(landmark));
  }
  return landmarks;
}

Result<std::vector<SphereCurve>> curvesOnSurfaces(
    const google::protobuf::RepeatedPtrField<v1::LandmarkCurve>& messages,
    const LandmarkSurfaces& surfaces) {
  std::vector<SphereCurve> curves;
  const Side here(surfaces.first, ""), there(surfaces.second, "on " + surfaces.second_name);
  for (const v1::LandmarkCurve& message : messages) {
    SphereCurve curve;
    ASSIGN_OR_RETURN(curve.pair.path_a, here.path(message.vertices(), message.name()));
    ASSIGN_OR_RETURN(curve.pair.path_b, there.path(message.reference_vertices(), message.name()));
    curve.pair.count = message.count();
    curve.name = message.name().empty() ? "curve " + std::to_string(curves.size()) : message.name();
    curves.push_back(std::move(curve));
  }
  return curves;
}

Result<std::vector<MatchLandmark>> matchLandmarks(
    const google::protobuf::RepeatedPtrField<v1::LandmarkPair>& pairs,
    const google::protobuf::RepeatedPtrField<v1::LandmarkCurve>& curves, const Subject& a,
    const Subject& b) {
  const LandmarkSurfaces surfaces{a, b, "the second surface"};
  MatchLandmarks result(surfaces);
  ASSIGN_OR_RETURN(std::vector<SphereLandmark> landmarks, landmarksOnSurfaces(pairs, surfaces));
  for (SphereLandmark& landmark : landmarks) result.add(std::move(landmark));
  ASSIGN_OR_RETURN(const std::vector<SphereCurve> found, curvesOnSurfaces(curves, surfaces));
  for (const SphereCurve& curve : found) RETURN_IF_ERROR(result.add(curve));
  return result.take();
}

}  // namespace moduli
