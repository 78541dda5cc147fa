#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/text.h"
#include "core/mesh/sample_tools.h"
#include "core/mesh/write.h"
#include "core/picture/precision_recall.h"
#include "tests/bench/retrieval/score.h"
#include "tests/bench/retrieval/variants.h"

/// moduli_retrieval_bench [--max-faces N] [--seed N] [--shapes LABEL,...] [--kinds KIND,...]
///                        [--descriptors NAME,...] [--out DIR] [--curves FILE.svg] [--json]
///                        [--verbose]
///
/// Makes the benchmark of variants.h, scores descriptors on it and prints tables. --descriptors: of
/// moduli, D2, LB; "none" to make the benchmark alone. --out: writes DIR/LABEL/NAME.off and
/// DIR/manifest.csv. --curves: draws precision over recall.
namespace moduli {
namespace {

struct Settings {
  BaseOptions base;
  std::size_t seed = 1;
  std::set<std::string> shapes;  ///< Empty: all.
  std::set<std::string> kinds;   ///< Of variants; empty: all.
  std::set<std::string> descriptors = {"moduli", "D2", "LB"};
  std::string out;
  std::string curves;
  bool json = false;
  bool verbose = false;
};

std::set<std::string> splitAtCommas(const std::string& text) {
  std::set<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.insert(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

Status usage(const std::string& what) {
  return {
      Reason::kInvalidOption, what,
      "options are --max-faces N, --seed N, --shapes LABEL,..., --kinds KIND,..., --descriptors "
      "NAME,..., --out DIR, --curves FILE.svg, --json, --verbose"};
}

Result<std::size_t> countOf(const std::string& option, const std::string& text) {
  const auto value = parseInteger(text);
  if (!value || *value < 0) return usage(option + " takes a whole number, not '" + text + "'");
  return static_cast<std::size_t>(*value);
}

Result<Settings> parse(const std::vector<std::string>& arguments) {
  Settings settings;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& option = arguments[i];
    if (option == "--json" || option == "--verbose") {
      (option == "--json" ? settings.json : settings.verbose) = true;
      continue;
    }
    if (i + 1 == arguments.size()) return usage("'" + option + "' is unknown or lacks its value");
    const std::string& value = arguments[++i];
    if (option == "--max-faces") {
      ASSIGN_OR_RETURN(settings.base.max_faces, countOf(option, value));
    } else if (option == "--seed") {
      ASSIGN_OR_RETURN(settings.seed, countOf(option, value));
    } else if (option == "--shapes") {
      settings.shapes = splitAtCommas(value);
    } else if (option == "--kinds") {
      settings.kinds = splitAtCommas(value);
    } else if (option == "--descriptors") {
      settings.descriptors = splitAtCommas(value);
    } else if (option == "--out") {
      settings.out = value;
    } else if (option == "--curves") {
      settings.curves = value;
    } else {
      return usage("there is no option '" + option + "'");
    }
  }
  return settings;
}

// In an order that says nothing of labels, as ties are broken by it.
void shuffle(std::vector<Variant>& variants, std::size_t seed) {
  SampleRandom random(seed);
  for (std::size_t i = variants.size(); i > 1; --i) {
    std::swap(variants[i - 1], variants[random.next() % i]);
  }
}

Result<std::vector<Variant>> makeAll(Context& context, const Settings& settings) {
  ASSIGN_OR_RETURN(std::vector<BaseShape> shapes, loadBaseShapes(context, settings.base));
  if (!settings.shapes.empty()) {
    std::erase_if(shapes,
                  [&](const auto& shape) { return !settings.shapes.contains(shape.label); });
  }
  std::vector<Result<std::vector<Variant>>> made(shapes.size(), std::vector<Variant>());
  parallelBlocks(shapes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) made[i] = makeVariants(shapes[i], settings.seed);
  });
  std::vector<Variant> variants;
  for (auto& of_shape : made) {
    if (!of_shape.ok()) return of_shape.status();
    std::move(of_shape->begin(), of_shape->end(), std::back_inserter(variants));
  }
  if (!settings.kinds.empty()) {
    std::erase_if(variants, [&](const auto& v) { return !settings.kinds.contains(v.kind); });
  }
  return variants;
}

Status writeAll(const std::string& folder, const std::vector<Variant>& variants) {
  std::string manifest = "file,label,kind,vertices,faces\n";
  for (const Variant& variant : variants) {
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(folder) / variant.label, error);
    if (error) return {Reason::kFileUnwritable, folder + ": " + error.message()};
    const std::string name = variant.label + '/' + variant.name + ".off";
    ASSIGN_OR_RETURN(const std::string bytes, writeMesh(variant.soup, MeshFormat::kOff));
    RETURN_IF_ERROR(writeFile(folder + '/' + name, bytes));
    manifest += name + ',' + variant.label + ',' + variant.kind + ',' +
                std::to_string(variant.soup.vertices.size()) + ',' +
                std::to_string(variant.soup.faces.size()) + '\n';
  }
  return writeFile(folder + "/manifest.csv", manifest);
}

