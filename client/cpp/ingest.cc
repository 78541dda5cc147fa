#include "client/cpp/ingest.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "client/cpp/client_impl.h"

namespace moduli {
namespace {

using Stream = grpc::ClientReaderWriter<v1::IngestShapesRequest, v1::IngestShapesResponse>;

// Files whose presence is being asked for, beside those that are being sent.
constexpr std::size_t kProbeWindow = 64;

// Failures that end the run rather than one item.
bool endsTheRun(const Status& status) {
  switch (status.code()) {
    case ErrorCode::kCancelled:
    case ErrorCode::kDeadlineExceeded:
    case ErrorCode::kUnavailable:
    case ErrorCode::kUnimplemented:
    case ErrorCode::kUnauthenticated:
    case ErrorCode::kPermissionDenied:
      return true;
    default:
      return false;
  }
}

IngestOutcome failedOutcome(const Status& status) {
  IngestOutcome outcome;
  outcome.reason = reasonName(status.reason());
  outcome.message = status.message();
  outcome.hint = status.hint();
  return outcome;
}

IngestOutcome outcomeOf(const v1::IngestShapesResponse& response) {
  return {response.outcome(), response.name(), response.reason(), response.message(),
          response.hint()};
}

/// One run: the calling thread writes, a second one reads. Every item is in pending_ from its probe
/// to its answer, so that a new stream can ask for all of them again.
class IngestRun {
 public:
  using Service = v1::CatalogService::Stub;
  using MakeSource = std::function<Result<v1::MeshSource>(
      const MeshBytes&, const std::string&, const std::string&, v1::MeshSource::Format)>;

  IngestRun(CallRunner& runner, Service& catalog, MakeSource make_source,
            const IngestOptions& options, const IngestSource& next, const IngestListener& listener)
      : runner_(runner),
        catalog_(catalog),
        make_source_(std::move(make_source)),
        options_(options),
        next_(next),
        listener_(listener) {}

  Status run() {
    Backoff backoff = runner_.makeBackoff();
    while (true) {
      const grpc::Status status = runStream();
      RETURN_IF_ERROR(fatal_);
      if (status.ok() && exhausted_ && pending_.empty()) return {};
      if (status.ok()) {
        return {Reason::kInternal, "the server ended the stream before all items were answered",
                "run the same command again"};
      }
      if (answered_ > 0) backoff.reset();
      if (!runner_.waitToRetry(status, backoff)) {
        RETURN_IF_ERROR(runner_.check());
        return fromGrpcStatus(status);
      }
    }
  }

 private:
  enum class Step { kNew, kProbe, kSend, kDone, kStreamOver };

  struct Pending {
    IngestItem item;
    MeshBytes bytes;
    std::string digest;
    bool sending = false;
  };

  grpc::Status runStream() {
    CallRunner::Attempt attempt(runner_);
    const auto stream = catalog_.IngestShapes(&attempt.context());
    startOver();
    v1::IngestShapesRequest header;
    *header.mutable_header() = options_.header;
    std::thread reader([this, &stream] { readOutcomes(*stream); });
    if (stream->Write(header)) writeItems(*stream);
    if (!fatal_.ok()) attempt.context().TryCancel();
    stream->WritesDone();
    reader.join();
    return stream->Finish();
  }

  void startOver() {
    const std::lock_guard lock(mutex_);
    to_send_.clear();
    to_probe_.clear();
    sending_ = 0;
    answered_ = 0;
    stream_over_ = false;
    for (auto& [index, pending] : pending_) {
      pending.sending = false;
      to_probe_.push_back(index);
    }
  }

  void writeItems(Stream& stream) {
    while (fatal_.ok()) {
      const auto [step, index] = nextStep();
      switch (step) {
        case Step::kDone:
        case Step::kStreamOver:
          return;
        case Step::kNew:
          takeNext();
          break;
        case Step::kProbe:
          if (!writeProbe(stream, index)) return;
          break;
        case Step::kSend:
          if (!writeMesh(stream, index)) return;
          break;
      }
    }
  }

  // Waits until there is something to do, and says what.
  std::pair<Step, int> nextStep() {
    std::unique_lock lock(mutex_);
    while (true) {
      if (stream_over_) return {Step::kStreamOver, 0};
      if (!to_send_.empty() && sending_ < options_.jobs) {
        return {Step::kSend, takeFront(to_send_)};
      }
      if (!to_probe_.empty()) return {Step::kProbe, takeFront(to_probe_)};
      if (!exhausted_ && pending_.size() < kProbeWindow + options_.jobs) return {Step::kNew, 0};
      if (exhausted_ && pending_.empty()) return {Step::kDone, 0};
      wake_.wait(lock);
    }
  }

