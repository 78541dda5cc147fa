#pragma once

#include <optional>
#include <vector>

#include "core/base/status.h"
#include "core/mesh/format.h"
#include "core/mesh/inspect.h"
#include "core/mesh/prepare.h"
#include "core/signature/distance.h"
#include "core/signature/signature.h"
#include "moduli/v1/mesh.pb.h"
#include "moduli/v1/signature.pb.h"

/// Core values as messages of the public API and back. Pure; O(size of the value).
namespace moduli {

/// repair: what a repair would do.
v1::Inspection toProto(const Inspection& inspection, const std::vector<RepairAction>& repair);

v1::Circle toProto(const Circle& circle);
/// z -> (a z + b) / (conj(b) z + conj(a)).
v1::DiskIsometry toProto(const std::complex<double>& a, const std::complex<double>& b);

v1::Signature toProto(const Signature& signature);
/// Fails with kInvalidRequest on values that no signature has: a missing topology, a conformal
/// block without a type, numbers that are not finite, negative counts, circles without a
/// radius, over-long arrays.
Result<Signature> fromProto(const v1::Signature& signature);

v1::SignatureDistances toProto(const SignatureDistances& distances);
SignatureDistances fromProto(const v1::SignatureDistances& distances);

v1::MeshSource::Format toProto(MeshFormat format);
/// Empty for FORMAT_UNSPECIFIED and for values that this build does not know.
std::optional<MeshFormat> fromProto(v1::MeshSource::Format format);

v1::Signature::Space toProto(Space space);
/// Empty for SPACE_UNSPECIFIED and for values that this build does not know.
std::optional<Space> fromProto(v1::Signature::Space space);

v1::PrepareOptions toProto(const PrepareOptions& options);
PrepareOptions fromProto(const v1::PrepareOptions& options);

}  // namespace moduli
