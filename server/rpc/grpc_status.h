#pragma once

#include <grpcpp/support/status.h>

#include <chrono>
#include <string_view>

#include "core/base/status.h"

/// The one table between our errors and what travels over gRPC, used by servers and clients alike.
namespace moduli {

/// The status to finish a call with: the code of the reason, the message, and in
/// grpc-status-details-bin a google.rpc.Status with an ErrorInfo {reason, domain "moduli", metadata
/// hint}, for an INVALID_ARGUMENT with a `field` (a path such as "source.digest") a BadRequest, and
/// for RESOURCE_EXHAUSTED a RetryInfo. Over-long words are cut, so that the trailers fit into
/// gRPC's 8 KiB of metadata; bytes that are not printable UTF-8 are shown as "?".
grpc::Status toGrpcStatus(const Status& status, std::string_view field = {});

/// The way back. A status without an ErrorInfo comes from gRPC itself: UNAVAILABLE becomes
/// kServerUnreachable, UNIMPLEMENTED kServerTooOld, RESOURCE_EXHAUSTED kMessageTooLarge. A reason
/// that this build does not know becomes kInternal with the reason's name before the message.
Status fromGrpcStatus(const grpc::Status& status);

/// How long the server asks to wait before a retry; 0 if it says nothing.
std::chrono::milliseconds retryDelay(const grpc::Status& status);

/// The message without what may not travel in a protobuf string: printable UTF-8 of at most
/// `limit` bytes.
std::string printable(std::string_view text, std::size_t limit);

}  // namespace moduli
