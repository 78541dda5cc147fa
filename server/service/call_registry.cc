#include "server/service/call_registry.h"

#include <utility>

namespace moduli {

struct CallRegistry::State {
  mutable std::mutex mutex;
  std::condition_variable emptied;
  std::unordered_map<std::uint64_t, std::weak_ptr<LiveCall>> calls;
  std::uint64_t next_id = 0;
  bool closed = false;
};

CallRegistry::CallRegistry() : state_(std::make_shared<State>()) {}

CallRegistry::~CallRegistry() = default;

Result<CallRegistry::Ticket> CallRegistry::enter(std::weak_ptr<LiveCall> call) {
  const std::lock_guard lock(state_->mutex);
  if (state_->closed) {
    return Status(Reason::kServerDraining, "the server is shutting down and takes no new work",
                  "retry against another server, or when it is back");
  }
  const std::uint64_t id = state_->next_id++;
  state_->calls.emplace(id, std::move(call));
  return Ticket(state_, id);
}

std::vector<std::shared_ptr<LiveCall>> CallRegistry::living() const {
  std::vector<std::shared_ptr<LiveCall>> calls;
  const std::lock_guard lock(state_->mutex);
  for (const auto& [id, call] : state_->calls) {
    if (auto alive = call.lock()) calls.push_back(std::move(alive));
  }
  return calls;
}

void CallRegistry::close() {
  {
    const std::lock_guard lock(state_->mutex);
    if (std::exchange(state_->closed, true)) return;
  }
  for (const auto& call : living()) call->drain();
}

void CallRegistry::stopAll(const Status& why) {
  for (const auto& call : living()) call->stop(why);
}

bool CallRegistry::waitUntilEmpty(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(state_->mutex);
  return state_->emptied.wait_until(lock, deadline, [this] { return state_->calls.empty(); });
}

std::size_t CallRegistry::size() const {
  const std::lock_guard lock(state_->mutex);
  return state_->calls.size();
}

CallRegistry::Ticket::Ticket(std::shared_ptr<State> state, std::uint64_t id)
    : state_(std::move(state)), id_(id) {}

CallRegistry::Ticket::Ticket(Ticket&& other) noexcept
    : state_(std::move(other.state_)), id_(other.id_) {}

CallRegistry::Ticket& CallRegistry::Ticket::operator=(Ticket&& other) noexcept {
  release();
  state_ = std::move(other.state_);
  id_ = other.id_;
  return *this;
}

CallRegistry::Ticket::~Ticket() {
  release();
}

void CallRegistry::Ticket::release() {
  if (!state_) return;
  const std::shared_ptr<State> state = std::move(state_);
  const std::lock_guard lock(state->mutex);
  state->calls.erase(id_);
  if (state->calls.empty()) state->emptied.notify_all();
}

}  // namespace moduli
