#include "core/hyperbolic/wide_su11.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

namespace moduli {
namespace {

constexpr int kSteps = 8;
constexpr double kWorstStart = 0.5;
/// 2^-113 times the roundingGrowth of words whose corners lie within distance 20.
constexpr double kSolved = 1e-20;
/// Letters that must move further were not those of a group.
constexpr double kFarthest = 1e-7;

/// An element of the Lie algebra: the angle of a rotation and the vector of a translation.
using Move = std::array<Wide, 3>;
using MoveMatrix = std::array<Move, 3>;

WideComplex wide(Complex z) {
  return {z.real(), z.imag()};
}

Complex narrow(const WideComplex& z) {
  return {static_cast<double>(z.real()), static_cast<double>(z.imag())};
}

Wide squaredNorm(const WideComplex& z) {
  return z.real() * z.real() + z.imag() * z.imag();
}

/// Scales a so that |a|^2 = 1 + |b|^2, which it nearly is: (1 + e)^(1/2) to order e^3.
WideSu11 normalized(WideSu11 g) {
  const Wide e = (1 + squaredNorm(g.b)) / squaredNorm(g.a) - 1;
  g.a *= 1 + e / 2 - e * e / 8 + e * e * e / 16;
  return g;
}

/// exp [[i t / 2, w], [conj w, -i t / 2]] with w = (x + i y) / 2, whose square is a multiple of 1.
WideSu11 exponential(const Move& m) {
  const Wide q = (m[1] * m[1] + m[2] * m[2] - m[0] * m[0]) / 4;
  const Wide cosine = 1 + q / 2 * (1 + q / 12 * (1 + q / 30));
  const Wide sine = 1 + q / 6 * (1 + q / 20 * (1 + q / 42));
  return normalized({{cosine, sine * m[0] / 2}, {sine * m[1] / 2, sine * m[2] / 2}});
}

/// The logarithm of an element near 1 or -1, to first order.
Move logarithm(const WideSu11& g) {
  const Wide sign = g.a.real() < 0 ? -1 : 1;
  return {2 * sign * g.a.imag(), 2 * sign * g.b.real(), 2 * sign * g.b.imag()};
}

/// Column k: what conjugation by g makes of the k-th unit move.
MoveMatrix adjoint(const WideSu11& g) {
  const WideComplex i(0, 1);
  // The first row of g m g^-1 for m = [[i u, w], [conj w, -i u]].
  const auto conjugated = [&](const WideComplex& u, const WideComplex& w) {
    const WideComplex x = g.a * u + g.b * std::conj(w);
    const WideComplex y = g.a * w - g.b * u;
    const WideComplex corner = x * std::conj(g.a) - y * std::conj(g.b);
    const WideComplex side = y * g.a - x * g.b;
    return Move{2 * corner.imag(), 2 * side.real(), 2 * side.imag()};
  };
  const Wide half = Wide{1} / 2;
  const std::array<Move, 3> columns = {conjugated(i * half, Wide{0}), conjugated(Wide{0}, half),
                                       conjugated(Wide{0}, i * half)};
  MoveMatrix result{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) result[r][c] = columns[c][r];
  }
  return result;
}

/// Per letter, what the logarithm of the word makes of its moves.
std::vector<MoveMatrix> derivatives(const std::vector<WideSu11>& letters, const Word& word) {
  std::vector<MoveMatrix> result(letters.size(), MoveMatrix{});
  WideSu11 prefix;
  for (const int x : word) {
    const WideSu11& letter = letters[std::abs(x) - 1];
    // P X exp(m) S = exp(Ad_PX m) W and P exp(-m) X^-1 S = exp(-Ad_P m) W.
    const WideSu11 after = prefix * (x > 0 ? letter : inverse(letter));
    const MoveMatrix carried = adjoint(x > 0 ? after : prefix);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        result[std::abs(x) - 1][r][c] += x > 0 ? carried[r][c] : -carried[r][c];
      }
    }
    prefix = after;
  }
  return result;
}

