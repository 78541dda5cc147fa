#include "core/signature/descriptor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "core/signature/curvature_fields.h"
#include "core/signature/kernel_blocks.h"
#include "core/signature/shell_power.h"
#include "core/signature/soft_bins.h"
#include "core/signature/surface_points.h"

namespace moduli {
namespace {

using namespace std::string_view_literals;

constexpr std::array<std::string_view, kHeatTimes> kHeatNames = {
    "heat-0"sv, "heat-1"sv, "heat-2"sv, "heat-3"sv, "heat-4"sv, "heat-5"sv, "heat-6"sv, "heat-7"sv};
constexpr std::array<std::string_view, kWaveEnergies> kWaveNames = {
    "wave-0"sv, "wave-1"sv, "wave-2"sv, "wave-3"sv, "wave-4"sv, "wave-5"sv, "wave-6"sv, "wave-7"sv};
constexpr std::array<std::string_view, 2> kBendNames = {"bend-0"sv, "bend-1"sv};

/// Shares below this count as it: the root of a share that comes and goes stays continuous.
constexpr double kShareFloor = 0.003;

/// The family of a part: its name up to a dash.
std::string_view familyOf(std::string_view name) {
  return name.substr(0, name.find('-'));
}

bool isKernel(std::string_view name) {
  return familyOf(name) == "heat"sv || familyOf(name) == "wave"sv;
}

/// The spectrum and the heat kernel say much of the same.
double familyWeight(std::string_view name) {
  return name == "spectrum"sv || familyOf(name) == "heat"sv ? 0.5 : 1;
}

double scaleOf(std::string_view name) {
  const auto* found = std::find_if(kPartScales.begin(), kPartScales.end(),
                                   [&](const PartScale& part) { return part.name == name; });
  return found->scale;
}

std::vector<DescriptorPart> kernelParts(const SurfaceModes& modes, int first_time, int time_step) {
  std::vector<DescriptorPart> parts = {{"spectrum"sv, spectrumBands(modes)}};
  const auto heat = heatKernelQuantiles(modes);
  for (int time = first_time; time < kHeatTimes; time += time_step) {
    parts.push_back({kHeatNames[time], heat[time]});
  }
  const auto wave = waveKernelQuantiles(modes);
  for (int energy = 0; energy < kWaveEnergies; ++energy) {
    parts.push_back({kWaveNames[energy], wave[energy]});
  }
  return parts;
}

}  // namespace

const std::array<PartScale, kPartCount> kPartScales = {
    {{"spectrum"sv, 1.93}, {"heat-0"sv, 0.421}, {"heat-1"sv, 0.48},  {"heat-2"sv, 0.603},
     {"heat-3"sv, 0.767},  {"heat-4"sv, 0.94},  {"heat-5"sv, 1},     {"heat-6"sv, 0.82},
     {"heat-7"sv, 0.453},  {"wave-0"sv, 1.43},  {"wave-1"sv, 1.16},  {"wave-2"sv, 0.873},
     {"wave-3"sv, 0.66},   {"wave-4"sv, 0.592}, {"wave-5"sv, 0.586}, {"wave-6"sv, 0.534},
     {"wave-7"sv, 0.515},  {"bend-0"sv, 0.769}, {"bend-1"sv, 0.792}, {"surface"sv, 0.377},
     {"solid"sv, 0.663}}};

std::vector<DescriptorPart> metricParts(const SurfaceModes& modes) {
  return kernelParts(modes, 0, 1);
}

Result<std::vector<DescriptorPart>> shapeParts(Context& context, const TriangleMesh& mesh,
                                               const std::vector<double>& lengths,
                                               const SurfaceModes& modes) {
  std::vector<DescriptorPart> parts = kernelParts(modes, 1, 2);
  const SurfacePoints points = surfacePoints(mesh);
  ASSIGN_OR_RETURN(const std::vector<SmoothedCurvatures> curvatures,
                   smoothedCurvatures(context, mesh, lengths, points.radius * points.unit));
  for (std::size_t time = 0; time < kBendNames.size(); ++time) {
    std::vector<double> shares = shapeIndexHistogram(curvatures[time]);
    for (double& share : shares) share = std::sqrt(share + kShareFloor);
    parts.push_back({kBendNames[time], std::move(shares)});
  }
  ASSIGN_OR_RETURN(ShellPower shells, shellPower(context, points));
  parts.push_back({"surface"sv, std::move(shells.surface)});
  parts.push_back({"solid"sv, std::move(shells.solid)});
  return parts;
}

std::vector<double> weighParts(const std::vector<DescriptorPart>& parts) {
  std::vector<double> result;
  for (const DescriptorPart& part : parts) {
    const auto shared = std::count_if(parts.begin(), parts.end(), [&](const DescriptorPart& other) {
      return isKernel(part.name) && familyOf(other.name) == familyOf(part.name);
    });
    const double weight =
        familyWeight(part.name) / static_cast<double>(std::max<std::ptrdiff_t>(1, shared));
    const double factor = std::sqrt(weight) / scaleOf(part.name);
    std::transform(part.values.begin(), part.values.end(), std::back_inserter(result),
                   [factor](double value) { return factor * value; });
  }
  return result;
}

std::vector<FamilyDistance> familyDistances(std::span<const float> a, std::span<const float> b) {
  struct Family {
    std::string_view name;
    int length;
  };
  constexpr int kHeat = kHeatTimes * kTailedParts, kWave = kWaveEnergies * kTailedParts;
  constexpr std::array<Family, 3> kMetric = {
      {{"spectrum"sv, kSpectrumBands}, {"heat"sv, kHeat}, {"wave"sv, kWave}}};
  constexpr std::array<Family, 6> kShape = {{{"spectrum"sv, kSpectrumBands},
                                             {"heat"sv, kHeat / 2},
                                             {"wave"sv, kWave},
                                             {"bend"sv, 2 * kShapeIndexBins},
                                             {"surface"sv, kShellPowerLength},
                                             {"solid"sv, kShellPowerLength}}};
  std::span<const Family> families;
  if (a.size() == kMetricLength) families = kMetric;
  if (a.size() == kShapeLength) families = kShape;
  if (a.size() != b.size()) families = {};
  std::vector<FamilyDistance> result;
  std::size_t i = 0;
  for (const Family& family : families) {
    double sum = 0;
    for (const std::size_t end = i + static_cast<std::size_t>(family.length); i < end; ++i) {
      const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
      sum += difference * difference;
    }
    result.push_back({family.name, std::sqrt(sum)});
  }
  return result;
}

}  // namespace moduli
