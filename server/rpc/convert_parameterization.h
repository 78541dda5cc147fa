#pragma once

#include "core/parameterize/flat.h"
#include "core/parameterize/parameterization.h"
#include "core/parameterize/register_sphere.h"
#include "moduli/v1/parameterization.pb.h"

/// Parameterizations as messages of the public API and back. Pure; O(size of the value).
namespace moduli {

/// Of checked options, without their cones: those speak of the input's vertices. What is
/// unspecified has its default.
FlatOptions fromProto(const v1::ParameterizationOptions& options);

/// kAuto where it is unspecified.
MapMethod fromProto(v1::ParameterizationOptions::Method method);
v1::ParameterizationOptions::Method toProto(MapMethod method);

/// Of so many geodesics the points are those of GEODESICS, in order.
v1::HyperbolicDomain toProto(const HyperbolicDomain& domain);

/// Numbers that are not finite are left out.
v1::ParameterizationCertificate toProto(const MapCertificate& certificate);
/// Likewise. Whether the reference is a sphere is left open.
v1::RegistrationResult toProto(const SphereRegistration& registration);

}  // namespace moduli
