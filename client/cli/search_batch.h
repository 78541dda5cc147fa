#pragma once

#include "client/cli/command.h"
#include "client/cli/session.h"

/// The part of `search` that looks for many shapes at once.
namespace moduli::cli {

/// Whether more than one shape is asked for, or a list of them.
bool isBatch(const Arguments& arguments);

/// Prints a list of hits for each; those that fail do not stop the others, and make the run fail in
/// the end.
Status runSearchBatch(Session& session, const Arguments& arguments);

}  // namespace moduli::cli
