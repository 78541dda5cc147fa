#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/signature/surface_modes.h"

/// The vectors of the metric and the shape space: one length for surfaces of every topology, with
/// or without boundary, so that any two can be compared. Euclidean distances.
namespace moduli {

inline constexpr int kMetricLength = 113;
inline constexpr int kShapeLength = 251;

/// Part of a vector before it is scaled.
struct DescriptorPart {
  std::string_view name;
  std::vector<double> values;
};

/// What bending without stretching keeps. Parts: "spectrum" (spectrumBands), "heat-T" for all times
/// T = 0 .. 7 (heatKernelQuantiles), "wave-E" for all energies E = 0 .. 7 (waveKernelQuantiles).
std::vector<DescriptorPart> metricParts(const SurfaceModes& modes);

/// What rigid motion and scaling keep. Parts: those of the metric, but every second time of the
/// heat kernel alone; "bend-0", "bend-1" (roots of shapeIndexHistogram at both times of smoothing);
/// "surface", "solid" (shellPower). lengths: per edge, proper triangles.
/// Fails as smoothedCurvatures and shellPower do. About 4 F. Stages as theirs.
Result<std::vector<DescriptorPart>> shapeParts(Context& context, const TriangleMesh& mesh,
                                               const std::vector<double>& lengths,
                                               const SurfaceModes& modes);

/// The parts over their kPartScales one after the other, each times the root of its weight: 1 for
/// "bend-0", "bend-1", "surface", "solid" and all energies of "wave" together; 1/2 for "spectrum"
/// and all times of "heat" together, which say much of the same.
std::vector<double> weighParts(const std::vector<DescriptorPart>& parts);

/// Root mean square distance of two surfaces of a generic set in one part alone: 12 samples of all
/// kinds (core/mesh/samples.h) and 28 real meshes, closed and bordered, one each of a shape, as
/// moduli_descriptor_scales prints it. (Medians would not do: of the heat kernel at late times most
/// surfaces have none to speak of, and long ones very much.)
struct PartScale {
  std::string_view name;
  double scale;
};
inline constexpr int kPartCount = 21;
extern const std::array<PartScale, kPartCount> kPartScales;

/// How far apart two surfaces are in a family of parts alone: "spectrum", "heat", "wave", and in
/// the shape space "bend", "surface" and "solid".
struct FamilyDistance {
  std::string_view name;
  double distance;
};

/// By family; the squares add up to that of the distance of the vectors. a, b: vectors of the
/// metric space (kMetricLength numbers) or of the shape space (kShapeLength); nothing for others.
/// O(length).
std::vector<FamilyDistance> familyDistances(std::span<const float> a, std::span<const float> b);

}  // namespace moduli
