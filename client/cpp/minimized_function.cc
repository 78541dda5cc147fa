#include "client/cpp/minimized_function.h"

#include <cstddef>
#include <limits>
#include <string>
#include <utility>

namespace moduli {
namespace {

using Chunk = v1::ArrayChunk;
using Number = ArrayKind::Number;

constexpr std::size_t kColumns = 7;

bool isCount(double number) {
  return number >= 0 && number <= std::numeric_limits<int>::max();
}

Result<std::vector<MinimizedStep>> stepsOf(const std::vector<double>& rows) {
  std::vector<MinimizedStep> steps;
  for (std::size_t row = 0; row + kColumns <= rows.size(); row += kColumns) {
    const double* const at = &rows[row];
    if (!isCount(at[0]) || !isCount(at[5]) || !isCount(at[6])) {
      return brokenArray("TRACE", "has counts that are none");
    }
    steps.push_back({static_cast<int>(at[0]), at[1], at[2], at[3], at[4], static_cast<int>(at[5]),
                     static_cast<int>(at[6])});
  }
  return steps;
}

/// Puts what came in chunks into the message.
Status takeEntries(ArrayPieces& pieces, Chunk::Array array,
                   google::protobuf::RepeatedField<double>& entries) {
  if (pieces.rows(array) > 0) {
    const std::vector<double> numbers = pieces.takeDoubles(array);
    entries.Assign(numbers.begin(), numbers.end());
  }
  return entries.empty() ? brokenArray(Chunk::Array_Name(array), "is missing") : Status();
}

}  // namespace

MinimizeAssembler::MinimizeAssembler(const v1::MinimizeRequest& request)
    : trace_(request.trace()),
      path_(request.path()),
      pieces_({{Chunk::MINIMIZER, 1, Number::kDouble, false},
               {Chunk::DIRECTION, 1, Number::kDouble, false},
               {Chunk::TRACE, kColumns, Number::kDouble, trace_},
               {Chunk::PATH, 2, Number::kDouble, path_}}) {}

Result<MinimizedFunction> MinimizeAssembler::finish(v1::Minimization result) {
  RETURN_IF_ERROR(pieces_.checkComplete());
  MinimizedFunction function;
  function.result = std::move(result);
  RETURN_IF_ERROR(takeEntries(pieces_, Chunk::MINIMIZER, *function.result.mutable_x()));
  if (trace_ && path_ && pieces_.rows(Chunk::TRACE) != pieces_.rows(Chunk::PATH)) {
    return brokenArray("PATH", "has not as many rows as there are steps");
  }
  if (trace_) {
    ASSIGN_OR_RETURN(function.trace, stepsOf(pieces_.doubles(Chunk::TRACE)));
  }
  if (path_) {
    const std::vector<double>& rows = pieces_.doubles(Chunk::PATH);
    for (std::size_t i = 0; i + 1 < rows.size(); i += 2) {
      function.path.push_back({rows[i], rows[i + 1]});
    }
  }
  return function;
}

Result<v1::AffineDirection> MinimizeAssembler::finish(v1::AffineDirection result) {
  RETURN_IF_ERROR(pieces_.checkComplete());
  RETURN_IF_ERROR(takeEntries(pieces_, Chunk::DIRECTION, *result.mutable_direction()));
  return result;
}

}  // namespace moduli
