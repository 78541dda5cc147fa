#include "core/intrinsic/intrinsic_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <utility>

#include "core/intrinsic/assemble_surface.h"

namespace moduli {
namespace {

/// Two by two, row by row.
using Matrix = std::array<int, 4>;

/// A group of matrices modulo a prime, or of such matrices up to sign, and two elements of it.
struct Rotations {
  int prime = 2;
  bool up_to_sign = false;
  Matrix turn_face{};     ///< Of order 3.
  Matrix cross_edge{};    ///< Of order 2.
  int around_vertex = 0;  ///< The order of turn_face * cross_edge.
};

class RotationGroup {
 public:
  explicit RotationGroup(const Rotations& rotations) : rotations_(rotations) {}

  Matrix one() const { return normal({1, 0, 0, 1}); }

  Matrix multiply(const Matrix& a, const Matrix& b) const {
    return normal({a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2],
                   a[2] * b[1] + a[3] * b[3]});
  }

 private:
  Matrix normal(Matrix m) const {
    const int p = rotations_.prime;
    Matrix opposite{};
    for (std::size_t k = 0; k < m.size(); ++k) {
      m[k] = (m[k] % p + p) % p;
      opposite[k] = (p - m[k]) % p;
    }
    return rotations_.up_to_sign ? std::min(m, opposite) : m;
  }

  const Rotations& rotations_;
};

/// GL(2, 3), of order 48; the product of the two has the order of the Fibonacci numbers modulo 3.
constexpr Rotations kBolza = {3, false, {1, 1, 0, 1}, {0, 1, 1, 0}, 8};
/// PSL(2, 7), of order 168; the product of the two is a translation.
constexpr Rotations kKlein = {7, true, {0, -1, 1, 1}, {0, -1, 1, 0}, 7};

struct Gluing {
  std::vector<Matrix> halfedges;  ///< Three by three: those of a face.
  std::map<Matrix, Index> number;
};

/// The group's elements are the halfedges of a map on which it acts by rotations: g * turn_face is
/// the next one in the face of g, g * cross_edge the opposite one. Faces are found one from the
/// other, so that neighbours have near numbers.
Gluing numberHalfedges(const RotationGroup& group, const Rotations& rotations) {
  Gluing gluing;
  std::deque<Matrix> open = {group.one()};
  while (!open.empty()) {
    Matrix g = open.front();
    open.pop_front();
    if (gluing.number.contains(g)) continue;
    for (int c = 0; c < 3; ++c) {
      gluing.number[g] = static_cast<Index>(gluing.halfedges.size());
      gluing.halfedges.push_back(g);
      open.push_back(group.multiply(g, rotations.cross_edge));
      g = group.multiply(g, rotations.turn_face);
    }
  }
  return gluing;
}

/// Gives every corner its vertex: all corners that turning around it meets.
Index numberVertices(const std::vector<Index>& twin, std::vector<Triangle>& faces) {
  Index count = 0;
  for (Index start = 0; start < static_cast<Index>(twin.size()); ++start) {
    if (faces[start / 3][start % 3] != kNone) continue;
    for (Index h = start; faces[h / 3][h % 3] == kNone; h = twin[Connectivity::previous(h)]) {
      faces[h / 3][h % 3] = count;
    }
    ++count;
  }
  return count;
}

Result<IntrinsicSurface> makeRegular(const Rotations& rotations) {
  const RotationGroup group(rotations);
  const Gluing gluing = numberHalfedges(group, rotations);
  SurfaceTables tables;
  tables.geometry = Geometry::kHyperbolic;
  tables.twin.emplace();
  for (const Matrix& g : gluing.halfedges) {
    tables.twin->push_back(gluing.number.at(group.multiply(g, rotations.cross_edge)));
  }
  tables.faces.assign(gluing.halfedges.size() / 3, {kNone, kNone, kNone});
  tables.vertex_count = numberVertices(*tables.twin, tables.faces);
  const double half = std::acosh(1 / (2 * std::sin(std::numbers::pi / rotations.around_vertex)));
  tables.lengths.assign(gluing.halfedges.size(), 2 * half);
  Context context;
  return assembleSurface(context, std::move(tables));
}

}  // namespace

const std::vector<SampleKind>& intrinsicSampleKinds() {
  static const std::vector<SampleKind> kinds = {
      {"bolza", "Bolza's hyperbolic surface of genus 2 from 16 triangles (.json only)", {}},
      {"klein", "Klein's hyperbolic quartic of genus 3 from 56 triangles (.json only)", {}}};
  return kinds;
}

Result<IntrinsicSurface> makeIntrinsicSample(const std::string& kind) {
  if (kind == "bolza") return makeRegular(kBolza);
  if (kind == "klein") return makeRegular(kKlein);
  return Status(Reason::kInvalidOption, "there is no sample '" + kind + "'",
                "the kinds are bolza, klein");
}

}  // namespace moduli
