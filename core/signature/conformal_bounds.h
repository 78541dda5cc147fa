#pragma once

#include <optional>
#include <span>

#include "core/signature/signature.h"

/// Lower bounds of the Teichmüller distance of surfaces whose marking is not known.
namespace moduli {

/// Numbers of the classes of a surface, ascending: all up to complete_to, and none beyond.
struct KnownNumbers {
  std::span<const double> values;  ///< > 0.
  double complete_to = 0;
};

/// The largest |log(a_i / b_i)| / 2, which is at most log(K) / 2 where some correspondence of all
/// classes changes each number by a factor between 1/K and K: as many classes of b have numbers up
/// to K x as classes of a have up to x. Where one list has more numbers than the other, the next
/// one of the other is beyond its complete_to, and counts as that where it is too far off even so.
/// Nothing where neither has a number. O(n).
std::optional<double> spectrumBound(const KnownNumbers& a, const KnownNumbers& b);

/// Bounds of the Teichmüller distance log(K) / 2 of two surfaces of one topology, orientation
/// forgotten; each is there where both signatures have what it takes.
///
/// energies: a K-quasiconformal map changes the energy of an integer class by a factor of at most
/// K. lengths, boundary: it changes the length of a closed geodesic by a factor of at most K
/// (Wolpert's lemma), and so that of the geodesics that the loops become; of a surface with a
/// boundary it extends to the double.
///
/// They are bounds up to discretization. Energies are those of the polyhedral surfaces up to their
/// certified errors. Nothing certifies the errors of lengths; on meshes of smooth surfaces they are
/// of second order in the edges and as large as those of energies: one surface of genus 2 (the
/// sample), meshed with 1600, 6400, 25600 and 102400 faces, is from its finest mesh by energies
/// 0.0012, 0.0003, 0.0001 and by lengths 0.0020, 0.0005, 0.0001; two meshes of an eight, with 1536
/// and 11092 faces, by 0.011 and 0.009. Surfaces that are nearer than that are not told apart.
/// Source: MATH 7.9; Wolpert 1979.
struct ConformalBounds {
  std::optional<double> energies, lengths, boundary;

  /// Nothing where there is none.
  std::optional<double> largest() const;
};

/// Meant for surfaces of negative Euler characteristic and of one topology. O(n).
ConformalBounds conformalBounds(const Signature& a, const Signature& b);

}  // namespace moduli
