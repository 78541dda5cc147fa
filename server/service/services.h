#pragma once

#include <memory>

#include "server/service/backend.h"

namespace grpc {
class Service;
}

namespace moduli {

/// moduli.v1.GeometryService. backend must outlive it.
std::unique_ptr<grpc::Service> makeGeometryService(Backend& backend);

/// moduli.v1.CatalogService. backend must outlive it.
std::unique_ptr<grpc::Service> makeCatalogService(Backend& backend);

/// moduli.v1.OptimizeService. backend must outlive it.
std::unique_ptr<grpc::Service> makeOptimizeService(Backend& backend);

}  // namespace moduli
