// moduli_descriptor_scales: prints the table kPartScales of core/signature/descriptor.cc, the
// root mean square distance in each part of the descriptor of all pairs of a generic set: sample
// surfaces, and the real meshes of $MODULI_SHARED/meshes (tests/core/testing.h), one each of a
// shape.
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/forms/cotan.h"
#include "core/intrinsic/mollify.h"
#include "core/mesh/prepare.h"
#include "core/mesh/read.h"
#include "core/mesh/samples.h"
#include "core/signature/descriptor.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using Parts = std::map<std::string, std::vector<double>>;

struct Sample {
  const char* kind;
  std::map<std::string, double> parameters;
};

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = {
      {"sphere", {{"resolution", 16}}},
      {"ellipsoid", {{"b", 0.7}, {"c", 0.4}, {"resolution", 16}}},
      {"spheroid", {{"c", 0.3}, {"resolution", 16}}},
      {"capped-cylinder", {{"half_length", 3}, {"resolution", 16}}},
      {"torus", {{"R", 3}, {"r", 0.6}, {"resolution", 32}}},
      {"torus", {{"R", 1.5}, {"r", 1}, {"resolution", 32}}},
      {"diplotorus", {{"resolution", 12}}},
      {"genus", {{"genus", 2}, {"resolution", 8}}},
      {"genus", {{"genus", 4}, {"resolution", 8}}},
      {"annulus", {{"resolution", 16}}},
      {"disk", {{"resolution", 24}}},
      {"plate", {{"resolution", 8}}}};
  return all;
}

const std::vector<std::string>& files() {
  static const std::vector<std::string> all = {"closed_g0/odedstein__bunny.obj",
                                               "closed_g0/odedstein__goathead.obj",
                                               "closed_g0/odedstein__penguin.obj",
                                               "closed_g0/cfwen__maxplanck.nf25k.off",
                                               "closed_g0/alec__spot.obj",
                                               "closed_g0/alec__homer.obj",
                                               "closed_g0/libigl-data__fandisk.off",
                                               "closed_g0/libigl-data__screwdriver.off",
                                               "closed_g0/libigl-data__decimated-knight.off",
                                               "disk/libigl-data__camelhead.off",
                                               "disk/libigl-data__lion.off",
                                               "disk/libigl-data__snail.obj",
                                               "disk/bff__face.obj",
                                               "disk/alec__woody.obj",
                                               "multi_boundary/gpeyre__nefertiti-entire.off",
                                               "multi_boundary/gpeyre__pipes.off",
                                               "multi_boundary/libigl-data__halftunnel.off",
                                               "genus1/ceaedf__Kitten.off",
                                               "genus1/cfwen__knot.obj",
                                               "genus1/alec__rocker-arm.obj",
                                               "genus2/cfwen__eight.off",
                                               "genus2/odedstein__skull_low_resolution.obj",
                                               "genus2/ceaedf__cup_input_simple_10000.off",
                                               "genus3plus/libigl-data__3holes.off",
                                               "genus3plus/libigl-data__fertility.off",
                                               "genus3plus/odedstein__boot.obj",
                                               "brain/nilearn__pial_left.ply",
                                               "brain/nilearn__infl_left.ply"};
  return all;
}

Result<Parts> describe(Context& context, const TriangleSoup& soup) {
  PrepareOptions options;
  options.component = "largest";
  ASSIGN_OR_RETURN(const PreparedMesh prepared, prepareMesh(context, soup, options));
  const Connectivity& surface = prepared.mesh.connectivity();
  ASSIGN_OR_RETURN(const MollifiedLengths metric, mollify(surface, prepared.mesh.edgeLengths()));
  const std::vector<double> lengths = unitLengths(metric.lengths);
  ASSIGN_OR_RETURN(const SurfaceModes modes, surfaceModes(context, surface, lengths));
  ASSIGN_OR_RETURN(std::vector<DescriptorPart> shape,
                   shapeParts(context, prepared.mesh, lengths, modes));
  Parts parts;
  for (DescriptorPart& part : shape) parts[std::string(part.name)] = std::move(part.values);
  for (DescriptorPart& part : metricParts(modes)) {
    parts[std::string(part.name)] = std::move(part.values);
  }
  return parts;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

double meanDistance(const std::vector<Parts>& set, const std::string& name) {
  double sum = 0;
  int pairs = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j, ++pairs) {
      const double d = distance(set[i].at(name), set[j].at(name));
      sum += d * d;
    }
  }
  return std::sqrt(sum / pairs);
}

Result<std::vector<Parts>> describeAll(Context& context) {
  std::vector<Parts> set;
  for (const Sample& sample : samples()) {
    ASSIGN_OR_RETURN(const TriangleSoup soup, makeSample(sample.kind, sample.parameters));
    ASSIGN_OR_RETURN(Parts parts, describe(context, soup));
    set.push_back(std::move(parts));
  }
  for (const std::string& file : files()) {
    const auto path = sharedMesh(file);
    if (!path) {
      std::fprintf(stderr, "without %s\n", file.c_str());
      continue;
    }
    ASSIGN_OR_RETURN(const TriangleSoup soup, readMeshFile(context, *path));
    auto parts = describe(context, soup);
    if (!parts.ok()) {
      std::fprintf(stderr, "%s: %s\n", file.c_str(), parts.status().toString().c_str());
      continue;
    }
    set.push_back(*std::move(parts));
  }
  return set;
}

}  // namespace
}  // namespace moduli

int main() {
  moduli::Context context;
  const auto set = moduli::describeAll(context);
  if (!set.ok()) {
    std::fprintf(stderr, "%s\n", set.status().toString().c_str());
    return 1;
  }
  std::printf("%zu surfaces\n", set->size());
  for (const moduli::PartScale& part : moduli::kPartScales) {
    const std::string name(part.name);
    std::printf("{\"%s\"sv, %.3g},\n", name.c_str(), moduli::meanDistance(*set, name));
  }
  return 0;
}
