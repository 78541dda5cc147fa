#include "client/cli/plane_options.h"

#include <charconv>

namespace moduli::cli {
namespace {

/// "0,12,40": numbers that are not negative; nothing where they are not that.
std::optional<std::vector<int>> parseVertices(const std::string& text) {
  std::vector<int> vertices;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    int vertex = 0;
    const auto [next, error] = std::from_chars(at, end, vertex);
    if (error != std::errc() || vertex < 0) return std::nullopt;
    vertices.push_back(vertex);
    if (next == end) return vertices;
    if (*next != ',') return std::nullopt;
    at = next + 1;
  }
}

}  // namespace

bool choosesCones(const Arguments& arguments) {
  return arguments.text("cones") == "auto";
}

std::vector<OptionSpec> planeOptions() {
  return {
      {.names = "--cone-spread",
       .value = "X",
       .help =
           "Of cones that are chosen: enough where lengths are stretched by factors that are at "
           "most e^X apart (1)",
       .check = isPositiveNumber},
      {.names = "--most-cones",
       .value = "N",
       .help = "Of cones that are chosen: no more than these (64; with --to polycube 48, or more "
               "where a theorem asks for it)",
       .check = isPositiveInteger},
      {.names = "--seamless",
       .value = "",
       .help = "With --to flat --cones auto: curvatures are multiples of pi/2, so that a grid of "
               "squares goes on around every cone"},
      {.names = "--overlaps",
       .value = "cut|keep",
       .help = "Where a layout with cones, or of squares, lies on itself: cut it into islands side "
               "by side (cut), or leave it so",
       .choices = {"cut", "keep"}},
      {.names = "--seams",
       .value = "FILE",
       .help =
           "With --to flat, polycube or atlas: lines of vertices, each joined to the next by an "
           "edge, along which to cut in any case. What is missing is chosen: short, and around "
           "tips",
       .completion = Completion::kFile},
      {.names = "--margin",
       .value = "X",
       .help =
           "Between islands that are moved side by side, over the root of the area of all faces "
           "(0.01)",
       .check = isDistance},
      {.names = "--extraordinary",
       .value = "V,...",
       .help = "With --to atlas: the vertices that it leaves out. Default: as few as there can be, "
               "chosen: one with two handles or more, none on a torus, three without handles"},
      {.names = "--atlas",
       .value = "OUT.json",
       .help = "With --to atlas: write its charts and the motions between them",
       .completion = Completion::kFile},
      {.names = "--most-squares",
       .value = "N",
       .help = "With --to quads: about so many squares at most (2000); more allow squares that are "
               "more nearly square",
       .check = isPositiveNumber}};
}

std::optional<std::string> checkPlaneOptions(const Arguments& arguments) {
  const std::string target = arguments.text("to");
  const bool flat = target == "flat", polycube = target == "polycube";
  if (choosesCones(arguments) && !flat && !polycube) {
    return "--cones auto is for --to flat and --to polycube";
  }
  const bool chosen = (flat && choosesCones(arguments)) ||
                      (polycube && (choosesCones(arguments) || !arguments.has("cones")));
  for (const char* name : {"cone-spread", "most-cones"}) {
    if (arguments.has(name) && !chosen) {
      return "--" + std::string(name) + " is for cones that are chosen: --cones auto";
    }
  }
  if (arguments.has("seamless") && !(flat && choosesCones(arguments))) {
    return "--seamless is for --to flat --cones auto";
  }
  if (arguments.has("overlaps") && !flat && !polycube && target != "quads") {
    return "--overlaps is for --to flat, --to polycube and --to quads";
  }
  for (const char* name : {"seams", "margin"}) {
    if (arguments.has(name) && !flat && !polycube && target != "atlas") {
      return "--" + std::string(name) + " is for --to flat, --to polycube and --to atlas";
    }
  }
  if (arguments.text("component") == "all" && !flat) return "--component all is for --to flat";
  if (arguments.has("atlas") && target != "atlas") return "--atlas is for --to atlas";
  if (arguments.has("extraordinary")) {
    if (target != "atlas") return "--extraordinary is for --to atlas";
    if (!parseVertices(arguments.text("extraordinary"))) {
      return "--extraordinary takes vertices such as 0,12,40, not '" +
             arguments.text("extraordinary") + "'";
    }
  }
  if (arguments.has("most-squares") && target != "quads") return "--most-squares is for --to quads";
  return std::nullopt;
}

void setPlaneOptions(const Arguments& arguments, v1::ParameterizationOptions& options) {
  if (choosesCones(arguments) || arguments.has("cone-spread") || arguments.has("most-cones")) {
    v1::ConeChoice& choice = *options.mutable_cone_choice();
    if (arguments.has("cone-spread")) choice.set_spread(arguments.number("cone-spread", 1));
    if (arguments.has("most-cones")) choice.set_most(arguments.integer("most-cones", 64));
    choice.set_quarter_turns(arguments.has("seamless"));
  }
  if (arguments.has("margin")) options.set_margin(arguments.number("margin", 0));
  if (arguments.has("overlaps")) options.set_cut_overlaps(arguments.text("overlaps") == "cut");
  if (arguments.has("most-squares")) {
    options.set_most_squares(arguments.number("most-squares", 2000));
  }
  if (!arguments.has("extraordinary")) return;
  const auto vertices = parseVertices(arguments.text("extraordinary"));
  for (const int vertex : vertices.value_or(std::vector<int>())) options.add_extraordinary(vertex);
}

}  // namespace moduli::cli