Result<std::vector<DescriptorScores>> scoreAll(Context& context, const Settings& settings,
                                               const std::vector<Variant>& variants) {
  const std::vector<std::pair<std::string, Descriptor>> known = {
      {"moduli", moduliDescriptor()}, {"D2", d2Descriptor()}, {"LB", laplaceDescriptor()}};
  std::vector<DescriptorScores> all;
  for (const auto& [name, descriptor] : known) {
    if (!settings.descriptors.contains(name)) continue;
    ASSIGN_OR_RETURN(auto scores, scoreDescriptor(context, descriptor, variants));
    for (const std::string& failure : scores.front().failures) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), failure.c_str());
    }
    std::move(scores.begin(), scores.end(), std::back_inserter(all));
  }
  return all;
}

Status drawCurves(const std::string& file, const std::vector<DescriptorScores>& scores) {
  std::vector<PrecisionRecallCurve> curves;
  for (const DescriptorScores& score : scores) {
    curves.push_back({score.name, score.evaluation.precision});
  }
  ASSIGN_OR_RETURN(const std::string svg, drawPrecisionRecall(curves));
  return writeFile(file, svg);
}

void printSummary(const std::vector<Variant>& variants) {
  std::set<std::string> labels;
  std::size_t least = variants.front().soup.faces.size(), most = least;
  for (const Variant& variant : variants) {
    labels.insert(variant.label);
    least = std::min(least, variant.soup.faces.size());
    most = std::max(most, variant.soup.faces.size());
  }
  std::printf("%zu shapes, %zu variants of %zu to %zu faces\n\n", labels.size(), variants.size(),
              least, most);
}

void printClasses(const DescriptorScores& score) {
  std::printf("\n%s: mean average precision, nearest neighbour, and whom else it took for\n",
              score.name.c_str());
  for (const ClassEvaluation& of_class : score.evaluation.per_class) {
    std::printf("  %-16s %.3f %.3f ", of_class.label.c_str(),
                of_class.scores.mean_average_precision, of_class.scores.nearest_neighbour);
    for (const auto& [label, count] : of_class.nearest) {
      if (label == of_class.label) continue;
      std::printf(" %s %zu", label.empty() ? "(none)" : label.c_str(), count);
    }
    std::printf("\n");
  }
}

Status run(const std::vector<std::string>& arguments) {
  ASSIGN_OR_RETURN(const Settings settings, parse(arguments));
  Context context;
  ASSIGN_OR_RETURN(std::vector<Variant> variants, makeAll(context, settings));
  if (variants.empty()) return usage("no variant has one of these labels and kinds");
  if (!settings.out.empty()) RETURN_IF_ERROR(writeAll(settings.out, variants));
  shuffle(variants, settings.seed);
  ASSIGN_OR_RETURN(const auto scores, scoreAll(context, settings, variants));
  if (!settings.curves.empty()) RETURN_IF_ERROR(drawCurves(settings.curves, scores));
  if (settings.json) {
    std::fputs(scoreJson(scores).c_str(), stdout);
    return {};
  }
  printSummary(variants);
  if (scores.empty()) return {};
  std::fputs(scoreTable(scores).c_str(), stdout);
  if (settings.verbose) std::for_each(scores.begin(), scores.end(), printClasses);
  return {};
}

}  // namespace
}  // namespace moduli

int main(int argc, char** argv) {
  const moduli::Status status = moduli::run({argv + 1, argv + argc});
  if (status.ok()) return EXIT_SUCCESS;
  std::fprintf(stderr, "moduli_retrieval_bench: %s\n", status.toString().c_str());
  return EXIT_FAILURE;
}
