#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace moduli {

void parallelBlocks(std::size_t count, std::size_t grain,
                    const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(1, grain);
  const std::size_t blocks = (count + grain - 1) / grain;
  const std::size_t workers =
      std::min<std::size_t>(blocks, std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t block = next++; block < blocks; block = next++) {
      body(block * grain, std::min(count, (block + 1) * grain));
    }
  };
  std::vector<std::thread> helpers;
  for (std::size_t i = 1; i < workers; ++i) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
}

}  // namespace moduli
