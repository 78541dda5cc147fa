#pragma once

#include <grpcpp/support/server_callback.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>

#include "moduli/v1/catalog.pb.h"
#include "server/service/call.h"
#include "server/service/ingest_item.h"

namespace moduli {

/// IngestShapes. An item is in flight from its arrival until its outcome has been written; at most
/// a few per thread are, and nothing is read while there is no room: neither a fast sender nor a
/// slow reader makes memory grow. Half-close ends the call when all items are answered; a drain
/// answers those in flight and then says kServerDraining.
class IngestCall final
    : public grpc::ServerBidiReactor<v1::IngestShapesRequest, v1::IngestShapesResponse>,
      public Call {
 public:
  using Reactor = grpc::ServerBidiReactor<v1::IngestShapesRequest, v1::IngestShapesResponse>;

  static Reactor* answer(Backend& backend, const grpc::CallbackServerContext& rpc);

  explicit IngestCall(Backend& backend);

  void stop(const Status& why) override;
  void drain() override;

 private:
  using Item = v1::IngestShapesRequest::Item;
  using Outcome = v1::IngestShapesResponse;

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  void takeHeader();
  void takeItem();
  void start(const std::shared_ptr<const Item>& item);
  void finishItem(Outcome outcome);

  void end(const Status& status, std::string_view field = {});
  /// Starts what can be started. Under mutex_.
  void pump();

  const std::size_t limit_;                 ///< Of items in flight.
  v1::IngestShapesRequest request_;         ///< Not to be read into while reading_.
  Outcome current_;                         ///< Belongs to gRPC while writing_.
  std::shared_ptr<const IngestPlan> plan_;  ///< Set once, before the first item is read.
  std::deque<Outcome> outcomes_;
  std::size_t in_flight_ = 0;
  bool reading_ = false;  ///< A read is under way, or what it brought is looked at.
  bool writing_ = false;
  bool reads_done_ = false;
  bool draining_ = false;
  bool closed_ = false;  ///< Finish has been called.
  std::optional<grpc::Status> end_;
  std::shared_ptr<IngestCall> self_;
};

}  // namespace moduli
