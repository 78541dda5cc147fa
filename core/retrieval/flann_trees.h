#pragma once

#include <cstddef>
#include <memory>

#include "core/base/status.h"

namespace moduli {

/// Whom a tree asks how far to look, and tells what it finds. Numbers of rows count from 0 in the
/// order in which the tree was given them.
class TreeVisitor {
 public:
  virtual ~TreeVisitor() = default;
  /// Rows and nodes at a larger squared distance need not be shown. Asked at every node or leaf;
  /// negative ends the search.
  virtual double limit() = 0;
  /// A row whose squared distance is at most about the limit.
  virtual void offer(std::size_t row) = 0;
};

/// FLANN's single k-d tree. It compares in float32 and widens the limit by what that may err, so
/// that no row within the limit is left out. Immutable; safe to search from several threads.
class KdTree {
 public:
  /// rows: count x dimension, both positive, count < 2^31, finite, of norm below 1e15. The tree
  /// keeps a copy of its own. O(n log n).
  static Result<KdTree> build(const float* rows, std::size_t count, std::size_t dimension);
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;
  ~KdTree();

  void search(const float* query, TreeVisitor& visitor) const;

 private:
  struct Inside;
  explicit KdTree(std::unique_ptr<Inside> inside);
  std::unique_ptr<Inside> inside_;
};

}  // namespace moduli
