#include "tests/bench/retrieval/variants.h"

#include <functional>
#include <map>
#include <string_view>
#include <utility>

#include "core/mesh/connectivity.h"
#include "core/mesh/sample_tools.h"
#include "tests/bench/retrieval/deform.h"
#include "tests/bench/retrieval/remesh.h"

namespace moduli {
namespace {

using Change = std::function<Result<TriangleSoup>(const BaseShape&, SampleRandom&)>;

TriangleSoup noisy(const BaseShape& base, double share, SampleRandom& random) {
  return withNoise(base.soup, share * boundingDiagonal(base.soup), random);
}

// By kind; an absent `other` gives an empty soup.
const std::vector<std::pair<std::string, Change>>& changes() {
  using Base = BaseShape;
  using Random = SampleRandom;
  static const std::vector<std::pair<std::string, Change>> all = {
      {"original", [](const Base& b, Random&) { return b.soup; }},
      {"rigid", [](const Base& b, Random&) { return b.soup; }},
      {"half", [](const Base& b, Random&) { return simplified(b.soup, b.soup.faces.size() / 2); }},
      {"quarter",
       [](const Base& b, Random&) { return simplified(b.soup, b.soup.faces.size() / 4); }},
      {"refined", [](const Base& b, Random& r) { return refinedUnevenly(b.soup, r); }},
      {"noise-light", [](const Base& b, Random& r) { return noisy(b, 0.001, r); }},
      {"noise", [](const Base& b, Random& r) { return noisy(b, 0.005, r); }},
      {"bent", [](const Base& b, Random& r) { return bent(b.soup, 2.1, 0.45, r); }},
      {"articulated", [](const Base& b, Random& r) { return articulated(b.soup, r); }},
      {"bulge",
       [](const Base& b, Random& r) {
         const double diagonal = boundingDiagonal(b.soup);
         return bulged(b.soup, 0.06 * diagonal, 0.07 * diagonal, r);
       }},
      {"hole", [](const Base& b, Random& r) { return punched(b.soup, 0.03, r); }},
      {"inverted", [](const Base& b, Random& r) { return inverted(b.soup, 0.5, r); }},
      {"other", [](const Base& b, Random&) { return b.other ? *b.other : TriangleSoup{}; }}};
  return all;
}

// FNV-1a.
std::uint64_t seedOf(std::string_view text, std::size_t seed) {
  std::uint64_t hash = 0xCBF29CE484222325U ^ seed;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return hash;
}

Result<Index> eulerCharacteristic(const TriangleSoup& soup) {
  ASSIGN_OR_RETURN(const Connectivity surface,
                   Connectivity::fromFaces(static_cast<Index>(soup.vertices.size()), soup.faces));
  return surface.eulerCharacteristic();
}

Status checkVariant(const BaseShape& base, const Variant& variant) {
  ASSIGN_OR_RETURN(const Index before, eulerCharacteristic(base.soup));
  Result<Index> after = eulerCharacteristic(variant.soup);
  if (!after.ok()) return after.status().withContext(variant.name);
  const Index expected = variant.kind == "hole" ? before - 1 : before;
  if (*after == expected) return {};
  return {Reason::kInternal, variant.name + " has Euler characteristic " + std::to_string(*after) +
                                 " instead of " + std::to_string(expected)};
}

}  // namespace

const std::vector<std::string>& variantKinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& [kind, change] : changes()) list.push_back(kind);
    return list;
  }();
  return names;
}

Result<std::vector<Variant>> makeVariants(const BaseShape& base, std::size_t seed) {
  std::vector<Variant> variants;
  for (const auto& [kind, change] : changes()) {
    Variant variant{base.label + '-' + kind, base.label, kind, {}};
    SampleRandom random(seedOf(variant.name, seed));
    ASSIGN_OR_RETURN(variant.soup, change(base, random));
    if (variant.soup.faces.empty()) continue;
    if (kind != "original") variant.soup = movedAndRenumbered(variant.soup, random);
    RETURN_IF_ERROR(checkVariant(base, variant));
    variants.push_back(std::move(variant));
  }
  return variants;
}

}  // namespace moduli
