#include "client/cli/map_heat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "client/cli/map_measure.h"
#include "client/cli/map_pattern.h"

namespace moduli::cli {
namespace {

constexpr double kShown = 0.98;     // Of the area, on the bar.
constexpr double kRounding = 1e-9;  // What lies no farther beyond the bar is on it.

std::string number(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) {
    if (std::isfinite(value)) most = std::max(most, value);
  }
  return most;
}

// Of log(length of the image / length on the surface), at vertices: means of their faces by area.
std::vector<double> atVertices(const MapDrawing& drawing, const FaceMeasures& measures) {
  std::vector<double> sums(drawing.surface.size(), 0.0), weights(drawing.surface.size(), 0.0);
  for (std::size_t f = 0; f < drawing.faces.size(); ++f) {
    if (!std::isfinite(measures.log_scale[f])) continue;
    for (const int v : drawing.faces[f]) {
      const auto i = static_cast<std::size_t>(v);
      sums[i] += measures.area[f] * measures.log_scale[f];
      weights[i] += measures.area[f];
    }
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    sums[v] = weights[v] > 0 ? sums[v] / weights[v] : std::numeric_limits<double>::quiet_NaN();
  }
  return sums;
}

// A factor of at least `least` whose powers 1/2 have short names too: 1.1, 1.2, 1.5, 2, 4, 10, ...
double niceFactor(double least) {
  for (const double factor : {1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 4.0, 10.0, 25.0, 100.0}) {
    if (factor >= least * (1 - 1e-9)) return factor;
  }
  return std::pow(10, 2 * std::ceil(std::log10(std::min(least, 1e100)) / 2));
}

}  // namespace

MapHeat MapHeat::ofDilatation(const MapDrawing& drawing, bool in_hyperbolic_disk) {
  MapHeat heat(drawing);
  const FaceMeasures measures = measureFaces(drawing, in_hyperbolic_disk);
  const double most = largest(measures.dilatation);
  const NiceSpan span =
      niceSpan(std::max(0.01, areaQuantile(measures.dilatation, measures.area, kShown) - 1));
  heat.low_ = 1;
  heat.high_ = 1 + span.span;
  heat.legend_.title = "K";
  heat.legend_.color = heatColor;
  for (int k = 0; k <= span.parts; ++k) {
    const double place = double(k) / span.parts;
    const bool exceeded = k == span.parts && most > heat.high_ + kRounding;
    heat.legend_.ticks.push_back({place, (exceeded ? "≥ " : "") + number(1 + place * span.span)});
  }
  heat.summary_ = "dilatation: mean " + number(areaMean(measures.dilatation, measures.area)) +
                  ", 95 % ≤ " + number(areaQuantile(measures.dilatation, measures.area, 0.95)) +
                  ", max " + number(most);
  heat.values_ = measures.dilatation;
  heat.addFolds();
  return heat;
}

MapHeat MapHeat::ofScale(const MapDrawing& drawing, bool in_hyperbolic_disk) {
  MapHeat heat(drawing);
  heat.of_vertices_ = true;
  const FaceMeasures measures = measureFaces(drawing, in_hyperbolic_disk);
  const double mean = areaMean(measures.log_scale, measures.area);
  std::vector<double> sizes;
  double low = 0, high = 0;
  for (const double value : measures.log_scale) {
    sizes.push_back(std::abs(value - mean));
    if (!std::isfinite(value)) continue;
    low = std::min(low, value - mean);
    high = std::max(high, value - mean);
  }
  const double factor = niceFactor(std::exp(areaQuantile(sizes, measures.area, kShown)));
  heat.high_ = std::log(factor);
  heat.low_ = -heat.high_;
  heat.legend_.title = "scale";
  heat.legend_.color = [](double place) { return divergingColor(2 * place - 1); };
  const auto mark = [&](double place, double power) {
    const bool below = place == 0 && low < heat.low_ - kRounding,
               above = place == 1 && high > heat.high_ + kRounding;
    heat.legend_.ticks.push_back({place, (below   ? "≤ "
                                          : above ? "≥ "
                                                  : "") +
                                             number(std::pow(factor, power))});
  };
  for (int k = 0; k <= 4; ++k) mark(k / 4.0, k / 2.0 - 1);
  heat.summary_ =
      "lengths grow by " + number(std::exp(low)) + " to " + number(std::exp(high)) + " of the mean";
  heat.values_ = atVertices(drawing, measures);
  for (double& value : heat.values_) value -= mean;
  heat.addFolds();
  return heat;
}

void MapHeat::addFolds() {
  const std::vector<bool>& folded = drawing_->folded;
  if (std::find(folded.begin(), folded.end(), true) != folded.end()) {
    legend_.swatches.push_back({kFoldedInHeat, "folded"});
  }
}

Color MapHeat::at(int face, const Vec3& weights) const {
  const auto f = static_cast<std::size_t>(face);
  if (drawing_->folded[f]) return kFoldedInHeat;
  double value = 0;
  if (of_vertices_) {
    for (std::size_t k = 0; k < 3; ++k) {
      value += weights[k] * values_[static_cast<std::size_t>(drawing_->faces[f][k])];
    }
  } else {
    value = values_[f];
  }
  if (std::isnan(value)) return kUnmappedColor;
  return legend_.color((value - low_) / (high_ - low_));
}

}  // namespace moduli::cli
