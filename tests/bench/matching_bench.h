#pragma once

#include <memory>

#include "tests/bench/case.h"

namespace moduli {

/// match/thin, spectral, spectra, points, canonical, fit, whole, inverse, judge and all of a closed
/// surface onto itself with 70 % of the faces; nothing of others. Each is the cost of that step
/// alone, after those before it, for both surfaces where it takes both, in F of the whole one:
/// `thin` what stands for surfaces of many vertices, `spectral` what makeSpectralSurface does,
/// `canonical` the maps to the sphere or the other surface's metric of constant curvature, `all` a
/// match from beginning to end, with its stages. `fit` counts the alignment of the spheres, or all
/// of matchHarmonically, and the settling; `whole` the way back to all vertices.
///
/// On two cores all but `canonical` and `all` are 9.7 F together of a head of 100,000 faces, and
/// 12.4 F of a surface of genus 1 of 80,000; up to 2.5 F more where several answers are nearly as
/// good and coarse maps of them are compared.
void registerMatching(const std::shared_ptr<Case>& mesh);

}  // namespace moduli
