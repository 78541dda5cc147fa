#include "core/base/context.h"

namespace moduli {

Status Context::check() const {
  if (token_ && token_->cancelled()) {
    return {Reason::kCancelled, "the caller cancelled the work"};
  }
  if (deadline_ && Clock::now() >= *deadline_) {
    return {Reason::kDeadlineExceeded, "the deadline passed before the work was done",
            "allow more time with --timeout"};
  }
  return {};
}

void Context::report(std::string_view stage, double fraction) {
  if (sink_) sink_({stage, fraction});
}

Context::Stage::Stage(Context& context, std::string name)
    : context_(context), name_(std::move(name)), start_(Clock::now()) {
  context_.report(name_, 0);
}

Context::Stage::~Stage() {
  context_.timing_[name_] += std::chrono::duration<double>(Clock::now() - start_).count();
  context_.report(name_, 1);
}

}  // namespace moduli
