#include "server/rpc/grpc_status.h"

#include <optional>
#include <string>

#include "core/base/text.h"
#include "moduli/v1/error.pb.h"

namespace moduli {
namespace {

constexpr std::string_view kTypePrefix = "type.googleapis.com/google.rpc.";
constexpr std::string_view kDomain = "moduli";

// Percent-encoded (up to three bytes for one) and once more in base64 these stay below 8 KiB.
constexpr std::size_t kMessageLimit = 1200;
constexpr std::size_t kHintLimit = 400;

constexpr int kRetrySeconds = 1;

template <typename Detail>
void pack(std::string_view type, const Detail& detail, v1::RpcStatus& status) {
  google::protobuf::Any& any = *status.add_details();
  any.set_type_url(std::string(kTypePrefix) + std::string(type));
  any.set_value(detail.SerializeAsString());
}

template <typename Detail>
std::optional<Detail> unpack(std::string_view type, const grpc::Status& status) {
  v1::RpcStatus rpc;
  if (status.error_details().empty() || !rpc.ParseFromString(status.error_details())) return {};
  for (const google::protobuf::Any& any : rpc.details()) {
    Detail detail;
    if (any.type_url() == std::string(kTypePrefix) + std::string(type) &&
        detail.ParseFromString(any.value())) {
      return detail;
    }
  }
  return {};
}

Status fromTransport(const grpc::Status& status) {
  const std::string& message = status.error_message();
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
      return {Reason::kServerUnreachable, "the server cannot be reached (" + message + ")",
              "check the address and that modulid runs there"};
    case grpc::StatusCode::UNIMPLEMENTED:
      return {Reason::kServerTooOld, "the server does not know this call",
              "update the server, or use a client of its version"};
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      return {Reason::kMessageTooLarge, "a message is too large (" + message + ")",
              "send large meshes as uploads"};
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return {Reason::kDeadlineExceeded, "the deadline passed before the work was done",
              "allow more time with --timeout"};
    case grpc::StatusCode::CANCELLED:
      return {Reason::kCancelled, "the call was cancelled"};
    case grpc::StatusCode::UNAUTHENTICATED:
      return {Reason::kUnauthenticated, message, "give a valid token with --token"};
    case grpc::StatusCode::PERMISSION_DENIED:
      return {Reason::kPermissionDenied, message};
    default:
      return {Reason::kInternal, message.empty() ? "the call failed without a message" : message};
  }
}

}  // namespace

std::string printable(std::string_view text, std::size_t limit) {
  std::string result(text);
  if (!isPrintableUtf8(result)) {
    for (char& c : result) {
      if (c < 0x20 || c > 0x7e) c = '?';
    }
  }
  if (result.size() <= limit) return result;
  // Back over continuation bytes, so that no character is cut in two.
  std::size_t end = limit - 3;
  while (end > 0 && (static_cast<unsigned char>(result[end]) & 0xC0) == 0x80) --end;
  return result.substr(0, end) + "...";
}

grpc::Status toGrpcStatus(const Status& status, std::string_view field) {
  if (status.ok()) return grpc::Status::OK;
  const auto code = static_cast<grpc::StatusCode>(status.code());
  const std::string message = printable(status.message(), kMessageLimit);

  v1::RpcStatus rpc;
  rpc.set_code(code);
  rpc.set_message(message);
  v1::ErrorInfo info;
  info.set_reason(std::string(reasonName(status.reason())));
  info.set_domain(std::string(kDomain));
  if (!status.hint().empty()) {
    (*info.mutable_metadata())["hint"] = printable(status.hint(), kHintLimit);
  }
  pack("ErrorInfo", info, rpc);
  if (status.code() == ErrorCode::kInvalidArgument && !field.empty()) {
    v1::BadRequest request;
    auto& violation = *request.add_field_violations();
    violation.set_field(std::string(field));
    violation.set_description(printable(status.message(), kHintLimit));
    pack("BadRequest", request, rpc);
  }
  if (status.code() == ErrorCode::kResourceExhausted) {
    v1::RetryInfo retry;
    retry.mutable_retry_delay()->set_seconds(kRetrySeconds);
    pack("RetryInfo", retry, rpc);
  }
  return {code, message, rpc.SerializeAsString()};
}

Status fromGrpcStatus(const grpc::Status& status) {
  if (status.ok()) return {};
  const auto info = unpack<v1::ErrorInfo>("ErrorInfo", status);
  if (!info || info->domain() != kDomain) return fromTransport(status);
  const auto hint = info->metadata().find("hint");
  const std::string hint_text = hint == info->metadata().end() ? "" : hint->second;
  const Reason reason = reasonFromName(info->reason());
  if (reason == Reason::kInternal && info->reason() != reasonName(Reason::kInternal)) {
    return {reason, info->reason() + ": " + status.error_message(), hint_text};
  }
  return {reason, status.error_message(), hint_text};
}

std::chrono::milliseconds retryDelay(const grpc::Status& status) {
  const auto retry = unpack<v1::RetryInfo>("RetryInfo", status);
  if (!retry) return std::chrono::milliseconds(0);
  return std::chrono::seconds(retry->retry_delay().seconds()) +
         std::chrono::milliseconds(retry->retry_delay().nanos() / 1'000'000);
}

}  // namespace moduli
