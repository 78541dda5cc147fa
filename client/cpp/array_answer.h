#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <optional>
#include <utility>

#include "client/cpp/call.h"
#include "core/base/status.h"
#include "server/rpc/grpc_status.h"

/// Internal.
namespace moduli {

/// What one attempt of a call has brought that is answered by Progress, arrays in chunks, and a
/// result at last.
template <typename Assembler, typename Message>
class ArrayAnswer {
 public:
  explicit ArrayAnswer(Assembler arrays) : arrays_(std::move(arrays)) {}

  /// Reads the stream to its end, or to what is wrong with it. result_of: the result in a response;
  /// null where it has none.
  template <typename Response, typename Reader, typename ResultOf>
  grpc::Status read(CallRunner& runner, grpc::ClientContext& context, Reader& reader,
                    ResultOf result_of) {
    Response response;
    Status wrong;
    while (wrong.ok() && reader.Read(&response)) {
      if (response.has_progress()) {
        runner.report(response.progress());
      } else if (result_) {
        wrong = {Reason::kInternal, "the server's answer is broken: it goes on after the result",
                 "try again; if it stays, update the server or this client"};
      } else if (response.has_array()) {
        wrong = arrays_.take(response.array());
      } else if (Message* const result = result_of(response)) {
        result_.emplace().Swap(result);
      }
    }
    if (!wrong.ok()) context.TryCancel();
    const grpc::Status status = reader.Finish();
    return wrong.ok() ? status : toGrpcStatus(wrong);
  }

  /// Fails with kInternal where none has come.
  Status checkResult() const {
    if (result_) return {};
    return {Reason::kInternal, "the server ended its answer without a result", "try again"};
  }

  Assembler& arrays() { return arrays_; }
  /// Precondition: checkResult().
  Message takeResult() { return *std::move(result_); }

 private:
  Assembler arrays_;
  std::optional<Message> result_;
};

}  // namespace moduli
