#pragma once

#include <string>
#include <vector>

#include "client/cli/command.h"

namespace moduli::cli {

/// What a command line asks for.
struct Request {
  enum class Kind { kRun, kHelp, kUsageError };
  Kind kind = Kind::kRun;
  const CommandSpec* command = nullptr;  ///< kRun.
  Arguments arguments;
  Arguments globals;
  std::vector<std::string> passed_on;  ///< Of a command that hands everything on.
  std::string path;                    ///< Of the command as far as it was recognized.
  std::string complaint;               ///< kUsageError.
};

/// Reads the words after the program's name. Global options count wherever they stand; the last
/// one wins.
Request parse(std::vector<std::string> words);

}  // namespace moduli::cli
