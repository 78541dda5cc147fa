#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/status.h"

namespace moduli {

inline constexpr int kDefaultPageSize = 100;
inline constexpr int kMaxPageSize = 1000;

/// Which page of a list, as it stands in a List request.
struct PageRequest {
  int size = 0;       ///< 0: kDefaultPageSize; more than kMaxPageSize: kMaxPageSize.
  std::string token;  ///< "" for the first page, then the next_token of the page before.
};

/// The number of rows to answer; kInvalidRequest for a negative size.
Result<std::size_t> effectivePageSize(const PageRequest& page);

/// An opaque token for "go on after `last`" in the list described by `query` (parent and filter).
std::string makePageToken(std::string_view query, std::string_view last);

/// The `last` of a token, "" for an empty token. Fails with kInvalidPageToken if it is no token or
/// one of another query.
Result<std::string> readPageToken(std::string_view query, std::string_view token);

}  // namespace moduli
