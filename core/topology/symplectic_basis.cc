#include "core/topology/symplectic_basis.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace moduli {
namespace {

using Row = Eigen::Index;

class Reducer {
 public:
  explicit Reducer(const IntegerMatrix& form)
      : form_(form), basis_(IntegerMatrix::Identity(form.rows(), form.cols())) {
    for (Row k = 0; k < form.rows(); ++k) active_.push_back(k);
  }

  Result<SymplecticBasis> reduce() {
    while (findSmallest()) {
      while (smallest_ > 1) {
        ASSIGN_OR_RETURN(const bool smaller, lowerSmallest());
        if (!smaller) {
          return Status{Reason::kInvalidOption, "the form has the invariant factor " +
                                                    std::to_string(smallest_) + " instead of 1"};
        }
        findSmallest();
      }
      RETURN_IF_ERROR(splitOff());
    }
    return collect();
  }

 private:
  /// Finds a_ and b_ with the smallest positive product; false where all products are 0.
  bool findSmallest() {
    smallest_ = 0;
    for (const Row i : active_) {
      for (const Row k : active_) {
        const Integer product = form_(i, k);
        if (product <= 0 || (smallest_ != 0 && product >= smallest_)) continue;
        smallest_ = product;
        a_ = i;
        b_ = k;
        if (product == 1) return true;
      }
    }
    return smallest_ != 0;
  }

  /// Finds a product that the smallest one does not divide and takes it modulo that one. False
  /// where the smallest divides the products of a_ and b_ with all: then it is an invariant factor.
  Result<bool> lowerSmallest() {
    for (const Row k : active_) {
      if (k == a_ || k == b_) continue;
      if (form_(a_, k) % smallest_ != 0) {
        RETURN_IF_ERROR(add(k, -(form_(a_, k) / smallest_), b_));
        return true;
      }
      if (form_(k, b_) % smallest_ != 0) {
        RETURN_IF_ERROR(add(k, -(form_(k, b_) / smallest_), a_));
        return true;
      }
    }
    return false;
  }

  /// Makes the others orthogonal to a_ and b_ and sets these two aside.
  Status splitOff() {
    std::erase_if(active_, [this](Row k) { return k == a_ || k == b_; });
    for (const Row k : active_) {
      const Integer along_a = form_(k, b_);
      const Integer along_b = form_(a_, k);
      if (along_a != 0) RETURN_IF_ERROR(add(k, -along_a, a_));
      if (along_b != 0) RETURN_IF_ERROR(add(k, -along_b, b_));
    }
    first_.push_back(a_);
    second_.push_back(b_);
    return {};
  }

  Status add(Row to, Integer times, Row from) {
    RETURN_IF_ERROR(addRow(basis_, to, times, from));
    RETURN_IF_ERROR(addRow(form_, to, times, from));
    // The form stays antisymmetric: its column follows its row, but for the corner.
    form_(to, to) = 0;
    form_.col(to) = -form_.row(to).transpose();
    return {};
  }

  SymplecticBasis collect() const {
    SymplecticBasis result;
    result.pairs = static_cast<Eigen::Index>(first_.size());
    std::vector<Row> order = first_;
    order.insert(order.end(), second_.begin(), second_.end());
    order.insert(order.end(), active_.begin(), active_.end());
    result.basis.resize(basis_.rows(), basis_.cols());
    for (Row k = 0; k < basis_.rows(); ++k) result.basis.row(k) = basis_.row(order[k]);
    return result;
  }

  IntegerMatrix form_;  ///< The products of the rows of basis_.
  IntegerMatrix basis_;
  std::vector<Row> active_, first_, second_;
  Row a_ = 0, b_ = 0;
  Integer smallest_ = 0;
};

}  // namespace

Result<SymplecticBasis> reduceSymplectic(const IntegerMatrix& form) {
  if (form.rows() != form.cols() || form != -form.transpose()) {
    return Status{Reason::kInvalidOption, "the form is not antisymmetric"};
  }
  return Reducer(form).reduce();
}

}  // namespace moduli
