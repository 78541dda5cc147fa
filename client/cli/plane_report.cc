#include "client/cli/plane_report.h"

#include <algorithm>
#include <vector>

#include "client/cli/output.h"
#include "client/cli/report_lines.h"

namespace moduli::cli {
namespace {

std::string torusLines(const v1::TorusDomain& torus) {
  std::string generators;
  for (const v1::Complex& generator : torus.generators()) {
    generators += (generators.empty() ? "" : ",  ") + complexText(generator);
  }
  return line("tau", complexText(torus.tau())) +
         line("lattice", generators + (torus.parallelogram() ? ", cut along its two generators"
                                                             : ", cut along some graph"));
}

// As many as fit a line.
std::string coneLines(const v1::ConeMetric& metric) {
  constexpr int kShown = 4;
  if (metric.cones().empty()) return line("cones", "none");
  std::vector<std::string> parts = {counted(metric.cones_size(), "cone", "cones")};
  for (int n = 0; n < std::min(kShown, metric.cones_size()); ++n) {
    const v1::Cone& cone = metric.cones(n);
    parts.push_back(brief(cone.curvature()) + (cone.vertex() < 0
                                                   ? std::string(" in a filled hole")
                                                   : " at " + std::to_string(cone.vertex())));
  }
  std::string text = joinedLine("cones", parts);
  if (metric.cones_size() > kShown) text.insert(text.size() - 1, ", ...");
  if (metric.has_spread() && metric.has_spread_before()) {
    text += line("", "logarithms of the scale spread over about " + brief(metric.spread()) +
                         ", without cones " + brief(metric.spread_before()));
  }
  if (metric.handle_turns_size() > 0) {
    text += line("handles", "turn by " + spectrumText(metric.handle_turns()));
  }
  return text;
}

std::string quadLines(const v1::QuadDomain& quads) {
  std::string text =
      joinedLine("squares", {brief(quads.squares()), "misfit " + brief(quads.misfit()),
                             counted(quads.zeros_size(), "zero of the form", "zeros of the form")});
  std::string periods;
  for (const v1::Complex& period : quads.periods()) {
    periods += (periods.empty() ? "" : ",  ") + complexText(period);
  }
  return text + line("periods", periods);
}

std::string atlasLine(const v1::AtlasSummary& atlas) {
  return joinedLine("atlas", {counted(atlas.charts(), "chart", "charts"),
                              counted(atlas.transitions(), "transition", "transitions"),
                              "they fit to " + brief(atlas.overlap_residual()),
                              "around faces to " + brief(atlas.cocycle_residual())});
}

}  // namespace

std::string planeLines(const v1::Parameterization& result) {
  std::string text;
  if (result.has_torus()) text += torusLines(result.torus());
  if (result.has_cone_metric()) text += coneLines(result.cone_metric());
  if (result.has_quads()) text += quadLines(result.quads());
  if (result.has_atlas()) text += atlasLine(result.atlas());
  return text;
}

}  // namespace moduli::cli
