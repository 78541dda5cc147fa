#pragma once

#include <string>

#include "client/cli/picture_options.h"
#include "client/cpp/minimized_function.h"
#include "core/base/status.h"
#include "moduli/v1/optimize.pb.h"

namespace moduli::cli {

/// What a picture of a minimization shows.
struct MinimizePicture {
  const v1::MinimizeRequest& request;
  const MinimizedFunction& function;  ///< With its trace; where drawsPlane(), with its path.
  std::string title;
  PictureFormat format = PictureFormat::kPng;
  PictureSize size = {900, 720};
};

/// Whether a picture shows the plane: a test function of two unknowns.
bool drawsPlane(const v1::MinimizeRequest& request);

/// In the plane the level sets of the function around the path, the directions in which the method
/// would go, and the path; otherwise the norm of the gradient and how far the value is above its
/// last one against the iterations. The bytes of a PNG or SVG file. Fails with kInternal as
/// drawShapes does.
Result<std::string> drawMinimization(const MinimizePicture& picture);

}  // namespace moduli::cli
