#include "server/service/ingest_call.h"

#include <utility>

#include "server/rpc/grpc_status.h"

namespace moduli {
namespace {

// Enough that a thread finds the next item waiting when it has finished one, and that a run of
// cheap probes keeps the stream full.
constexpr std::size_t kItemsPerThread = 4;

}  // namespace

IngestCall::Reactor* IngestCall::answer(Backend& backend, const grpc::CallbackServerContext& rpc) {
  auto call = std::make_shared<IngestCall>(backend);
  call->self_ = call;
  if (const Status status = call->admit(rpc, call); !status.ok()) {
    call->end(status);
  } else {
    const std::lock_guard lock(call->mutex_);
    call->pump();
  }
  return call.get();
}

IngestCall::IngestCall(Backend& backend)
    : Call(backend, {"IngestShapes", Role::kWriter}),
      limit_(kItemsPerThread * backend.compute.threads()) {}

void IngestCall::OnReadDone(bool ok) {
  if (!ok) {
    const std::lock_guard lock(mutex_);
    reading_ = false;
    reads_done_ = true;
    pump();
  } else if (plan_ == nullptr) {
    takeHeader();
  } else {
    takeItem();
  }
}

// reading_ stays true while request_ is looked at, because any thread that finishes an item would
// start the next read into it.

void IngestCall::takeHeader() {
  if (const Refusal refusal = checkHeader(request_); !refusal.ok()) {
    return end(refusal.status, refusal.field);
  }
  backend_.io.submitWhenRoom([self = self_, header = request_.header()] {
    Result<IngestPlan> plan = guarded([&] { return openIngest(self->backend_, header); });
    if (!plan.ok()) return self->end(plan.status(), "header.parent");
    const std::lock_guard lock(self->mutex_);
    self->plan_ = std::make_shared<const IngestPlan>(*std::move(plan));
    self->reading_ = false;
    self->pump();
  });
}

void IngestCall::takeItem() {
  const Refusal refusal = checkItem(request_);
  if (!request_.has_item()) return end(refusal.status, refusal.field);
  const auto item = std::make_shared<const Item>(std::move(*request_.mutable_item()));
  {
    const std::lock_guard lock(mutex_);
    ++in_flight_;
    reading_ = false;
    pump();
  }
  if (refusal.ok()) {
    start(item);
  } else {
    finishItem(failedItem(*item, *plan_, refusal.status));
  }
}

void IngestCall::start(const std::shared_ptr<const Item>& item) {
  if (!item->probe_digest().empty()) {
    backend_.io.submitWhenRoom([self = self_, plan = plan_, item] {
      if (self->token_.cancelled()) return;
      self->finishItem(probeItem(self->backend_, *plan, *item));
    });
    return;
  }
  backend_.compute.submitWhenRoom([self = self_, plan = plan_, item] {
    Context context = self->makeContext();
    self->finishItem(ingestItem(context, self->backend_, *plan, *item));
  });
}

void IngestCall::finishItem(Outcome outcome) {
  const std::lock_guard lock(mutex_);
  if (closed_ || end_) return;
  outcomes_.push_back(std::move(outcome));
  pump();
}

void IngestCall::pump() {
  if (closed_) return;
  if (end_) {
    if (writing_) return;
    closed_ = true;
    return Finish(*end_);
  }
  if (!writing_ && !outcomes_.empty()) {
    writing_ = true;
    current_ = std::move(outcomes_.front());
    outcomes_.pop_front();
    StartWrite(&current_);
  }
  if (in_flight_ == 0 && (reads_done_ || draining_)) {
    const Status status =
        reads_done_
            ? Status()
            : Status(Reason::kServerDraining, "the server is shutting down and takes no more items",
                     "run the same command again when it is back: what is "
                     "stored is skipped");
    logEnd(status);
    closed_ = true;
    return Finish(toGrpcStatus(status));
  }
  if (!reading_ && !reads_done_ && !draining_ && in_flight_ < limit_) {
    reading_ = true;
    StartRead(&request_);
  }
}

void IngestCall::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    --in_flight_;
    pump();
  }
  if (!ok) stop(cancelReason());
}

void IngestCall::end(const Status& status, std::string_view field) {
  token_.cancel();
  const std::lock_guard lock(mutex_);
  if (closed_ || end_) return;
  logEnd(status);
  outcomes_.clear();
  end_ = toGrpcStatus(status, field);
  pump();
}

void IngestCall::stop(const Status& why) {
  end(why);
}

void IngestCall::drain() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
  pump();
}

void IngestCall::OnCancel() {
  end(cancelReason());
}

void IngestCall::OnDone() {
  ticket_ = {};
  const auto self = std::move(self_);
}

}  // namespace moduli
