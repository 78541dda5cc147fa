#pragma once

#include <string>

/// Help, manual and completion, all made from the table of commands.
namespace moduli::cli {

/// --help of the command or group of this path; of the program for "". Nothing is printed for a
/// path that is not there.
std::string helpPage(const std::string& path);

/// The manual page, as roff: moduli(1) for "", moduli-PATH(1) for a command or group. "" if there
/// is none.
std::string manualPage(const std::string& path);

/// The completion script for bash.
std::string bashCompletion();

}  // namespace moduli::cli
