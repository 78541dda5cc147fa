#pragma once

#include <grpcpp/support/status.h>

#include "client/cpp/call.h"

/// Internal.
namespace moduli {

/// Reads a stream of Progress and results; `take` is shown what is no progress, and returns true
/// when the answer is complete.
template <typename Response, typename Reader, typename Take>
grpc::Status readEvents(CallRunner& runner, Reader& reader, Take take) {
  bool complete = false;
  Response response;
  while (reader.Read(&response)) {
    if (response.has_progress()) {
      runner.report(response.progress());
    } else {
      complete = take(response) || complete;
    }
  }
  const grpc::Status status = reader.Finish();
  if (status.ok() && !complete) {
    return {grpc::StatusCode::INTERNAL, "the server ended its answer without a result"};
  }
  return status;
}

}  // namespace moduli
