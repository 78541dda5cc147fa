#include "core/forms/form_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/base/parallel.h"
#include "core/forms/flat_triangle.h"

namespace moduli {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Faces whose gradients are multiplied in one go; the rounding of a dense product grows with them.
constexpr std::size_t kFacesPerProduct = 256;
constexpr std::size_t kProductsPerBlock = 16;

/// A sum whose rounding error does not grow with the number of terms (Neumaier).
class ExactSum {
 public:
  void add(const Eigen::ArrayXXd& x) {
    const Eigen::ArrayXXd sum = sum_ + x;
    lost_ += (sum_.abs() >= x.abs()).select((sum_ - sum) + x, (x - sum) + sum_);
    sum_ = sum;
  }
  Eigen::MatrixXd value() const { return (sum_ + lost_).matrix(); }

  ExactSum(Eigen::Index rows, Eigen::Index columns)
      : sum_(Eigen::ArrayXXd::Zero(rows, columns)), lost_(sum_) {}

 private:
  Eigen::ArrayXXd sum_;
  Eigen::ArrayXXd lost_;
};

using RowArray = Eigen::Array<double, 1, Eigen::Dynamic>;

/// Gradients of all forms on one face after the other.
class GradientWriter {
 public:
  GradientWriter(const Connectivity& surface, const std::vector<double>& lengths,
                 const FormBasis& forms)
      : surface_(surface), lengths_(lengths), forms_(forms) {
    for (RowArray& side : sides_) side.resize(forms.count());
    size_.resize(forms.count());
  }

  /// Writes the gradients on face f, times the root of its area, into rows 2 `at` and 2 `at` + 1;
  /// adds to defects the squares of what rounding may do to them.
  void write(Index f, Eigen::Index at, RowMajorMatrix& gradients, RowArray& defects) {
    readSides(f);
    const TriangleFrame frame({lengths_[surface_.edge(3 * f)], lengths_[surface_.edge(3 * f + 1)],
                               lengths_[surface_.edge(3 * f + 2)]});
    const double scale = std::sqrt(frame.area());
    const RowArray& base = sides_[frame.base()];
    const RowArray& back = sides_[(frame.base() + 2) % 3];
    auto first = gradients.row(2 * at).array();
    auto second = gradients.row(2 * at + 1).array();
    first = base * (scale / frame.length());
    second = (back + frame.foot() * base) * (-scale / frame.height());
    // Rounding moves the gradient by a few units of |gradient| along the longest side and of
    // size / height across it.
    defects +=
        ((first.square() + second.square()).sqrt() + size_ * (scale / frame.height())).square();
  }

 private:
  /// The values along the sides c -> c + 1, and the size of the numbers whose rounding enters.
  void readSides(Index f) {
    for (Index c = 0; c < 3; ++c) {
      const Index h = 3 * f + c;
      sides_[c] = forms_.potential.row(surface_.head(h)) - forms_.potential.row(surface_.tail(h));
      const Index row = forms_.seam[surface_.edge(h)];
      if (row != kNone) sides_[c] += surface_.sign(h) * forms_.jumps.row(row).array();
    }
    size_ = sides_[0].abs().max(sides_[1].abs()).max(sides_[2].abs());
    for (Index c = 0; c < 3; ++c) {
      const Index row = forms_.seam[surface_.edge(3 * f + c)];
      if (row != kNone)
        size_ = size_.max(sides_[c].abs() + 2 * forms_.jumps.row(row).array().abs());
    }
  }

  const Connectivity& surface_;
  const std::vector<double>& lengths_;
  const FormBasis& forms_;
  std::array<RowArray, 3> sides_;
  RowArray size_;
};

struct PartialEnergy {
  Eigen::MatrixXd energy;  ///< Lower triangle.
  RowArray defects;
};

PartialEnergy sumFaces(const Connectivity& surface, const std::vector<double>& lengths,
                       const FormBasis& forms, std::size_t begin, std::size_t end) {
  const Eigen::Index count = forms.count();
  ExactSum sum(count, count);
  PartialEnergy result{{}, RowArray::Zero(count)};
  GradientWriter writer(surface, lengths, forms);
  RowMajorMatrix gradients;
  while (begin < end) {
    const std::size_t last = std::min(end, begin + kFacesPerProduct);
    gradients.resize(static_cast<Eigen::Index>(2 * (last - begin)), count);
    for (Eigen::Index at = 0; begin < last; ++begin, ++at) {
      writer.write(static_cast<Index>(begin), at, gradients, result.defects);
    }
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(count, count);
    product.selfadjointView<Eigen::Lower>().rankUpdate(gradients.transpose());
    sum.add(product.array());
  }
  result.energy = sum.value();
  return result;
}

}  // namespace

