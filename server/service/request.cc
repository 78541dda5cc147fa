#include "server/service/request.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "server/store/shape_record.h"

namespace moduli {
namespace {

constexpr std::string_view kCollections = "collections/";
constexpr std::string_view kShapes = "/shapes/";

Refusal refuse(const Status& status, const std::string& field) {
  return status.ok() ? Refusal{} : Refusal{status, field};
}

Refusal checkChoice(bool known, const std::string& name, int value, const std::string& field) {
  if (known) return {};
  return {{Reason::kInvalidOption, name + " " + std::to_string(value) + " is none of ours",
           "give one that parameterization.proto lists"},
          field + "." + name};
}

Refusal checkCones(const v1::ParameterizationOptions& options, const std::string& field) {
  for (int i = 0; i < options.cones_size(); ++i) {
    const std::string cone = field + ".cones[" + std::to_string(i) + "]";
    if (options.cones(i).vertex() < 0) {
      return {
          {Reason::kInvalidOption, "a cone at vertex " + std::to_string(options.cones(i).vertex()),
           "vertices are counted from 0 in the file's order"},
          cone + ".vertex"};
    }
    if (!std::isfinite(options.cones(i).curvature())) {
      return {{Reason::kInvalidOption,
               "a cone at vertex " + std::to_string(options.cones(i).vertex()) +
                   " whose curvature is not finite",
               "give radians below 2 pi"},
              cone + ".curvature"};
    }
  }
  return {};
}

}  // namespace

Result<std::string> parseCollectionName(std::string_view name) {
  if (!name.starts_with(kCollections)) {
    return Status(Reason::kInvalidName, "not the name of a collection",
                  "give collections/COLLECTION");
  }
  const std::string_view collection = name.substr(kCollections.size());
  RETURN_IF_ERROR(validateCollectionName(collection));
  return std::string(collection);
}

Result<ShapePath> parseShapeName(std::string_view name) {
  const std::size_t slash = name.find('/', kCollections.size());
  if (!name.starts_with(kCollections) || slash == std::string_view::npos ||
      !name.substr(slash).starts_with(kShapes)) {
    return Status(Reason::kInvalidName, "not the name of a shape",
                  "give collections/COLLECTION/shapes/SHAPE");
  }
  ASSIGN_OR_RETURN(std::string collection, parseCollectionName(name.substr(0, slash)));
  const std::string_view shape = name.substr(slash + kShapes.size());
  RETURN_IF_ERROR(validateShapeName(shape));
  return ShapePath{std::move(collection), std::string(shape)};
}

std::string collectionName(std::string_view collection) {
  return std::string(kCollections) + std::string(collection);
}

std::string shapeName(std::string_view collection, std::string_view shape) {
  return collectionName(collection) + std::string(kShapes) + std::string(shape);
}

Refusal checkCollectionName(std::string_view name, const std::string& field) {
  return refuse(parseCollectionName(name).status(), field);
}

Refusal checkShapeName(std::string_view name, const std::string& field) {
  return refuse(parseShapeName(name).status(), field);
}

Refusal checkDigest(std::string_view digest, const std::string& field) {
  return refuse(validateDigest(digest), field);
}

Refusal checkSource(const v1::MeshSource& source, const std::string& field) {
  switch (source.source_case()) {
    case v1::MeshSource::kInline:
      if (source.inline_().size() <= kMaxInlineBytes) return {};
      return {{Reason::kMessageTooLarge,
               "an inline mesh of " + std::to_string(source.inline_().size()) +
                   " bytes is above the limit of " + std::to_string(kMaxInlineBytes),
               "send it by UploadMesh and give its digest"},
              field + ".inline"};
    case v1::MeshSource::kDigest:
      return checkDigest(source.digest(), field + ".digest");
    case v1::MeshSource::kShape:
      return checkShapeName(source.shape(), field + ".shape");
    case v1::MeshSource::SOURCE_NOT_SET:
      break;
  }
  return {{Reason::kInvalidRequest, "no mesh is given",
           "set one of inline, digest and shape in the source"},
          field};
}

Refusal checkPrepare(const v1::PrepareOptions& options, const std::string& field, bool all) {
  if (options.has_fill_holes() &&
      !(std::isfinite(options.fill_holes()) && options.fill_holes() > 0)) {
    return {{Reason::kInvalidOption, "fill_holes is not a positive number",
             "give a fraction of the square root of the area, such as 0.5"},
            field + ".fill_holes"};
  }
  const std::string& component = options.component();
  if (component.empty() || component == "largest") return {};
  if (component == "all") {
    if (all) return {};
    return {{Reason::kInvalidOption, "this takes one component, not all of them",
             "give \"largest\" or a number counted from 0"},
            field + ".component"};
  }
  if (const auto number = parseInteger(component); number && *number >= 0) return {};
  return {{Reason::kInvalidOption, "no component is called \"" + component + "\"",
           "give \"largest\" or a number counted from 0"},
          field + ".component"};
}

Refusal checkSpace(v1::Signature::Space space, const std::string& field) {
  if (v1::Signature::Space_IsValid(space)) return {};
  return {{Reason::kInvalidOption, "space " + std::to_string(space) + " is none of ours",
           "give CONFORMAL, METRIC or SHAPE"},
          field};
}

Refusal checkPageSize(int size) {
  if (size >= 0) return {};
  return {{Reason::kInvalidRequest, "page_size is negative", "give 0 for the usual size"},
          "page_size"};
}

namespace {

Refusal checkCorners(const v1::ParameterizationOptions& options, const std::string& field) {
  const bool wanted = options.target() == v1::ParameterizationOptions::RECTANGLE;
  if (options.corners_size() == (wanted ? 4 : 0)) return {};
  const std::string count = std::to_string(options.corners_size());
  return {{Reason::kInvalidOption,
           wanted ? "a rectangle has four corners, not " + count
                  : "corners are those of a RECTANGLE, which is not the target",
           "name four boundary vertices in their order, the surface on the left"},
          field + ".corners"};
}

/// Options that the target does not look at were meant for another one; defaults fit all.
Refusal checkTarget(const v1::ParameterizationOptions& options, const std::string& field) {
  using Options = v1::ParameterizationOptions;
  const auto refuse = [&](const std::string& what, const std::string& whose,
                          const std::string& name) {
    return Refusal{
        {Reason::kInvalidOption,
         what + " of " + whose + ", and the target is " + Options::Target_Name(options.target()),
         "leave it out, or choose that target"},
        field + "." + name};
  };
  const bool has_cones = options.target() == Options::FLAT || options.target() == Options::POLYCUBE;
  if (!has_cones) {
    if (!options.cones().empty()) return refuse("cones are", "FLAT and POLYCUBE maps", "cones");
    if (options.has_cone_choice())
      return refuse("the choice of cones is that", "FLAT and POLYCUBE maps", "cone_choice");
  }
  if (!has_cones && options.target() != Options::QUADS && options.has_cut_overlaps()) {
    return refuse("cuts where it lies on itself are those", "FLAT, POLYCUBE and QUADS maps",
                  "cut_overlaps");
  }
  if (options.target() != Options::FLAT) {
    if (options.boundary() != 0)
      return refuse("rules for the boundary are those", "FLAT maps", "boundary");
    if (options.scheme() > Options::VERTEX_SCALING)
      return refuse("the scheme is that", "FLAT maps", "scheme");
    if (options.solver() > Options::NEWTON)
      return refuse("the solver is that", "FLAT maps", "solver");
  }
  if (!has_cones && options.target() != Options::ATLAS) {
    if (!options.seams().empty())
      return refuse("seams are those", "FLAT, POLYCUBE and ATLAS maps", "seams");
    if (options.has_margin())
      return refuse("the margin is that", "FLAT, POLYCUBE and ATLAS maps", "margin");
  }
  if (options.target() != Options::ATLAS && !options.extraordinary().empty())
    return refuse("extraordinary points are those", "an ATLAS", "extraordinary");
  if (options.target() != Options::QUADS && options.has_most_squares())
    return refuse("the number of squares is that", "QUADS", "most_squares");
  const bool has_methods = options.target() == Options::SPHERE ||
                           options.target() == Options::DISK ||
                           options.target() == Options::CIRCLE_DOMAIN;
  if (options.method() > Options::AUTO && !has_methods) {
    return refuse("the method is that", "SPHERE, DISK and CIRCLE_DOMAIN", "method");
  }
  return {};
}

Refusal checkConeChoice(const v1::ParameterizationOptions& options, const std::string& parent) {
  using Options = v1::ParameterizationOptions;
  if (!options.has_cone_choice()) return {};
  const v1::ConeChoice& choice = options.cone_choice();
  const std::string field = parent + ".cone_choice";
  if (!options.cones().empty()) {
    return {{Reason::kInvalidOption, "cones are given, and are to be chosen, too",
             "give them or have them chosen"},
            field};
  }
  if (options.boundary() != Options::BOUNDARY_UNSPECIFIED && options.boundary() != Options::FREE) {
    return {{Reason::kInvalidOption, "chosen cones lie inside, and leave the boundary free",
             "leave the rule for the boundary out, or name the cones"},
            parent + ".boundary"};
  }
  if (choice.has_spread() && !(std::isfinite(choice.spread()) && choice.spread() > 0)) {
    return {{Reason::kInvalidOption, "the spread is not a positive number",
             "give a difference of logarithms such as 1"},
            field + ".spread"};
  }
  if (choice.has_most() && choice.most() < 0) {
    return {{Reason::kInvalidOption, "the number of cones is negative", "give 0 or more"},
            field + ".most"};
  }
  if (choice.quarter_turns() && options.target() != Options::FLAT) {
    return {{Reason::kInvalidOption, "corners of a POLYCUBE have quarter turns in any case",
             "leave quarter_turns out"},
            field + ".quarter_turns"};
  }
  return {};
}

Refusal checkSeams(const v1::ParameterizationOptions& options, const std::string& field) {
  for (int n = 0; n < options.seams_size(); ++n) {
    if (options.seams(n).vertices_size() >= 2) continue;
    return {{Reason::kInvalidOption, "a seam has fewer than two vertices",
             "name the vertices along it"},
            field + ".seams[" + std::to_string(n) + "]"};
  }
  if (options.has_margin() && !(std::isfinite(options.margin()) && options.margin() >= 0)) {
    return {{Reason::kInvalidOption, "the margin between islands is negative or no number",
             "give a fraction of the root of the area, such as 0.01"},
            field + ".margin"};
  }
  return {};
}

Refusal checkQuads(const v1::ParameterizationOptions& options, const std::string& field) {
  if (!options.has_most_squares()) return {};
  if (std::isfinite(options.most_squares()) && options.most_squares() > 0) return {};
  return {{Reason::kInvalidOption, "the number of squares is not a positive number",
           "give some thousand"},
          field + ".most_squares"};
}

Refusal checkMobius(const v1::ParameterizationOptions& options, const std::string& field) {
  using Options = v1::ParameterizationOptions;
  if (options.mobius().empty()) return {};
  if (options.target() != Options::SPHERE && options.target() != Options::DISK) {
    return {{Reason::kInvalidOption, "Möbius maps move a SPHERE or a DISK, which is not the target",
             "leave the map out"},
            field + ".mobius"};
  }
  if (options.mobius_size() == 4) return {};
  return {{Reason::kInvalidOption,
           "a Möbius map has four coefficients, not " + std::to_string(options.mobius_size()),
           "give a, b, c and d of z -> (a z + b) / (c z + d)"},
          field + ".mobius"};
}

constexpr int kMostLandmarks = 2000;
constexpr int kMostOfCurve = 1000;

bool isSound(const v1::SurfacePoint& point) {
  if (point.has_vertex()) return point.vertex() >= 0 && point.barycentric().empty();
  if (!point.has_face() || point.face() < 0 || point.barycentric_size() != 3) return false;
  double sum = 0;
  for (const double weight : point.barycentric()) {
    if (!(weight >= 0)) return false;
    sum += weight;
  }
  return std::abs(sum - 1) <= 1e-3;
}

/// prefix: of the fields' names, "" or "soft_". second: what the other surface is called.
Refusal checkLandmarks(const google::protobuf::RepeatedPtrField<v1::LandmarkPair>& landmarks,
                       const google::protobuf::RepeatedPtrField<v1::LandmarkCurve>& curves,
                       const std::string& field, const std::string& prefix,
                       const std::string& second) {
  const auto refuse = [](const std::string& name, const std::string& why,
                         const std::string& where) {
    return Refusal{{Reason::kInvalidOption, name.empty() ? why : name + ": " + why,
                    "give a vertex, or a face and three weights of sum 1, of both surfaces"},
                   where};
  };
  int count = landmarks.size();
  for (int i = 0; i < landmarks.size(); ++i) {
    const v1::LandmarkPair& pair = landmarks[i];
    const std::string where = field + "." + prefix + "landmarks[" + std::to_string(i) + "]";
    if (!isSound(pair.point())) {
      return refuse(pair.name(), "a landmark is no point of a surface", where + ".point");
    }
    if (!isSound(pair.reference())) {
      return refuse(pair.name(), "a landmark is no point of " + second, where + ".reference");
    }
  }
  for (int i = 0; i < curves.size(); ++i) {
    const v1::LandmarkCurve& curve = curves[i];
    const std::string where = field + "." + prefix + "curves[" + std::to_string(i) + "]";
    if (curve.count() < 2 || curve.count() > kMostOfCurve) {
      return refuse(curve.name(),
                    "a curve of " + std::to_string(curve.count()) + " landmarks, not 2 to " +
                        std::to_string(kMostOfCurve),
                    where + ".count");
    }
    if (curve.vertices_size() < 2 || curve.reference_vertices_size() < 2) {
      return refuse(curve.name(), "a curve of less than two vertices", where);
    }
    count += std::min(curve.count(), kMostLandmarks);
    if (count > kMostLandmarks) break;
  }
  if (count <= kMostLandmarks) return {};
  return {{Reason::kInvalidOption,
           "there are more than " + std::to_string(kMostLandmarks) +
               " landmarks, those of curves among them",
           "leave some out"},
          field};
}

/// A source of values: no stored shape, which has none.
Refusal checkValues(const v1::MeshSource& source, const std::string& field) {
  if (!source.has_shape()) return checkSource(source, field);
  return {{Reason::kInvalidRequest, "a stored shape has no values at its vertices",
           "set one of inline and digest in the source"},
          field + ".shape"};
}

Refusal checkFields(const v1::SphereRegistration& registration, const std::string& field) {
  const bool by_landmarks = !registration.landmarks().empty() || !registration.curves().empty();
  if (registration.has_field() && !registration.has_reference_field()) {
    return {{Reason::kInvalidOption, "a field of the surface has none of the reference beside it",
             "give reference_field, too"},
            field + ".reference_field"};
  }
  if (registration.has_reference_field() && !registration.has_field() && !by_landmarks) {
    return {{Reason::kInvalidOption,
             "a field of the reference has none of the surface beside it, and no landmarks",
             "give field, too"},
            field + ".field"};
  }
  Refusal refusal;
  if (registration.has_field()) refusal = checkValues(registration.field(), field + ".field");
  if (refusal.ok() && registration.has_reference_field()) {
    refusal = checkValues(registration.reference_field(), field + ".reference_field");
  }
  return refusal;
}

Refusal checkRegistration(const v1::ParameterizationOptions& options, const std::string& parent) {
  if (!options.has_registration()) return {};
  const std::string field = parent + ".registration";
  if (options.target() != v1::ParameterizationOptions::SPHERE) {
    return {{Reason::kInvalidOption, "what is registered is a SPHERE, which is not the target",
             "set target to SPHERE, or leave the registration out"},
            field};
  }
  if (!options.mobius().empty()) {
    return {{Reason::kInvalidOption,
             "a registration says where the sphere lies, and a Möbius map would move it",
             "give one of the two"},
            parent + ".mobius"};
  }
  const v1::SphereRegistration& registration = options.registration();
  return firstOf(
      checkSource(registration.reference(), field + ".reference"), checkFields(registration, field),
      checkLandmarks(registration.landmarks(), registration.curves(), field, "", "the reference"));
}

}  // namespace

Refusal checkParameterization(const v1::ParameterizationOptions& options,
                              const std::string& field) {
  using Options = v1::ParameterizationOptions;
  if (options.target() == Options::TARGET_UNSPECIFIED) {
    return {{Reason::kInvalidRequest, "no target is given",
             "set target, for instance to SPHERE or FLAT"},
            field + ".target"};
  }
  return firstOf(
      checkChoice(Options::Target_IsValid(options.target()), "target", options.target(), field),
      checkChoice(Options::Boundary_IsValid(options.boundary()), "boundary", options.boundary(),
                  field),
      checkChoice(Options::Scheme_IsValid(options.scheme()), "scheme", options.scheme(), field),
      checkChoice(Options::Solver_IsValid(options.solver()), "solver", options.solver(), field),
      checkChoice(Options::Method_IsValid(options.method()), "method", options.method(), field),
      checkTarget(options, field), checkCones(options, field), checkCorners(options, field),
      checkConeChoice(options, field), checkSeams(options, field), checkQuads(options, field),
      checkMobius(options, field), checkRegistration(options, field));
}

Refusal checkMatch(const v1::MatchOptions& options, const std::string& field) {
  const std::string second = "the second surface";
  if (options.alternative() < 0) {
    return {{Reason::kInvalidOption, "the number of an answer is negative", "0 is the best one"},
            field + ".alternative"};
  }
  return firstOf(
      checkLandmarks(options.landmarks(), options.curves(), field, "", second),
      checkLandmarks(options.soft_landmarks(), options.soft_curves(), field, "soft_", second));
}

}  // namespace moduli
