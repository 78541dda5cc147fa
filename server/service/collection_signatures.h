#pragma once

#include <string>
#include <vector>

#include "core/base/context.h"
#include "core/signature/signature.h"
#include "server/store/catalog.h"

/// All signatures of a collection at once, for what compares every shape with every other.
namespace moduli {

/// Collections beyond this are refused: comparing takes time and memory with its square.
inline constexpr std::size_t kMostCompared = 20'000;

struct SignedShape {
  std::string name, label, digest;
  Signature signature;
};

/// The shapes that pass the filter, by ascending digest and name: an order that says nothing of
/// labels. Shapes of another descriptor version or whose signature cannot be read are left out.
/// Fails with kCollectionNotFound, kInvalidOption (more than kMostCompared), kCancelled,
/// kDeadlineExceeded and the catalogue's reasons.
Result<std::vector<SignedShape>> signaturesOf(Context& context, const Catalog& catalog,
                                              const std::string& collection, const Filter& filter);

}  // namespace moduli
