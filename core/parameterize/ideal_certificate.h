#pragma once

#include "core/mesh/connectivity.h"
#include "core/parameterize/parameterization.h"
#include "core/spherical/robust_map.h"

/// What all robust maps report. Internal to this room.
namespace moduli {

/// Fills in what judges an ideal polyhedron: its metric, its layout and its centring.
void certifyIdeal(const IdealPolyhedron& ideal, MapCertificate& certificate);

/// One point per vertex: the corner of halfedge h is tail(h).
std::vector<Index> vertexCorners(const Connectivity& surface);

}  // namespace moduli
