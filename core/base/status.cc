#include "core/base/status.h"

#include <array>
#include <cstddef>

namespace moduli {
namespace {

struct ReasonRow {
  Reason reason;
  ErrorCode code;
  std::string_view name;
};

using enum ErrorCode;

constexpr std::array kReasons{
    ReasonRow{Reason::kOk, ErrorCode::kOk, "OK"},
    ReasonRow{Reason::kFileNotFound, kNotFound, "FILE_NOT_FOUND"},
    ReasonRow{Reason::kFileUnreadable, kFailedPrecondition, "FILE_UNREADABLE"},
    ReasonRow{Reason::kFileUnwritable, kFailedPrecondition, "FILE_UNWRITABLE"},
    ReasonRow{Reason::kUnknownFormat, kInvalidArgument, "UNKNOWN_FORMAT"},
    ReasonRow{Reason::kSyntaxError, kInvalidArgument, "SYNTAX_ERROR"},
    ReasonRow{Reason::kTruncatedFile, kInvalidArgument, "TRUNCATED_FILE"},
    ReasonRow{Reason::kCountTooLarge, kInvalidArgument, "COUNT_TOO_LARGE"},
    ReasonRow{Reason::kIndexOutOfRange, kInvalidArgument, "INDEX_OUT_OF_RANGE"},
    ReasonRow{Reason::kUnsupportedContent, kInvalidArgument, "UNSUPPORTED_CONTENT"},
    ReasonRow{Reason::kEmpty, kInvalidArgument, "EMPTY"},
    ReasonRow{Reason::kNonManifoldEdge, kInvalidArgument, "NON_MANIFOLD_EDGE"},
    ReasonRow{Reason::kNonManifoldVertex, kInvalidArgument, "NON_MANIFOLD_VERTEX"},
    ReasonRow{Reason::kInconsistentOrientation, kInvalidArgument, "INCONSISTENT_ORIENTATION"},
    ReasonRow{Reason::kNonOrientable, kInvalidArgument, "NON_ORIENTABLE"},
    ReasonRow{Reason::kDegenerateFace, kInvalidArgument, "DEGENERATE_FACE"},
    ReasonRow{Reason::kDuplicateFace, kInvalidArgument, "DUPLICATE_FACE"},
    ReasonRow{Reason::kNonFiniteCoordinate, kInvalidArgument, "NON_FINITE_COORDINATE"},
    ReasonRow{Reason::kMultipleComponents, kInvalidArgument, "MULTIPLE_COMPONENTS"},
    ReasonRow{Reason::kComponentNotFound, kInvalidArgument, "COMPONENT_NOT_FOUND"},
    ReasonRow{Reason::kNotClosed, kInvalidArgument, "NOT_CLOSED"},
    ReasonRow{Reason::kInvalidGluing, kInvalidArgument, "INVALID_GLUING"},
    ReasonRow{Reason::kInvalidMetric, kInvalidArgument, "INVALID_METRIC"},
    ReasonRow{Reason::kUnsupportedTopology, kUnimplemented, "UNSUPPORTED_TOPOLOGY"},
    ReasonRow{Reason::kFoldedMap, kFailedPrecondition, "FOLDED_MAP"},
    ReasonRow{Reason::kResidualTooLarge, ErrorCode::kInternal, "RESIDUAL_TOO_LARGE"},
    ReasonRow{Reason::kNotPositiveDefinite, kFailedPrecondition, "NOT_POSITIVE_DEFINITE"},
    ReasonRow{Reason::kNoConvergence, kFailedPrecondition, "NO_CONVERGENCE"},
    ReasonRow{Reason::kOverflow, kOutOfRange, "OVERFLOW"},
    ReasonRow{Reason::kInvalidOption, kInvalidArgument, "INVALID_OPTION"},
    ReasonRow{Reason::kIncomparableSignatures, kFailedPrecondition, "INCOMPARABLE_SIGNATURES"},
    ReasonRow{Reason::kCancelled, ErrorCode::kCancelled, "CANCELLED"},
    ReasonRow{Reason::kDeadlineExceeded, ErrorCode::kDeadlineExceeded, "DEADLINE_EXCEEDED"},
    ReasonRow{Reason::kQueueFull, kResourceExhausted, "QUEUE_FULL"},
    ReasonRow{Reason::kMeshTooLarge, kResourceExhausted, "MESH_TOO_LARGE"},
    ReasonRow{Reason::kMessageTooLarge, kResourceExhausted, "MESSAGE_TOO_LARGE"},
    ReasonRow{Reason::kServerDraining, kUnavailable, "SERVER_DRAINING"},
    ReasonRow{Reason::kServerUnreachable, kUnavailable, "SERVER_UNREACHABLE"},
    ReasonRow{Reason::kServerTooOld, kUnimplemented, "SERVER_TOO_OLD"},
    ReasonRow{Reason::kPortTaken, kFailedPrecondition, "PORT_TAKEN"},
    ReasonRow{Reason::kInvalidConfiguration, kInvalidArgument, "INVALID_CONFIGURATION"},
    ReasonRow{Reason::kUnauthenticated, ErrorCode::kUnauthenticated, "UNAUTHENTICATED"},
    ReasonRow{Reason::kPermissionDenied, ErrorCode::kPermissionDenied, "PERMISSION_DENIED"},
    ReasonRow{Reason::kInvalidName, kInvalidArgument, "INVALID_NAME"},
    ReasonRow{Reason::kInvalidFilter, kInvalidArgument, "INVALID_FILTER"},
    ReasonRow{Reason::kInvalidPageToken, kInvalidArgument, "INVALID_PAGE_TOKEN"},
    ReasonRow{Reason::kInvalidRequest, kInvalidArgument, "INVALID_REQUEST"},
    ReasonRow{Reason::kCollectionNotFound, kNotFound, "COLLECTION_NOT_FOUND"},
    ReasonRow{Reason::kCollectionExists, kAlreadyExists, "COLLECTION_EXISTS"},
    ReasonRow{Reason::kCollectionNotEmpty, kFailedPrecondition, "COLLECTION_NOT_EMPTY"},
    ReasonRow{Reason::kShapeNotFound, kNotFound, "SHAPE_NOT_FOUND"},
    ReasonRow{Reason::kShapeExists, kAlreadyExists, "SHAPE_EXISTS"},
    ReasonRow{Reason::kNameClash, kInvalidArgument, "NAME_CLASH"},
    ReasonRow{Reason::kUploadNotFound, kNotFound, "UPLOAD_NOT_FOUND"},
    ReasonRow{Reason::kUploadOffsetMismatch, kAborted, "UPLOAD_OFFSET_MISMATCH"},
    ReasonRow{Reason::kUploadDigestMismatch, kDataLoss, "UPLOAD_DIGEST_MISMATCH"},
    ReasonRow{Reason::kStoreLocked, kFailedPrecondition, "STORE_LOCKED"},
    ReasonRow{Reason::kStoreTooNew, kFailedPrecondition, "STORE_TOO_NEW"},
    ReasonRow{Reason::kStoreCorrupt, kDataLoss, "STORE_CORRUPT"},
    ReasonRow{Reason::kStoreOnNetworkFileSystem, kFailedPrecondition,
              "STORE_ON_NETWORK_FILE_SYSTEM"},
    ReasonRow{Reason::kStoreFailure, ErrorCode::kInternal, "STORE_FAILURE"},
    ReasonRow{Reason::kInternal, ErrorCode::kInternal, "INTERNAL"},
};

constexpr bool tableFollowsEnum() {
  for (std::size_t i = 0; i < kReasons.size(); ++i) {
    if (static_cast<std::size_t>(kReasons[i].reason) != i) return false;
  }
  return kReasons.back().reason == Reason::kInternal;
}
static_assert(tableFollowsEnum(), "the table must list every reason once, in the enum's order");

const ReasonRow& rowOf(Reason reason) {
  return kReasons[static_cast<std::size_t>(reason)];
}

}  // namespace

std::string_view reasonName(Reason reason) {
  return rowOf(reason).name;
}

ErrorCode reasonCode(Reason reason) {
  return rowOf(reason).code;
}

Reason reasonFromName(std::string_view name) {
  for (const ReasonRow& row : kReasons) {
    if (row.name == name) return row.reason;
  }
  return Reason::kInternal;
}

Status Status::withContext(std::string_view prefix) const {
  if (ok()) return *this;
  return {reason_, std::string(prefix) + ": " + message_, hint_};
}

std::string Status::toString() const {
  std::string text(reasonName(reason_));
  if (!message_.empty()) text += ": " + message_;
  if (!hint_.empty()) text += "; " + hint_;
  return text;
}

}  // namespace moduli
