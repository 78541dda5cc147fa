#pragma once

#include <string>
#include <string_view>

namespace moduli {

/// Why a text is no well-formed XML document, as far as programs that draw write such: a
/// declaration, nested elements with quoted and distinct attributes, text with the predefined
/// entities. "" where it is one.
std::string xmlFault(std::string_view text);

}  // namespace moduli
