#pragma once

#include <string>
#include <string_view>

#include "core/base/status.h"

namespace moduli {

/// RFC 4648 with padding, on one line. O(n).
std::string encodeBase64(std::string_view bytes);

/// The bytes that a base64 text spells; white space anywhere is passed over. Takes memory for at
/// most three quarters of the text.
/// Fails with kSyntaxError (another character, padding that is wrong), kTruncatedFile (the last
/// group of four is not whole). The message has no place: the caller knows it. O(n).
Result<std::string> decodeBase64(std::string_view text);

}  // namespace moduli
