#include "tests/client/obj.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace moduli {
namespace {

double angleBetween(const std::complex<double>& a, const std::complex<double>& b) {
  return std::abs(std::arg(std::conj(a) * b));
}

}  // namespace

Obj Obj::parse(const std::string& text) {
  Obj obj;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v") {
      obj.vertices.push_back(line);
      auto& p = obj.positions.emplace_back();
      words >> p[0] >> p[1] >> p[2];
    } else if (keyword == "vt") {
      double u = 0, v = 0;
      words >> u >> v;
      EXPECT_FALSE(words.fail()) << line;
      obj.points.emplace_back(u, v);
    } else if (keyword == "f") {
      auto& face = obj.faces.emplace_back();
      auto& corners = obj.corners.emplace_back();
      for (int k = 0; k < 3; ++k) {
        std::string corner;
        words >> corner;
        const std::size_t slash = corner.find('/');
        face[k] = std::stoi(corner) - 1;
        corners[k] = slash == std::string::npos ? -1 : std::stoi(corner.substr(slash + 1)) - 1;
      }
      std::string more;
      EXPECT_FALSE(words >> more) << line;
    } else {
      ADD_FAILURE() << "an unexpected line: " << line;
    }
  }
  return obj;
}

std::vector<double> Obj::angleSums() const {
  std::vector<double> sums(positions.size(), 0.0);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto at = points[corners[f][k]];
      sums[faces[f][k]] +=
          angleBetween(points[corners[f][(k + 1) % 3]] - at, points[corners[f][(k + 2) % 3]] - at);
    }
  }
  return sums;
}

double Obj::doubledArea(std::size_t f) const {
  const auto a = points[corners[f][0]];
  return std::imag(std::conj(points[corners[f][1]] - a) * (points[corners[f][2]] - a));
}

std::map<Obj::Edge, std::vector<double>> Obj::edgeLengths() const {
  std::map<Edge, std::vector<double>> lengths;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int v = faces[f][k], w = faces[f][(k + 1) % 3];
      lengths[{std::min(v, w), std::max(v, w)}].push_back(
          std::abs(points[corners[f][(k + 1) % 3]] - points[corners[f][k]]));
    }
  }
  return lengths;
}

double Obj::spaceLength(const Edge& edge) const {
  double squared = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = positions[edge.first][i] - positions[edge.second][i];
    squared += d * d;
  }
  return std::sqrt(squared);
}

}  // namespace moduli
