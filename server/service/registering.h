#pragma once

#include <string>
#include <vector>

#include "core/parameterize/register_sphere.h"
#include "core/parameterize/sphere.h"
#include "moduli/v1/geometry_service.pb.h"
#include "server/service/backend.h"
#include "server/service/subject.h"

/// From a request for a registration to a sphere that lies on another.
namespace moduli {

/// The surface to register to, and what of both surfaces corresponds.
struct ReferenceSphere {
  Subject subject;
  std::string name;  ///< For messages.
  SphereRegistrationOptions options;
  std::vector<double> field;            ///< Per vertex of the surface that is registered; or empty.
  std::vector<double> reference_field;  ///< Per vertex of the reference; or empty.
};

/// Loads and prepares the reference of a checked request, reads the fields and places the
/// landmarks. Fails as these steps do; faults of the reference and of the fields name their files.
Result<ReferenceSphere> loadReference(Context& context, const Backend& backend,
                                      const v1::ParameterizeRequest& request,
                                      const Subject& subject);

struct RegisteredSphere {
  Parameterization map;  ///< The given one, laid onto the reference.
  v1::RegistrationResult result;
  std::vector<double> carried;  ///< Per vertex of the input; empty without a field to carry.
};

/// Maps the reference, unless it is a sphere, and lays the given map of the subject onto it.
/// options: how the reference is mapped. Fails as parameterizeSphere (naming the reference) and
/// registerSphere do.
Result<RegisteredSphere> registerOnReference(Context& context, const ReferenceSphere& reference,
                                             const Subject& subject, Parameterization map,
                                             const SphereOptions& options);

}  // namespace moduli
