#pragma once

#include "core/base/status.h"
#include "core/mesh/prepare.h"
#include "core/signature/signature.h"
#include "moduli/v1/catalog.pb.h"
#include "server/store/shape_record.h"

/// What the store keeps as ShapeRecord::signature: a serialized v1.Shape with nothing but its
/// signature and how the mesh was prepared for it.
namespace moduli {

struct StoredSignature {
  Signature signature;
  PrepareOptions prepare;
};

/// Fails with kStoreCorrupt.
Result<StoredSignature> readStored(const ShapeRecord& record);

/// How the mesh of a stored shape was prepared, whatever version its signature is of. Fails with
/// kStoreCorrupt.
Result<PrepareOptions> readPrepare(const ShapeRecord& record);

/// Fills signature, vectors, topology and descriptor_version of a record.
void fillRecord(const StoredSignature& stored, ShapeRecord& record);

/// The shape as the API shows it. A summary comes with topology and conformal type alone.
Result<v1::Shape> toProto(const ShapeRecord& record, bool full);

v1::Collection toProto(const CollectionRecord& record);

}  // namespace moduli
