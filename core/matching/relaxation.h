#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/context.h"
#include "core/matching/face_distortion.h"
#include "core/matching/ring_mesh.h"
#include "core/matching/sphere_domain.h"

namespace moduli {

/// What a vertex is drawn to. The pull is robust: its cost is weight r^2 s^2 / (r^2 + s^2) at
/// distance r, so that a place much farther away than the scale s does not pull at all.
struct Attraction {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< In space, in the domain's unit.
  Image image = {};                                 ///< The same place.
  double weight = 0;                                ///< >= 0.
};

/// A map of a mesh's vertices, moved vertex by vertex so that its energy falls and no face ever
/// turns over: the distortion of the faces (FaceDistortion) and the pull of the attractions, both
/// weighted by areas. Owns the mesh; refers to the other parts, which must live as long.
///
/// On a disk the boundary's vertices have images on the boundary, and move along it; the pole
/// stays. A vertex that the mesh holds is drawn to its attraction however far it is, and does not
/// leave it once it is there.
class Relaxation {
 public:
  /// positions: per vertex, in the domain's unit. attractions: per vertex.
  Relaxation(RingMesh mesh, const std::vector<Eigen::Vector3d>& positions,
             const SphereDomain& domain, const std::vector<Attraction>& attractions)
      : mesh_(std::move(mesh)),
        positions_(&positions),
        domain_(&domain),
        attractions_(&attractions),
        images_(positions.size()),
        awake_(positions.size(), 1) {}

  RingMesh& mesh() { return mesh_; }
  const RingMesh& mesh() const { return mesh_; }
  const std::vector<Eigen::Vector3d>& positions() const { return *positions_; }
  /// The vertices that are in the mesh, ascending.
  std::vector<Index> present() const;
  /// The same by their distance from the middle of the surface: no numbering or motion changes it.
  std::vector<Index> inSweepOrder() const;

  Index vertexCount() const { return static_cast<Index>(images_.size()); }
  const Image& image(Index v) const { return images_[v]; }
  void setImage(Index v, Image image) { images_[v] = std::move(image); }
  void setAttractions(const std::vector<Attraction>& attractions) { attractions_ = &attractions; }
  /// pull: of the attractions against the distortion. scale: their s.
  void setPull(double pull, double scale) {
    pull_ = pull;
    scale_ = scale;
  }

  /// Moves a vertex by a step of Newton's method in the surface, so many times as long, and shorter
  /// until its faces stay positive and their energy falls; not at all where that does not happen.
  /// Returns by how much it fell. O(degree).
  double relax(Index v, double times = 1);

  /// Moves a vertex to its attraction where its faces stay positive and their energy falls.
  void jump(Index v);

  /// Relaxes vertices in the given order, again and again: until the energy above that of an
  /// isometry falls by less than `tolerance` of itself, or `sweeps` times.
  Status relaxAll(Context& context, const std::vector<Index>& order, int sweeps, double tolerance);

  /// Relaxes the vertices of separatedSets, each set side by side, `sweeps` times, by steps so many
  /// times as long: they look at their rings alone, so that the outcome is the same on any number
  /// of threads.
  Status relaxSets(Context& context, const std::vector<std::vector<Index>>& sets, int sweeps,
                   double times = 1);

  /// Relaxes these vertices and their neighbours, then what their moves disturb; `sweeps` rounds at
  /// most. O(what moves).
  void relaxNear(const std::vector<Index>& vertices, int sweeps, double tolerance);

  /// Gives a vertex that has just been put back into the mesh an image in the kernel of its ring:
  /// its attraction, the mean of its ring or a point between the latter and `kept`, whichever costs
  /// least. kept: the vertex it came from. False where no double does.
  bool place(Index v, Index kept);

  /// Whether a face is positive, on the sphere no needle (clearance above 1e-5), and its energy at
  /// most `most` times that of an isometry.
  bool isTame(Index a, Index b, Index c, double most) const;

  /// Of all faces at the vertices, less 4 areas (the least there is), with the pull; per area.
  double excess(const std::vector<Index>& vertices) const;

  /// The least clearance (SphereDomain) of the faces around a vertex with that image; 0 where one
  /// is not positive. What is at least kClear counts as that.
  double clearance(Index v, const Image& image) const;

 private:
  struct Star;
  struct Step;
  /// By how much a vertex must lower the energy to disturb its neighbours.
  double restingGain(double tolerance) const;
  Star starOf(Index v) const;
  /// Whether a vertex that is held is at its place.
  bool isFixed(Index v) const;
  /// Puts a vertex that is held at its place, if its faces stay positive.
  bool fix(Index v);
  Image moved(Index v, const Eigen::Vector3d& step) const;
  double energy(const Star& star, Index v, const Image& image) const;
  double pullEnergy(double mass, Index v, const Eigen::Vector3d& at) const;
  Step newtonStep(const Star& star, Index v) const;
  Eigen::Vector3d meanOfRing(Index v) const;
  /// Offers places on the boundary for a vertex of it.
  void considerRim(Index v, Index kept, const std::function<bool(const Image&)>& consider) const;

  RingMesh mesh_;
  const std::vector<Eigen::Vector3d>* positions_;
  const SphereDomain* domain_;
  const std::vector<Attraction>* attractions_;
  std::vector<Image> images_;
  std::vector<char> awake_;
  double pull_ = 0, scale_ = 1;
};

}  // namespace moduli
