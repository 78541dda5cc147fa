#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/mesh/samples.h"
#include "tests/bench/matching/errors.h"
#include "tests/bench/matching/pairs.h"
#include "tests/core/matching/lumps.h"

/// moduli_match_bench [--max-faces N] [--seed N] [--kinds KIND,...] [--noise SHARE]
///                    [--same-triangulation] [--samples] [--json] [MESH...]
///
/// Makes the pairs of pairs.h of the shared meshes, or of the given ones, matches them, and
/// prints how far the maps are from the truth, in roots of the area: the mean, what nine in ten do
/// not exceed, and the share below 0.1. By surfaces alone, unless --same-triangulation. --samples:
/// of two small sample surfaces instead.
namespace moduli {
namespace {

struct Settings {
  std::size_t max_faces = 30000;
  PairOptions pairs;
  std::set<std::string> kinds = {matchKinds().begin(), matchKinds().end()};
  MatchOptions match;
  std::vector<std::string> files;
  bool samples = false;
  bool json = false;
};

Status usage(const std::string& what) {
  return {Reason::kInvalidOption, what,
          "options are --max-faces N, --seed N, --kinds KIND,..., --noise SHARE, "
          "--same-triangulation, --samples, --json; the others are meshes"};
}

Result<std::size_t> countOf(const std::string& option, const std::string& text) {
  const auto value = parseInteger(text);
  if (!value || *value < 0) return usage(option + " takes a whole number, not '" + text + "'");
  return static_cast<std::size_t>(*value);
}

std::set<std::string> splitAtCommas(const std::string& text) {
  std::set<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.insert(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

Status take(const std::string& option, const std::string& value, Settings& settings) {
  if (option == "--max-faces") {
    ASSIGN_OR_RETURN(settings.max_faces, countOf(option, value));
  } else if (option == "--seed") {
    ASSIGN_OR_RETURN(settings.pairs.seed, countOf(option, value));
  } else if (option == "--kinds") {
    settings.kinds = splitAtCommas(value);
  } else if (option == "--noise") {
    const auto share = parseDouble(value);
    if (!share || !(*share >= 0)) return usage("--noise takes a share, not '" + value + "'");
    settings.pairs.noise = *share;
  } else {
    return usage("there is no option '" + option + "'");
  }
  return {};
}

Result<Settings> parse(const std::vector<std::string>& arguments) {
  Settings settings;
  settings.match.same_triangulation = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& option = arguments[i];
    if (!option.starts_with("--")) {
      settings.files.push_back(option);
    } else if (option == "--json") {
      settings.json = true;
    } else if (option == "--samples") {
      settings.samples = true;
    } else if (option == "--same-triangulation") {
      settings.match.same_triangulation = true;
    } else if (i + 1 == arguments.size()) {
      return usage("'" + option + "' is unknown or lacks its value");
    } else {
      RETURN_IF_ERROR(take(option, arguments[++i], settings));
    }
  }
  return settings;
}

Result<std::vector<MatchBase>> basesOf(Context& context, const Settings& settings) {
  std::vector<MatchBase> bases;
  if (settings.samples) {
    ASSIGN_OR_RETURN(TriangleSoup plate, makeSample("genus", {{"genus", 2}, {"resolution", 6}}));
    // Thicker towards one side, for else it would be symmetric.
    for (Eigen::Vector3d& p : plate.vertices) p[2] *= 1 + 0.2 * p[0] + 0.15 * p[1];
    return std::vector<MatchBase>{{"lump", lump(12, 1)}, {"plate", std::move(plate)}};
  }
  if (settings.files.empty()) bases = sharedBases(context, settings.max_faces);
  for (const std::string& file : settings.files) {
    ASSIGN_OR_RETURN(MatchBase base, readBase(context, file, settings.max_faces));
    bases.push_back(std::move(base));
  }
  if (bases.empty()) {
    return Status(Reason::kFileNotFound, "there are no shared meshes",
                  "name meshes, or set MODULI_SHARED to the folder with meshes/");
  }
  return bases;
}

Status run(const std::vector<std::string>& arguments) {
  ASSIGN_OR_RETURN(const Settings settings, parse(arguments));
  Context context;
  ASSIGN_OR_RETURN(const std::vector<MatchBase> bases, basesOf(context, settings));
  std::vector<PairScore> scores;
  if (!settings.json) std::fputs(scoreHead().c_str(), stdout);
  for (const MatchBase& base : bases) {
    for (const std::string& kind : settings.kinds) {
      const Result<KnownPair> pair = makePair(base, kind, settings.pairs);
      if (!pair.ok()) {  // Such as limbs of what is flat.
        std::fprintf(stderr, "%s, %s: %s\n", base.name.c_str(), kind.c_str(),
                     pair.status().toString().c_str());
        continue;
      }
      scores.push_back(scorePair(*pair, settings.match));
      if (!settings.json) std::fputs(scoreLine(scores.back()).c_str(), stdout);
      std::fflush(stdout);
    }
  }
  std::fputs((settings.json ? scoreJson(scores) : meanLines(scores)).c_str(), stdout);
  return {};
}

}  // namespace
}  // namespace moduli

int main(int argc, char** argv) {
  const moduli::Status status = moduli::run({argv + 1, argv + argc});
  if (status.ok()) return EXIT_SUCCESS;
  std::fprintf(stderr, "moduli_match_bench: %s\n", status.toString().c_str());
  return EXIT_FAILURE;
}
