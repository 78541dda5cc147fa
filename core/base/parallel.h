#pragma once

#include <cstddef>
#include <functional>

namespace moduli {

/// Calls body(begin, end) for consecutive blocks that cover [0, count), on up to one thread per
/// processor. The blocks depend on count and grain alone, never on the number of threads: a body
/// that writes only to its own block, or to one slot per block, gives the same bytes everywhere.
/// grain: elements per block, at least 1. Returns when all blocks are done. body must not throw.
void parallelBlocks(std::size_t count, std::size_t grain,
                    const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace moduli
