#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/client/json.h"

/// A .glb file for tests to look into: read plainly, apart from the library that writes it.
namespace moduli {

class Glb {
 public:
  /// Fails the running test on anything but a header, one chunk of JSON and at most one of bytes,
  /// each a multiple of four bytes long.
  static Glb parse(const std::string& bytes);

  const Json& json() const { return json_; }
  int primitives() const { return json_["meshes"].at(0)["primitives"].size(); }
  Json primitive(int i) const { return json_["meshes"].at(0)["primitives"].at(i); }

  /// An attribute of a primitive as it stands, and how many numbers a vertex has there; empty where
  /// the primitive has none of this name.
  std::vector<float> attribute(int primitive, const std::string& name) const;
  std::vector<std::uint32_t> indices(int primitive) const;
  /// The bytes of the first image.
  std::string image() const;

  Json accessor(int i) const { return json_["accessors"].at(i); }

 private:
  explicit Glb(Json json) : json_(std::move(json)) {}
  std::string view(int i) const;
  template <typename Number>
  std::vector<Number> numbers(int accessor, int component) const;

  Json json_;
  std::string bytes_;
};

/// What the Khronos validator says of a .glb file: "" where it is content, "skip: WHY" where it is
/// not installed, otherwise its errors and warnings. folder: for the file.
std::string gltfFault(const std::string& bytes, const std::string& folder);

}  // namespace moduli
