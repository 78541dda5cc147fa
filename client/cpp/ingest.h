#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "moduli/v1/catalog.pb.h"

/// Bulk ingest: any number of files over one stream, with a bounded number of them under way. A
/// file is read when its turn comes and sent only if the server does not have it, so that a
/// repeated run costs no more than reading. A stream that breaks is opened anew, and what was not
/// answered is asked for again: nothing is lost or stored twice.
namespace moduli {

/// One file to store.
struct IngestItem {
  std::size_t order = 0;  ///< The caller's own number for it; not sent.
  std::string path;
  std::string shape_id;
  std::string label;
  std::map<std::string, std::string> tags;
  v1::MeshSource::Format format = v1::MeshSource::FORMAT_UNSPECIFIED;
};

/// What became of it. outcome is ADDED, REPLACED, SKIPPED or FAILED.
struct IngestOutcome {
  v1::IngestShapesResponse::Outcome outcome = v1::IngestShapesResponse::FAILED;
  std::string name;  ///< collections/C/shapes/S, where the server got to know of it.
  std::string reason, message, hint;
};

struct IngestOptions {
  v1::IngestShapesRequest::Header header;
  /// Files that are sent and not yet answered, at most.
  std::size_t jobs = 8;
};

/// The next item, nothing at the end; called from the ingesting thread alone.
using IngestSource = std::function<std::optional<IngestItem>()>;
/// Called once per answered item, in the order of the answers, never twice at a time.
using IngestListener = std::function<void(const IngestItem&, const IngestOutcome&)>;

}  // namespace moduli
