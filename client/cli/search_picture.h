#pragma once

#include <string>
#include <vector>

#include "client/cli/mesh_argument.h"
#include "client/cpp/client.h"
#include "core/base/status.h"
#include "core/picture/image.h"

namespace moduli::cli {

/// What a contact sheet of a search shows.
struct SearchPicture {
  std::string collection;
  std::string query;                   ///< As the user named it.
  std::string query_resource;          ///< Resource name of a stored query, or
  const MeshArgument* mesh = nullptr;  ///< the file that was given.
  v1::SearchResult result;
};

/// Draws the query and its hits, nearest first, with names and distances: a PNG file's bytes. The
/// hits' meshes are fetched from the server one after the other.
Result<std::string> drawSearch(Client& client, const SearchPicture& picture);

}  // namespace moduli::cli
