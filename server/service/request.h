#pragma once

#include <string>
#include <string_view>

#include "core/base/status.h"
#include "moduli/v1/matching.pb.h"
#include "moduli/v1/mesh.pb.h"
#include "moduli/v1/parameterization.pb.h"
#include "moduli/v1/signature.pb.h"
#include "server/service/call.h"

/// Checks of requests that cost nothing and need no store, so that they are made before a request
/// takes a place in the queue. `field` is the path of the checked field in the request.
namespace moduli {

/// The parts of "collections/{collection}/shapes/{shape}".
struct ShapePath {
  std::string collection;
  std::string shape;
};

/// Fail with kInvalidName.
Result<std::string> parseCollectionName(std::string_view name);
Result<ShapePath> parseShapeName(std::string_view name);

/// The ways back.
std::string collectionName(std::string_view collection);
std::string shapeName(std::string_view collection, std::string_view shape);

Refusal checkCollectionName(std::string_view name, const std::string& field);
Refusal checkShapeName(std::string_view name, const std::string& field);
Refusal checkDigest(std::string_view digest, const std::string& field);

/// One kind of source is there, is well-formed, and inline bytes are at most kMaxInlineBytes.
Refusal checkSource(const v1::MeshSource& source, const std::string& field);
/// all: whether a request treats every component.
Refusal checkPrepare(const v1::PrepareOptions& options, const std::string& field, bool all = false);
Refusal checkSpace(v1::Signature::Space space, const std::string& field);
/// A page_size is not negative.
Refusal checkPageSize(int size);
/// There is a target, every choice is known, cones have sound numbers, and a registration has a
/// well-formed reference, fields that go together, and landmarks that can be.
Refusal checkParameterization(const v1::ParameterizationOptions& options, const std::string& field);
/// Landmarks are such that can be.
Refusal checkMatch(const v1::MatchOptions& options, const std::string& field);

/// The first of them that is a refusal.
template <typename... Refusals>
Refusal firstOf(const Refusals&... refusals) {
  Refusal first;
  ((first = first.ok() ? refusals : first), ...);
  return first;
}

}  // namespace moduli
