#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cli/command.h"
#include "moduli/v1/parameterization.pb.h"

/// What `parameterize` takes for its targets flat, polycube, atlas and quads alone.
namespace moduli::cli {

std::vector<OptionSpec> planeOptions();

/// What is wrong with them, if anything. The word "auto" of --cones is judged here, too.
std::optional<std::string> checkPlaneOptions(const Arguments& arguments);

/// True where --cones names no file.
bool choosesCones(const Arguments& arguments);

/// Precondition: checked.
void setPlaneOptions(const Arguments& arguments, v1::ParameterizationOptions& options);

}  // namespace moduli::cli
