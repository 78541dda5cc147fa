#pragma once

#include <string>

#include "core/base/context.h"
#include "core/parameterize/parameterization.h"
#include "moduli/v1/parameterization.pb.h"
#include "server/service/subject.h"

/// The targets that cut a surface open and lay it into the plane: FLAT, TORUS, POLYCUBE, ATLAS and
/// QUADS.
namespace moduli {

bool isFlatTarget(v1::ParameterizationOptions::Target target);

/// Maps the surface of checked options whose target is one of these. Fails as the functions of
/// core/parameterize do, and with kInvalidOption for cones and extraordinary points that do not fit
/// the surface, in the numbers of the input.
Result<Parameterization> mapToPlane(Context& context, const v1::ParameterizationOptions& options,
                                    const Subject& subject);

/// What such a map has beside its certificate, in the numbers of the input. O(size of it).
void describePlane(const Subject& subject, const Parameterization& map,
                   v1::Parameterization& result);

/// The JSON form of a map's atlas, its vertices in the numbers of the surface that is sent (see
/// ArrayChunk); "" where it has none. O(F).
std::string atlasText(const Subject& subject, const Parameterization& map);

}  // namespace moduli