  static int takeFront(std::deque<int>& queue) {
    const int index = queue.front();
    queue.pop_front();
    return index;
  }

  void takeNext() {
    std::optional<IngestItem> item = next_();
    if (!item) {
      const std::lock_guard lock(mutex_);
      exhausted_ = true;
      return;
    }
    Result<MeshBytes> bytes = MeshBytes::ofFile(item->path);
    Result<std::string> digest = bytes.ok() ? bytes->digest() : bytes.status();
    if (!digest.ok()) {
      tell(*item, failedOutcome(digest.status()));
      return;
    }
    const std::lock_guard lock(mutex_);
    const int index = next_index_++;
    pending_.emplace(index, Pending{*std::move(item), *std::move(bytes), *std::move(digest)});
    to_probe_.push_back(index);
  }

  bool writeProbe(Stream& stream, int index) {
    v1::IngestShapesRequest request;
    v1::IngestShapesRequest::Item& item = *request.mutable_item();
    item.set_index(index);
    {
      const std::lock_guard lock(mutex_);
      const Pending& pending = pending_.at(index);
      item.set_shape_id(pending.item.shape_id);
      item.set_probe_digest(pending.digest);
    }
    return stream.Write(request);
  }

  bool writeMesh(Stream& stream, int index) {
    Pending pending = startSending(index);
    const std::string file_name = std::filesystem::path(pending.item.path).filename().string();
    Result<v1::MeshSource> source =
        make_source_(pending.bytes, pending.digest, file_name, pending.item.format);
    if (!source.ok()) {
      if (endsTheRun(source.status())) {
        fatal_ = source.status();
        return false;
      }
      finish(index, failedOutcome(source.status()));
      return true;
    }
    v1::IngestShapesRequest request;
    v1::IngestShapesRequest::Item& item = *request.mutable_item();
    item.set_index(index);
    item.set_shape_id(pending.item.shape_id);
    item.set_label(pending.item.label);
    item.mutable_tags()->insert(pending.item.tags.begin(), pending.item.tags.end());
    *item.mutable_source() = *std::move(source);
    return stream.Write(request);
  }

  Pending startSending(int index) {
    const std::lock_guard lock(mutex_);
    Pending& pending = pending_.at(index);
    pending.sending = true;
    ++sending_;
    return pending;
  }

  void readOutcomes(Stream& stream) {
    v1::IngestShapesResponse response;
    while (stream.Read(&response)) {
      if (response.outcome() == v1::IngestShapesResponse::MISSING) {
        const std::lock_guard lock(mutex_);
        if (pending_.contains(response.index())) to_send_.push_back(response.index());
        wake_.notify_all();
      } else {
        finish(response.index(), outcomeOf(response));
      }
    }
    const std::lock_guard lock(mutex_);
    stream_over_ = true;
    wake_.notify_all();
  }

  // The item is answered: make room for the next one and tell the listener.
  void finish(int index, const IngestOutcome& outcome) {
    IngestItem item;
    {
      const std::lock_guard lock(mutex_);
      const auto found = pending_.find(index);
      if (found == pending_.end()) return;
      if (found->second.sending) --sending_;
      item = std::move(found->second.item);
      pending_.erase(found);
      ++answered_;
      wake_.notify_all();
    }
    tell(item, outcome);
  }

  void tell(const IngestItem& item, const IngestOutcome& outcome) {
    const std::lock_guard lock(listener_mutex_);
    listener_(item, outcome);
  }

  CallRunner& runner_;
  Service& catalog_;
  const MakeSource make_source_;
  const IngestOptions& options_;
  const IngestSource& next_;
  const IngestListener& listener_;
  Status fatal_;  // Written and read by the writing thread alone.

  std::mutex listener_mutex_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::map<int, Pending> pending_;
  std::deque<int> to_probe_, to_send_;
  std::size_t sending_ = 0;
  std::size_t answered_ = 0;
  int next_index_ = 0;
  bool exhausted_ = false;
  bool stream_over_ = false;
};

}  // namespace

Status Client::ingest(const IngestOptions& options, const IngestSource& next,
                      const IngestListener& listener) {
  IngestRun run(
      impl_->runner, *impl_->catalog,
      [this](const MeshBytes& bytes, const std::string& digest, const std::string& name,
             v1::MeshSource::Format format) { return impl_->source(bytes, digest, name, format); },
      options, next, listener);
  return run.run();
}

}  // namespace moduli
