#include "server/service/backend.h"

namespace moduli {

Result<Catalog*> Backend::catalog() const {
  if (Catalog* catalog = store->catalog()) return catalog;
  return Status(Reason::kStoreFailure, "this server has no store",
                "start it with --data DIR, or give the mesh itself");
}

}  // namespace moduli
