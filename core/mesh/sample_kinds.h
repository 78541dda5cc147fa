#pragma once

#include "core/mesh/sample_tools.h"

/// One maker for each kind of sample. Parameters are as the table in samples.cc names them; every
/// maker checks the values of its own and fails with kInvalidOption.
namespace moduli {

Result<TriangleSoup> makeSphere(const SampleValues& values);
Result<TriangleSoup> makeEllipsoid(const SampleValues& values);
Result<TriangleSoup> makeSpheroid(const SampleValues& values);
Result<TriangleSoup> makeCappedCylinder(const SampleValues& values);
Result<TriangleSoup> makeTorus(const SampleValues& values);
Result<TriangleSoup> makeDiplotorus(const SampleValues& values);
Result<TriangleSoup> makeGenus(const SampleValues& values);
Result<TriangleSoup> makeAnnulus(const SampleValues& values);
Result<TriangleSoup> makeDisk(const SampleValues& values);
Result<TriangleSoup> makePlate(const SampleValues& values);

}  // namespace moduli
