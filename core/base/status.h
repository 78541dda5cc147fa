#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

/// Errors as values. No exception crosses a room.
///
///   Result<TriangleMesh> mesh = buildMesh(context, soup);
///   if (!mesh.ok()) return mesh.status();
///   use(*mesh);
///
/// or shorter, in a function that itself returns Status or Result:
///
///   ASSIGN_OR_RETURN(TriangleMesh mesh, buildMesh(context, soup));
namespace moduli {

/// The canonical codes of gRPC, with their numbers.
enum class ErrorCode : std::uint8_t {
  kOk = 0,
  kCancelled = 1,
  kInvalidArgument = 3,
  kDeadlineExceeded = 4,
  kNotFound = 5,
  kAlreadyExists = 6,
  kPermissionDenied = 7,
  kResourceExhausted = 8,
  kFailedPrecondition = 9,
  kAborted = 10,
  kOutOfRange = 11,
  kUnimplemented = 12,
  kInternal = 13,
  kUnavailable = 14,
  kDataLoss = 15,
  kUnauthenticated = 16,
};

/// Why something failed. Each reason has one code and one UPPER_SNAKE name for ever, both in the
/// table of status.cc: the same defect always gives the same answer.
enum class Reason : std::uint8_t {
  kOk,
  // Files and bytes.
  kFileNotFound,
  kFileUnreadable,
  kFileUnwritable,
  kUnknownFormat,
  kSyntaxError,
  kTruncatedFile,
  kCountTooLarge,
  kIndexOutOfRange,
  kUnsupportedContent,
  // Defects of a mesh; the same names as in the report of `inspect`.
  kEmpty,
  kNonManifoldEdge,
  kNonManifoldVertex,
  kInconsistentOrientation,
  kNonOrientable,
  kDegenerateFace,
  kDuplicateFace,
  kNonFiniteCoordinate,
  kMultipleComponents,
  kComponentNotFound,
  kNotClosed,
  kInvalidGluing,  ///< Of triangles whose sides are glued by name.
  kInvalidMetric,  ///< Edge lengths that make no surface.
  // Computation.
  kUnsupportedTopology,
  kFoldedMap,
  kResidualTooLarge,
  kNotPositiveDefinite,
  kNoConvergence,
  kOverflow,
  kInvalidOption,
  kIncomparableSignatures,
  // Running.
  kCancelled,
  kDeadlineExceeded,
  kQueueFull,
  kMeshTooLarge,
  kMessageTooLarge,
  kServerDraining,
  kServerUnreachable,
  kServerTooOld,
  kPortTaken,
  kInvalidConfiguration,
  kUnauthenticated,
  kPermissionDenied,
  // Catalogue and uploads.
  kInvalidName,
  kInvalidFilter,
  kInvalidPageToken,
  kInvalidRequest,
  kCollectionNotFound,
  kCollectionExists,
  kCollectionNotEmpty,
  kShapeNotFound,
  kShapeExists,
  kNameClash,
  kUploadNotFound,
  kUploadOffsetMismatch,
  kUploadDigestMismatch,
  kStoreLocked,
  kStoreTooNew,
  kStoreCorrupt,
  kStoreOnNetworkFileSystem,
  kStoreFailure,
  kInternal,
};

/// The stable UPPER_SNAKE name of a reason, at most 63 characters.
std::string_view reasonName(Reason reason);
/// The reason of a stable name; kInternal for an unknown one.
Reason reasonFromName(std::string_view name);
/// The one code of a reason.
ErrorCode reasonCode(Reason reason);

/// What happened: nothing bad, or a reason with words for a person.
/// message says why, naming the element; hint says what to do next. Both are short phrases without
/// a trailing full stop.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Reason reason, std::string message, std::string hint = {})
      : reason_(reason), message_(std::move(message)), hint_(std::move(hint)) {}

  bool ok() const { return reason_ == Reason::kOk; }
  Reason reason() const { return reason_; }
  ErrorCode code() const { return reasonCode(reason_); }
  const std::string& message() const { return message_; }
  const std::string& hint() const { return hint_; }

  /// The same failure with "prefix: " before its message; a success stays one.
  Status withContext(std::string_view prefix) const;

  /// "REASON: message; hint".
  std::string toString() const;

 private:
  Reason reason_ = Reason::kOk;
  std::string message_;
  std::string hint_;
};

/// A value or the reason why there is none. Reading the value of a failure aborts the program.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value)
      : content_(std::move(value)) {}  // NOLINT: implicit, so that `return value;` works
  Result(Status status) : content_(std::move(status)) {}  // NOLINT: as above

  bool ok() const { return std::holds_alternative<T>(content_); }
  Status status() const { return ok() ? Status() : std::get<Status>(content_); }

  const T& operator*() const& { return std::get<T>(content_); }
  T& operator*() & { return std::get<T>(content_); }
  T&& operator*() && { return std::get<T>(std::move(content_)); }
  const T* operator->() const { return &std::get<T>(content_); }
  T* operator->() { return &std::get<T>(content_); }

 private:
  std::variant<Status, T> content_;
};

}  // namespace moduli

#define MODULI_CONCAT_INNER(a, b) a##b
#define MODULI_CONCAT(a, b) MODULI_CONCAT_INNER(a, b)

/// Leaves the enclosing function with the failure, if there is one.
#define RETURN_IF_ERROR(expression)                                                               \
  do {                                                                                            \
    if (::moduli::Status moduli_status = (expression); !moduli_status.ok()) return moduli_status; \
  } while (false)

/// Declares or assigns `target` from a Result, or leaves the enclosing function with its failure.
#define ASSIGN_OR_RETURN(target, expression) \
  ASSIGN_OR_RETURN_INNER(MODULI_CONCAT(moduli_result_, __LINE__), target, expression)
#define ASSIGN_OR_RETURN_INNER(result, target, expression) \
  auto result = (expression);                              \
  if (!result.ok()) return result.status();                \
  target = *std::move(result)
