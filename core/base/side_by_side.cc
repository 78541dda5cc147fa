#include "core/base/side_by_side.h"

#include <thread>

namespace moduli {

void sideBySide(Context& context, const std::function<void(Context&)>& first,
                const std::function<void(Context&)>& second) {
  Context copy = context;
  copy.setProgressSink({});
  std::thread other([&] { second(copy); });
  first(context);
  other.join();
}

}  // namespace moduli
