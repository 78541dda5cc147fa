#include "core/intrinsic/intrinsic_triangulation.h"

#include <array>
#include <cstdlib>
#include <utility>

namespace moduli {

/// The four halfedges around h that a flip moves, and where each goes; undoing goes backwards.
struct IntrinsicTriangulation::Surrounding {
  std::array<Index, 4> from, to;

  Surrounding(Index h, Index t) {
    const Index h1 = Connectivity::next(h), h2 = Connectivity::previous(h);
    const Index t1 = Connectivity::next(t), t2 = Connectivity::previous(t);
    from = {h2, t1, t2, h1};
    to = {h1, h2, t1, t2};
  }

  void reverse() { std::swap(from, to); }

  /// The new number of a halfedge.
  Index moved(Index g) const {
    for (int n = 0; n < 4; ++n) {
      if (from[n] == g) return to[n];
    }
    return g;
  }
};

IntrinsicTriangulation::IntrinsicTriangulation(const Connectivity& surface,
                                               const std::vector<double>& half_chords)
    : vertex_count_(surface.vertexCount()) {
  const Index count = surface.halfedgeCount();
  tail_.resize(count);
  twin_.resize(count);
  half_chord_.resize(count);
  for (Index h = 0; h < count; ++h) {
    tail_[h] = surface.tail(h);
    twin_[h] = surface.twin(h);
    half_chord_[h] = half_chords[surface.edge(h)];
  }
}

void IntrinsicTriangulation::setHalfChords(std::vector<double> half_chords) {
  half_chord_ = std::move(half_chords);
}

bool IntrinsicTriangulation::canFlip(Index h) const {
  return twin_[h] != kNone && twin_[h] / 3 != h / 3;
}

double IntrinsicTriangulation::ptolemyDiagonal(Index h) const {
  const Index t = twin_[h];
  const double jk = half_chord_[Connectivity::next(h)], ki = half_chord_[Connectivity::previous(h)];
  const double il = half_chord_[Connectivity::next(t)], lj = half_chord_[Connectivity::previous(t)];
  return (ki * lj + jk * il) / half_chord_[h];
}

void IntrinsicTriangulation::glue(Index h, Index twin) {
  twin_[h] = twin;
  if (twin != kNone) twin_[twin] = h;
}

/// Moves the four edges around h and gives h another half chord; tails are the caller's.
void IntrinsicTriangulation::rearrange(Index h, const Surrounding& ring, double half_chord) {
  const Index t = twin_[h];
  std::array<Index, 4> twins;
  std::array<double, 4> chords;
  for (int n = 0; n < 4; ++n) {
    twins[n] = twin_[ring.from[n]];
    chords[n] = half_chord_[ring.from[n]];
  }
  for (int n = 0; n < 4; ++n) {
    half_chord_[ring.to[n]] = chords[n];
    glue(ring.to[n], ring.moved(twins[n]));
  }
  glue(h, t);
  half_chord_[h] = half_chord_[t] = half_chord;
}

void IntrinsicTriangulation::setTails(Index h, Index tail, Index head, Index apex) {
  tail_[h] = tail;
  tail_[Connectivity::next(h)] = head;
  tail_[Connectivity::previous(h)] = apex;
}

void IntrinsicTriangulation::flip(Index h, double half_chord) {
  const Index t = twin_[h];
  history_.push_back({h, half_chord_[h]});
  const Index i = tail_[h], j = tail_[t];
  const Index k = tail_[Connectivity::previous(h)], l = tail_[Connectivity::previous(t)];
  rearrange(h, Surrounding(h, t), half_chord);
  setTails(h, l, k, i);
  setTails(t, k, l, j);
}

void IntrinsicTriangulation::undoLast() {
  const Flip last = history_.back();
  history_.pop_back();
  const Index h = last.halfedge, t = twin_[h];
  const Index l = tail_[h], k = tail_[t];
  const Index i = tail_[Connectivity::previous(h)], j = tail_[Connectivity::previous(t)];
  Surrounding ring(h, t);
  ring.reverse();
  rearrange(h, ring, last.half_chord);
  setTails(h, i, j, k);
  setTails(t, j, i, l);
}

void IntrinsicTriangulation::undoTo(std::size_t count) {
  while (history_.size() > count) undoLast();
}

Connectivity IntrinsicTriangulation::connectivity() const {
  std::vector<Triangle> faces(faceCount());
  for (Index f = 0; f < faceCount(); ++f)
    faces[f] = {tail_[3 * f], tail_[3 * f + 1], tail_[3 * f + 2]};
  Result<Connectivity> result = Connectivity::fromGluing(vertex_count_, std::move(faces), twin_);
  if (!result.ok()) std::abort();  // Flips keep manifolds.
  return *std::move(result);
}

std::vector<double> IntrinsicTriangulation::edgeHalfChords() const {
  // Edges of a Connectivity are numbered by their lowest halfedge, ascending.
  std::vector<double> result;
  result.reserve(half_chord_.size() / 2 + 1);
  for (Index h = 0; h < halfedgeCount(); ++h) {
    if (twin_[h] == kNone || h < twin_[h]) result.push_back(half_chord_[h]);
  }
  return result;
}

}  // namespace moduli