FormBasis cochainForms(const Connectivity& surface, const std::vector<Cochain>& cochains) {
  struct Entry {
    Index edge;
    Index cochain;
    Integer value;
  };
  std::vector<Entry> entries;
  for (std::size_t k = 0; k < cochains.size(); ++k) {
    for (const CochainTerm& term : cochains[k]) {
      entries.push_back({term.edge, static_cast<Index>(k), term.value});
    }
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.edge < b.edge; });

  FormBasis forms;
  forms.seam.assign(surface.edgeCount(), kNone);
  std::map<std::vector<std::pair<Index, Integer>>, Index> rows;
  for (auto from = entries.begin(); from != entries.end();) {
    auto to = from;
    std::vector<std::pair<Index, Integer>> values;
    for (; to != entries.end() && to->edge == from->edge; ++to) {
      values.emplace_back(to->cochain, to->value);
    }
    const auto next = static_cast<Index>(rows.size());
    forms.seam[from->edge] = rows.try_emplace(std::move(values), next).first->second;
    from = to;
  }
  const auto count = static_cast<Eigen::Index>(cochains.size());
  forms.jumps = RowMajorMatrix::Zero(static_cast<Eigen::Index>(rows.size()), count);
  for (const auto& [values, row] : rows) {
    for (const auto& [cochain, value] : values) {
      forms.jumps(row, cochain) = static_cast<double>(value);
    }
  }
  forms.potential = RowMajorMatrix::Zero(surface.vertexCount(), count);
  return forms;
}

Result<FormBasis> changeBasis(FormBasis forms, const IntegerMatrix& transform) {
  constexpr double kLargestWhole = 0x1p52;
  const RowMajorMatrix columns = transform.cast<double>().transpose();
  if (columns.size() > 0 && columns.cwiseAbs().maxCoeff() > kLargestWhole) return integerOverflow();
  forms.jumps = (forms.jumps * columns).eval();
  if (forms.jumps.size() > 0 && forms.jumps.cwiseAbs().maxCoeff() > kLargestWhole) {
    return integerOverflow();
  }
  // Block by block: the potentials are by far the largest array of a period computation.
  constexpr Eigen::Index kRows = 1024;
  if (columns.cols() != forms.count()) {
    forms.potential = (forms.potential * columns).eval();
    return forms;
  }
  for (Eigen::Index row = 0; row < forms.potential.rows(); row += kRows) {
    auto block = forms.potential.middleRows(row, std::min(kRows, forms.potential.rows() - row));
    block = (block * columns).eval();
  }
  return forms;
}

EnergyForm energyForm(const Connectivity& surface, const std::vector<double>& lengths,
                      const FormBasis& forms) {
  constexpr std::size_t kGrain = kFacesPerProduct * kProductsPerBlock;
  const auto faces = static_cast<std::size_t>(surface.faceCount());
  const Eigen::Index count = forms.count();
  std::vector<PartialEnergy> partial((faces + kGrain - 1) / kGrain);
  parallelBlocks(faces, kGrain, [&](std::size_t begin, std::size_t end) {
    partial[begin / kGrain] = sumFaces(surface, lengths, forms, begin, end);
  });
  ExactSum sum(count, count);
  RowArray defects = RowArray::Zero(count);
  for (const PartialEnergy& part : partial) {
    sum.add(part.energy.array());
    defects += part.defects;
  }
  EnergyForm result;
  result.energy = Eigen::MatrixXd(sum.value()).selfadjointView<Eigen::Lower>();
  // |<x + dx, y + dy> - <x, y>| <= |dx| |y| + |x| |dy| to first order, by Cauchy and Schwarz, with
  // 8 units in the last place of each number in dx; a dense product of n terms adds n units, the
  // areas and their roots some more.
  for (Eigen::Index a = 0; a < count; ++a) {
    const double relative = 8 * kEpsilon * std::sqrt(defects[a] / result.energy(a, a));
    const double product = (2 * static_cast<double>(kFacesPerProduct) + 16) * kEpsilon;
    result.rounding = std::max(result.rounding, 2 * relative + product);
  }
  return result;
}

}  // namespace moduli
