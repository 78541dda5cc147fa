#pragma once

#include <string>
#include <string_view>

#include "core/base/status.h"
#include "server/store/search.h"

/// Page tokens of searches: "go on behind this hit".
namespace moduli {

/// request: all of the request that has to stay the same from page to page. state: what the request
/// stood for when the page was made (its collection, its query's numbers).
std::string makeSearchToken(std::string_view request, std::string_view state,
                            const SearchPosition& position);

/// Whether `token` is one of this request; "" is. Otherwise kInvalidPageToken.
Status checkSearchToken(std::string_view request, std::string_view token);

/// The position of a token that is not "". Fails with kInvalidPageToken if it is no token, one of
/// another request, or if the request stands for something else by now.
Result<SearchPosition> readSearchToken(std::string_view request, std::string_view state,
                                       std::string_view token);

}  // namespace moduli
