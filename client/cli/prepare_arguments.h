#pragma once

#include "client/cli/command.h"
#include "moduli/v1/signature.pb.h"

namespace moduli::cli {

/// What prepareOptions() were given.
inline v1::PrepareOptions prepareOf(const Arguments& arguments) {
  v1::PrepareOptions prepare;
  prepare.set_repair(arguments.has("repair"));
  if (arguments.has("fill-holes")) prepare.set_fill_holes(arguments.number("fill-holes", 0));
  prepare.set_component(arguments.text("component"));
  return prepare;
}

/// What spaceOption() was given.
inline v1::Signature::Space spaceOf(const Arguments& arguments) {
  const std::string name = arguments.text("space");
  if (name == "conformal") return v1::Signature::CONFORMAL;
  if (name == "metric") return v1::Signature::METRIC;
  if (name == "shape") return v1::Signature::SHAPE;
  return v1::Signature::SPACE_UNSPECIFIED;
}

}  // namespace moduli::cli
