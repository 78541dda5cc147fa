#include "server/store/shape_record.h"

#include <algorithm>

#include "core/base/text.h"

namespace moduli {
namespace {

bool isAsciiAlphanumeric(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

}  // namespace

std::string_view conformalTypeName(ConformalType type) {
  switch (type) {
    case ConformalType::kSphere:
      return "SPHERE";
    case ConformalType::kDisk:
      return "DISK";
    case ConformalType::kAnnulus:
      return "ANNULUS";
    case ConformalType::kCircleDomain:
      return "CIRCLE_DOMAIN";
    case ConformalType::kTorus:
      return "TORUS";
    case ConformalType::kHyperbolic:
      return "HYPERBOLIC";
    case ConformalType::kBordered:
      return "BORDERED";
  }
  return "";
}

Status validateCollectionName(std::string_view name) {
  const bool good_characters = std::all_of(name.begin(), name.end(), [](char c) {
    return isAsciiAlphanumeric(c) || c == '-' || c == '_' || c == '.';
  });
  if (name.empty() || name.size() > 63 || !good_characters || name[0] == '.' || name[0] == '-') {
    return {Reason::kInvalidName, "this is no name for a collection",
            "use 1 to 63 of a-z A-Z 0-9 - _ . and begin with neither . nor -"};
  }
  return {};
}

Status validateWantedRecall(const std::optional<double>& wanted_recall) {
  if (!wanted_recall || (*wanted_recall > 0 && *wanted_recall < 1)) return {};
  return {Reason::kInvalidOption, "a wanted recall lies between 0 and 1, both excluded",
          "give one such as 0.99, or none for exact search"};
}

Status validateShapeName(std::string_view name) {
  if (name.empty() || name.size() > 1024 || !isPrintableUtf8(name) ||
      name.find('/') != std::string_view::npos) {
    return {Reason::kInvalidName, "this is no name for a shape",
            "use 1 to 1024 bytes of printable UTF-8 without /"};
  }
  return {};
}

Status validateDigest(std::string_view digest) {
  const bool hexadecimal = std::all_of(digest.begin(), digest.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
  });
  if (digest.size() != 64 || !hexadecimal) {
    return {Reason::kInvalidRequest, "a digest is a SHA-256 of 64 lower-case hexadecimal digits"};
  }
  return {};
}

}  // namespace moduli
