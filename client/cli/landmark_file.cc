#include "client/cli/landmark_file.h"

#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "client/cli/side_file.h"
#include "core/base/text.h"

namespace moduli::cli {
namespace {

constexpr const char* kHint =
    "write 'vertexA vertexB', 'faceA b0 b1 b2 faceB b0 b1 b2' or 'curve COUNT: a1 a2 ... : b1 b2 "
    "...' on each line";

using Words = std::span<const std::string>;

std::string quoted(const std::string& word) {
  constexpr std::size_t kShown = 40;
  return "'" + (word.size() <= kShown ? word : word.substr(0, kShown) + "...") + "'";
}

/// One line on its way to a landmark.
class LandmarkLine {
 public:
  LandmarkLine(const std::string& path, const SideLine& line)
      : place_(path + ":" + std::to_string(line.number)) {
    // A colon is a word of its own.
    for (const std::string& word : line.words) {
      std::string rest;
      for (const char c : word) {
        if (c != ':') {
          rest += c;
          continue;
        }
        if (!rest.empty()) words_.push_back(rest);
        words_.emplace_back(":");
        rest.clear();
      }
      if (!rest.empty()) words_.push_back(rest);
    }
  }

  Status addTo(v1::SphereRegistration& registration) const {
    const Words words = words_;
    if (words.front() == "curve") return curve(*registration.add_curves());
    v1::LandmarkPair& pair = *registration.add_landmarks();
    pair.set_name(place_);
    if (words.size() == 2) {
      ASSIGN_OR_RETURN(const int a, index(words[0], "vertex"));
      ASSIGN_OR_RETURN(const int b, index(words[1], "vertex"));
      pair.mutable_point()->set_vertex(a);
      pair.mutable_reference()->set_vertex(b);
      return {};
    }
    if (words.size() == 8) {
      ASSIGN_OR_RETURN(*pair.mutable_point(), inFace(words.first(4)));
      ASSIGN_OR_RETURN(*pair.mutable_reference(), inFace(words.last(4)));
      return {};
    }
    return wrong(Reason::kSyntaxError, "has " + std::to_string(words.size()) +
                                           (words.size() == 1 ? " word" : " words") +
                                           " instead of two vertices, or two faces with weights");
  }

 private:
  Status wrong(Reason reason, const std::string& what) const {
    return {reason, place_ + ": " + what, kHint};
  }

  Result<int> index(const std::string& word, const std::string& what) const {
    const auto number = parseInteger(word);
    if (!number)
      return wrong(Reason::kSyntaxError, quoted(word) + " is not a " + what + "'s number");
    if (*number < 0 || *number > std::numeric_limits<int>::max()) {
      return wrong(Reason::kIndexOutOfRange, "there is no " + what + " " + quoted(word));
    }
    return static_cast<int>(*number);
  }

  Result<v1::SurfacePoint> inFace(Words words) const {
    v1::SurfacePoint point;
    ASSIGN_OR_RETURN(const int face, index(words[0], "face"));
    point.set_face(face);
    double sum = 0;
    for (const std::string& word : words.subspan(1)) {
      const auto weight = parseDouble(word);
      if (!weight || !std::isfinite(*weight)) {
        return wrong(Reason::kSyntaxError, quoted(word) + " is not a weight");
      }
      if (*weight < 0) {
        return wrong(Reason::kInvalidOption,
                     "the weight " + quoted(word) + " lies outside of face " + words[0]);
      }
      point.add_barycentric(*weight);
      sum += *weight;
    }
    if (std::abs(sum - 1) > 1e-3) {
      return wrong(Reason::kInvalidOption, "the weights in face " + words[0] + " sum to " +
                                               shortestDouble(sum) + ", not to 1");
    }
    return point;
  }

  Status curve(v1::LandmarkCurve& curve) const {
    curve.set_name(place_);
    const Words words = words_;
    std::vector<std::size_t> colons;
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] == ":") colons.push_back(i);
    }
    if (colons.size() != 2 || colons[0] != 2) {
      return wrong(Reason::kSyntaxError, "a curve has a count, and two lists behind colons");
    }
    ASSIGN_OR_RETURN(const int count, index(words[1], "count"));
    if (count < 2) return wrong(Reason::kInvalidOption, "a curve gives two landmarks or more");
    curve.set_count(count);
    const std::size_t second = colons[1];
    for (std::size_t i = 3; i < words.size(); ++i) {
      if (i == second) continue;
      ASSIGN_OR_RETURN(const int vertex, index(words[i], "vertex"));
      (i < second ? curve.mutable_vertices() : curve.mutable_reference_vertices())->Add(vertex);
    }
    if (curve.vertices_size() < 2 || curve.reference_vertices_size() < 2) {
      return wrong(Reason::kSyntaxError, "a curve has two vertices or more on each surface");
    }
    return {};
  }

  std::string place_;
  std::vector<std::string> words_;
};

}  // namespace

Result<v1::SphereRegistration> readLandmarks(const std::string& path) {
  ASSIGN_OR_RETURN(const std::vector<SideLine> lines, readSideFile(path));
  v1::SphereRegistration registration;
  for (const SideLine& line : lines) {
    RETURN_IF_ERROR(LandmarkLine(path, line).addTo(registration));
  }
  if (lines.empty()) return Status(Reason::kEmpty, path + ": has no landmarks", kHint);
  return registration;
}

}  // namespace moduli::cli
