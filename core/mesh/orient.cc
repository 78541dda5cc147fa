#include "core/mesh/orient.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moduli {
namespace {

// What decides which way a sheet faces.
struct SheetVolume {
  Index first_face = kNone;
  Index faces = 0;
  bool closed = true;
  double sum = 0;        // Of six times the signed volume under each face, seen from one corner.
  double magnitude = 0;  // Of the absolute values of the same.

  // A sum of n terms is off by at most n roundings of their magnitude.
  bool isInsideOut() const {
    return closed && sum < -faces * std::numeric_limits<double>::epsilon() * magnitude;
  }
};

std::vector<SheetVolume> measureSheets(const TriangleSoup& soup, const SoupStructure& structure) {
  // In units of the model's size, so that no product leaves the range of doubles.
  double size = 0;
  for (const Eigen::Vector3d& p : soup.vertices) {
    if (p.allFinite()) size = std::max(size, p.lpNorm<Eigen::Infinity>());
  }
  std::vector<SheetVolume> volumes(structure.sheets);
  for (Index f = 0; f < static_cast<Index>(soup.faces.size()); ++f) {
    if (structure.sheet[f] == kNone || !structure.inconsistent[structure.sheet[f]]) continue;
    SheetVolume& volume = volumes[structure.sheet[f]];
    if (volume.first_face == kNone) volume.first_face = f;
    ++volume.faces;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (!structure.isPaired(h)) volume.closed = false;
    }
    const Eigen::Vector3d& origin = soup.vertices[soup.faces[volume.first_face][0]];
    const Eigen::Vector3d a = (soup.vertices[soup.faces[f][0]] - origin) / size;
    const Eigen::Vector3d b = (soup.vertices[soup.faces[f][1]] - origin) / size;
    const Eigen::Vector3d c = (soup.vertices[soup.faces[f][2]] - origin) / size;
    const double term = a.dot(b.cross(c));
    volume.sum += structure.against[f] ? -term : term;
    volume.magnitude += std::abs(term);
  }
  return volumes;
}

}  // namespace

Index orientFaces(TriangleSoup& soup, const SoupStructure& structure) {
  const std::vector<SheetVolume> volumes = measureSheets(soup, structure);
  Index turned = 0;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    const Index sheet = structure.sheet[f];
    if (sheet == kNone || !structure.inconsistent[sheet] || structure.one_sided[sheet]) continue;
    if (structure.against[f] == volumes[sheet].isInsideOut()) continue;
    std::swap(soup.faces[f][1], soup.faces[f][2]);
    ++turned;
  }
  return turned;
}

}  // namespace moduli
