#include "server/service/request.h"

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

Refusal checkPrepare(const v1::PrepareOptions& options, const std::string& field) {
  if (options.has_fill_holes() &&
      !(std::isfinite(options.fill_holes()) && options.fill_holes() > 0)) {
    return {{Reason::kInvalidOption, "fill_holes is not a positive number",
             "give a fraction of the square root of the area, such as 0.5"},
            field + ".fill_holes"};
  }
  const std::string& component = options.component();
  if (component.empty() || component == "largest") return {};
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
      checkCones(options, field), checkCorners(options, field), checkMobius(options, field));
}

}  // namespace moduli
