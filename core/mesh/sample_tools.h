#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/mesh/triangle_soup.h"

/// What the makers of sample surfaces share.
namespace moduli {

/// A small generator of our own (splitmix64), so that a seed means the same on every machine.
class SampleRandom {
 public:
  explicit SampleRandom(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  /// Uniform in the unit ball.
  Eigen::Vector3d inBall();

 private:
  std::uint64_t state_;
};

/// The parameters of one sample, all present: given ones over defaults.
class SampleValues {
 public:
  explicit SampleValues(std::map<std::string, double> values) : values_(std::move(values)) {}
  double operator[](const std::string& name) const { return values_.at(name); }
  /// A count; valid after checkCount.
  Index count(const std::string& name) const { return static_cast<Index>(values_.at(name)); }
  /// Not 0 if an irregular triangulation is wanted.
  std::uint64_t seed() const { return static_cast<std::uint64_t>(values_.at("seed")); }

  /// Fails with kInvalidOption unless the value is a positive finite number.
  Status checkPositive(const std::string& name) const;
  /// Fails with kInvalidOption unless the value is a whole number from lowest to highest.
  Status checkCount(const std::string& name, Index lowest, Index highest) const;

 private:
  std::map<std::string, double> values_;
};

/// Fails with kInvalidOption if a sample would have more faces than any sample may.
Status checkSampleSize(double faces);
/// "NAME must be ...", for a sample's parameter.
Status sampleError(const std::string& message, const std::string& hint = {});

/// Splits every face of a manifold soup into n x n flat faces. Vertices of the soup come first,
/// then those on its edges, then those within its faces. O(F n^2).
TriangleSoup subdivideFaces(const TriangleSoup& base, Index n);

/// Strings rings of vertices together, from the inside out or from the top down; faces are counter-
/// clockwise seen from outside or above when the vertices of a ring are.
class RingStack {
 public:
  /// random: chooses diagonals of quads if not null; must live as long as the stack.
  explicit RingStack(SampleRandom* random) : random_(random) {}
  /// Connects a ring to the one before it. Sizes are equal, or differ by `sectors`, or one is 1.
  void add(const std::vector<Eigen::Vector3d>& ring, Index sectors = 0);
  /// Connects the last ring to the first, of the same size.
  void close();
  TriangleSoup take() { return std::move(soup_); }

 private:
  void connect(Index a, Index a_size, Index b, Index b_size, Index sectors);
  void connectEqual(Index a, Index b, Index size);

  SampleRandom* random_;
  TriangleSoup soup_;
  Index last_start_ = kNone;
  Index last_size_ = 0;
};

/// Points at equal angles on a circle about the z axis.
std::vector<Eigen::Vector3d> circleRing(double radius, double z, Index count);

/// Appends a quad as two faces, cut from its first corner or, at random, from its second.
void appendQuad(std::vector<Triangle>& faces, const std::array<Index, 4>& quad,
                SampleRandom* random);

/// Moves each vertex at random by up to a quarter of the smallest height of the faces around it
/// (so that no face turns over), then through `project` back into the surface.
void moveVertices(TriangleSoup& soup, SampleRandom& random,
                  const std::function<Eigen::Vector3d(Index, const Eigen::Vector3d&)>& project);

/// Six times the enclosed volume; positive for a closed surface oriented outwards.
double signedVolume6(const TriangleSoup& soup);

}  // namespace moduli
