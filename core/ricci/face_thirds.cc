#include "core/ricci/face_thirds.h"

#include <cmath>

namespace moduli {
namespace {

/// The two corners of the side opposite corner k.
constexpr int after(int k) {
  return (k + 1) % 3;
}
constexpr int before(int k) {
  return (k + 2) % 3;
}

/// F'(x) / F(x), the logarithmic derivative of the identity, sinh or sin.
double logarithmicDerivative(Geometry geometry, double x) {
  switch (geometry) {
    case Geometry::kEuclidean:
      return 1 / x;
    case Geometry::kHyperbolic:
      return 1 / std::tanh(x);
    default:
      return 1 / std::tan(x);
  }
}

/// What side k gives to the derivatives of the angles at its ends: cot(b_k) / 2 and q_k of MATH
/// 6.4.
struct SideTerm {
  double half_cotangent = 0, q = 0;
};

SideTerm sideTerm(Geometry geometry, const TriangleValues& t, const TriangleValues& x, int k) {
  const double ti = t[after(k)], tj = t[before(k)], tk = t[k];
  if (geometry == Geometry::kEuclidean) return {(1 - tk * tk) / (4 * tk), 0};
  const double sum = ti + tj, rest = 1 - ti * tj;
  const double sign = geometry == Geometry::kHyperbolic ? 1 : -1;
  const double square = sign * x[k] * x[k];
  return {0.5 * (sum - tk * rest) / (rest + tk * sum), square / (1 + square)};
}

/// The second derivatives of the sides by the unknowns of the corners, with the first ones.
struct SideDerivatives {
  TriangleMatrix first{};                  ///< [side][corner]
  std::array<TriangleMatrix, 3> second{};  ///< [side][corner][corner]
};

/// From F(l) dl = F_i (F_i C_j + I C_i F_j) du_i + the same of j.
SideDerivatives sideDerivatives(Geometry geometry, const CircleFace& face) {
  const double sign = -planeCurvature(geometry);
  SideDerivatives d;
  for (int c = 0; c < 3; ++c) {
    const double divisor = halfChord(geometry, 2 * face.side[c]);  // F(l).
    const double bend = logarithmicDerivative(geometry, face.side[c]);
    const double distance = face.distance[c];
    for (const int i : {after(c), before(c)}) {
      const int j = 3 - c - i;
      const double si = face.sine[i], sj = face.sine[j], ci = face.cosine[i], cj = face.cosine[j];
      d.first[c][i] = (si / divisor) * (si * cj + distance * ci * sj);
      d.second[c][i][i] =
          (si / divisor) * (2 * si * ci * cj + distance * sj * (ci * ci + sign * si * si));
      d.second[c][i][j] = (si / divisor) * sj * (sign * si * sj + distance * ci * cj);
    }
    for (const int i : {after(c), before(c)}) {
      for (const int j : {after(c), before(c)}) {
        d.second[c][i][j] -= bend * d.first[c][i] * d.first[c][j];
      }
    }
  }
  return d;
}

/// The second derivatives of the angles by the sides, from angle_i,i = F(l_i) / D and angle_i,j =
/// -cos(angle_k) angle_i,i.
TriangleTensor secondBySides(Geometry geometry, const CircleFace& face,
                             const TriangleMatrix& first) {
  TriangleTensor second{};
  for (int i = 0; i < 3; ++i) {
    for (int m = 0; m < 3; ++m) {
      const double growth = (m == i ? 1 : -1) * logarithmicDerivative(geometry, face.side[m]) -
                            first[i][m] / std::tan(face.angle[i]);
      const double own = first[i][i] * growth;
      second[i][i][m] = own;
      for (const int j : {after(i), before(i)}) {
        const int k = 3 - i - j;
        second[i][j][m] =
            std::sin(face.angle[k]) * first[k][m] * first[i][i] - std::cos(face.angle[k]) * own;
      }
    }
  }
  return second;
}

}  // namespace

TriangleValues contract(const TriangleTensor& tensor, const TriangleMatrix& weights) {
  TriangleValues result{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int m = 0; m < 3; ++m) result[m] += weights[i][j] * tensor[i][j][m];
    }
  }
  return result;
}

TriangleTensor scaledFaceThirds(Geometry geometry, const TriangleValues& half_tangents,
                                const TriangleValues& half_chords) {
  std::array<SideTerm, 3> term;
  TriangleMatrix first{};
  for (int k = 0; k < 3; ++k) {
    term[k] = sideTerm(geometry, half_tangents, half_chords, k);
    const int i = after(k), j = before(k);
    first[i][j] = first[j][i] = term[k].half_cotangent * (1 - term[k].q);
    first[i][i] -= term[k].half_cotangent * (1 + term[k].q);
    first[j][j] -= term[k].half_cotangent * (1 + term[k].q);
  }
  TriangleTensor result{};
  for (int k = 0; k < 3; ++k) {
    const int i = after(k), j = before(k);
    const double half = term[k].half_cotangent, q = term[k].q;
    for (int m = 0; m < 3; ++m) {
      // d cot b = -(1 + cot^2 b) db with b = (pi - a_i - a_j + a_k) / 2.
      const double turn = (first[i][m] + first[j][m] - first[k][m]) / 4;
      const double change = (1 + 4 * half * half) * turn;
      const double growth = m == k ? 0 : half * q * (1 - q);
      result[i][j][m] += change * (1 - q) - growth;
      result[j][i][m] += change * (1 - q) - growth;
      result[i][i][m] -= change * (1 + q) + growth;
      result[j][j][m] -= change * (1 + q) + growth;
    }
  }
  return result;
}

TriangleTensor circleFaceThirds(Geometry geometry, const CircleFace& face) {
  TriangleTensor result{};
  if (isBrokenTriangle(face.side)) return result;
  const TriangleMatrix by_sides = angleDerivatives(geometry, face.side, face.angle);
  const TriangleTensor bent = secondBySides(geometry, face, by_sides);
  const SideDerivatives sides = sideDerivatives(geometry, face);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int m = 0; m < 3; ++m) {
        for (int c = 0; c < 3; ++c) {
          result[i][j][m] += by_sides[i][c] * sides.second[c][j][m];
          for (int d = 0; d < 3; ++d) {
            result[i][j][m] += bent[i][c][d] * sides.first[c][j] * sides.first[d][m];
          }
        }
      }
    }
  }
  return result;
}

}  // namespace moduli
