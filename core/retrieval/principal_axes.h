#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/retrieval/vector_index.h"

namespace moduli {

/// Turns vectors to the principal axes of a set and scales its rows into the unit ball:
///
///   y = scale * axes^T (x - centre),   axes orthogonal, most variance first.
///
/// After a few coordinates of y most of a distance is known. All is computed in double precision
/// and rounded to float32 once, so a distance of turned vectors differs from scale times the true
/// one by at most slack(norm of the turned query). Immutable.
class PrincipalAxes {
 public:
  /// Of the rows of `set` named by `rows`, at least one, of dimension at least 1; the axes of up to
  /// 16384 of them, evenly picked. Above dimension 512 the axes stay as they are.
  /// O(rows * dimension + dimension^3).
  PrincipalAxes(const VectorSet& set, std::span<const std::uint32_t> rows);

  double scale() const { return scale_; }
  std::size_t dimension() const { return static_cast<std::size_t>(centre_.size()); }

  /// The turned rows of `set` named by `rows`, into `turned`: rows.size() x dimension.
  void turnRows(const VectorSet& set, std::span<const std::uint32_t> rows, float* turned) const;

  /// Nothing if the turned vector would be longer than 2^20, where float32 tells the rows of the
  /// unit ball apart no more.
  std::optional<std::vector<float>> turn(std::span<const float> vector) const;

  /// Rounding of one row and one query of norm `norm`, each below 2^-24 of the norm, twice over for
  /// what double precision adds.
  static double slack(double norm) { return 0x1p-23 * (1 + norm); }

 private:
  void findAxes(const VectorSet& set, std::span<const std::uint32_t> rows);
  double radius(const VectorSet& set, std::span<const std::uint32_t> rows) const;

  Eigen::RowVectorXd centre_;
  Eigen::MatrixXd axes_;  ///< Empty: the identity.
  double scale_ = 1;
};

}  // namespace moduli
