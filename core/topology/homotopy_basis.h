#pragma once

#include <vector>

#include "core/base/status.h"
#include "core/mesh/connectivity.h"
#include "core/topology/homology.h"
#include "core/topology/tree_cotree.h"

/// Canonical generators of the fundamental group of a closed surface: loops a_1, b_1, .. a_g, b_g
/// from one vertex with a_1 b_1 a_1^-1 b_1^-1 .. a_g b_g a_g^-1 b_g^-1 = 1 and no other relation.
///
///   ASSIGN_OR_RETURN(const TreeCotree trees, computeTreeCotree(surface));
///   ASSIGN_OR_RETURN(const HomotopyBasis basis, canonicalHomotopyBasis(surface, trees));
///   const Walk loop = walkOfWord(surface, trees, basis.a[0]);
///
/// Words are products of paths, read from the left: the first letter is walked first. In homology
/// a_i . b_i = +1, as for the x axis and the y axis: b_i passes a_i from right to left; all other
/// products are 0.
namespace moduli {

/// A product of loops: letter k + 1 is basedLoop k, letter -(k + 1) its inverse.
using Word = std::vector<int>;

/// The word of the inverse: backwards, with signs changed.
Word inverseWord(const Word& word);

/// The shortest word that is equal in the free group: neighbours x, -x are struck out. O(n).
Word reduceWord(const Word& word);

/// The relation between the leftover edges' loops: the polygon that remains of a closed surface
/// when it is cut along the vertices' tree and the leftover edges, walked around counter-clockwise,
/// with its faces on the left, from the first leftover edge on.
///
/// 4 g letters, each of 1 .. 2 g once with either sign (the edges of the tree shrink to the base
/// point); empty for the sphere. Letter k + 1 where the walk runs along leftover edge k in its
/// direction. surface: closed and connected; trees: of computeTreeCotree. O(V + E).
/// Source: MATH 1.
Word polygonWord(const Connectivity& surface, const TreeCotree& trees);

/// a_1 .. a_g and b_1 .. b_g.
struct HomotopyBasis {
  std::vector<Word> a, b;
};

/// Words a_i, b_i with prod a_i b_i a_i^-1 b_i^-1 = `polygon`, not up to conjugation or relations
/// but in the free group of its letters, which they generate; freely reduced, of O(g) letters each.
///
/// polygon: the boundary of a polygon whose sides are glued in pairs so that all corners meet at
/// one point: 4 g letters, each of 1 .. 2 g once with either sign. Fails with kInvalidOption if it
/// is not. O(g^2). Source: Brahana 1921; Massey, Algebraic Topology, chapter 1; MATH 1.
Result<HomotopyBasis> canonicalBasisOfPolygon(const Word& polygon);

/// Canonical generators of the fundamental group at the root of the vertices' tree (vertex 0):
/// those of polygonWord. surface: closed and connected of genus g >= 1 (kUnsupportedTopology
/// otherwise); trees: of computeTreeCotree. O(V + E + g^2). Source: MATH 1.
Result<HomotopyBasis> canonicalHomotopyBasis(const Connectivity& surface, const TreeCotree& trees);

/// The loop of a word, from the root and back along edges of the tree and leftover edges, without
/// steps that are at once taken back; empty where the letters cancel. Letters: +-1 .. +-#leftover.
/// trees: those of the surface. O(letters * depth of the tree).
Walk walkOfWord(const Connectivity& surface, const TreeCotree& trees, const Word& word);

}  // namespace moduli