/// Solves a symmetric positive definite system by elimination without pivots.
Move solve(MoveMatrix m, Move y) {
  for (int k = 0; k < 3; ++k) {
    for (int r = k + 1; r < 3; ++r) {
      const Wide factor = m[r][k] / m[k][k];
      for (int c = k; c < 3; ++c) m[r][c] -= factor * m[k][c];
      y[r] -= factor * y[k];
    }
  }
  for (int k = 2; k >= 0; --k) {
    for (int c = k + 1; c < 3; ++c) y[k] -= m[k][c] * y[c];
    y[k] /= m[k][k];
  }
  return y;
}

/// The smallest moves d with sum J d = -value.
std::vector<Move> smallestMoves(const std::vector<MoveMatrix>& jacobian, const Move& value) {
  MoveMatrix gram{};
  for (const MoveMatrix& j : jacobian) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 3; ++k) gram[r][c] += j[r][k] * j[c][k];
      }
    }
  }
  const Move multiplier = solve(gram, value);
  std::vector<Move> moves;
  for (const MoveMatrix& j : jacobian) {
    Move move{};
    for (int k = 0; k < 3; ++k) {
      for (int r = 0; r < 3; ++r) move[k] -= j[r][k] * multiplier[r];
    }
    moves.push_back(move);
  }
  return moves;
}

double lengthOf(const Move& m) {
  return std::hypot(static_cast<double>(m[0]), static_cast<double>(m[1]),
                    static_cast<double>(m[2]));
}

}  // namespace

Su11 rounded(const WideSu11& g) {
  return {narrow(g.a), narrow(g.b)};
}

WideSu11 widened(const Su11& g) {
  return normalized({wide(g.a), wide(g.b)});
}

WideSu11 evaluate(const std::vector<WideSu11>& letters, const Word& word) {
  WideSu11 product;
  for (const int x : word) {
    const WideSu11& letter = letters[std::abs(x) - 1];
    product = product * (x > 0 ? letter : inverse(letter));
  }
  return product;
}

double relationResidual(const std::vector<WideSu11>& letters, const Word& word) {
  WideSu11 product = evaluate(letters, word);
  const Wide sign = product.a.real() < 0 ? -1 : 1;
  product.a -= sign;
  return distanceUpToSign(rounded(product), {0, 0});
}

Result<RelationCorrection> correctRelation(const std::vector<Su11>& letters, const Word& word) {
  RelationCorrection result;
  for (const Su11& g : letters) result.letters.push_back(widened(g));
  const std::vector<WideSu11> start = result.letters;
  result.residual_before = result.residual = relationResidual(result.letters, word);
  if (!(result.residual < kWorstStart)) {
    return Status(
        Reason::kResidualTooLarge,
        "the relation of the side pairings misses the unit by " + std::to_string(result.residual));
  }
  // Once solved, one more step takes the rest away.
  bool solved = false;
  for (int step = 0; step < kSteps && !solved; ++step) {
    solved = result.residual <= kSolved;
    const std::vector<Move> moves =
        smallestMoves(derivatives(result.letters, word), logarithm(evaluate(result.letters, word)));
    for (std::size_t k = 0; k < moves.size(); ++k) {
      result.letters[k] = normalized(result.letters[k] * exponential(moves[k]));
    }
    result.residual = relationResidual(result.letters, word);
  }
  for (std::size_t k = 0; k < start.size(); ++k) {
    const Move moved = logarithm(inverse(start[k]) * result.letters[k]);
    result.moved = std::max(result.moved, lengthOf(moved));
  }
  if (!(solved && result.moved <= kFarthest)) {
    return Status(Reason::kNoConvergence,
                  "the relation of the side pairings could not be corrected");
  }
  return result;
}

}  // namespace moduli
