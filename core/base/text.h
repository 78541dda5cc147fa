#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace moduli {

/// The shortest decimal text that reads back as exactly this double; "nan" and "inf" as such.
std::string shortestDouble(double value);

/// The double or integer that the whole of `text` spells (no blanks around it, "." as the point
/// whatever the locale), or nothing.
std::optional<double> parseDouble(std::string_view text);
std::optional<long long> parseInteger(std::string_view text);

/// "3, 5, 8 and 12 more": up to `limit` of the numbers, for messages.
std::string listSome(const std::vector<int>& numbers, std::size_t total, std::size_t limit = 5);

/// As text between the tags of an XML file; a carriage return, too, which would be read back as a
/// line feed.
std::string xmlText(std::string_view text);

/// True for well-formed UTF-8 without control characters.
bool isPrintableUtf8(std::string_view text);

}  // namespace moduli
