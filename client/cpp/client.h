#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/cpp/ingest.h"
#include "client/cpp/matched_surfaces.h"
#include "client/cpp/mesh_bytes.h"
#include "client/cpp/minimized_function.h"
#include "client/cpp/paging.h"
#include "client/cpp/parameterized_mesh.h"
#include "client/cpp/retry.h"
#include "core/base/status.h"
#include "moduli/v1/catalog.pb.h"
#include "moduli/v1/geometry_service.pb.h"
#include "moduli/v1/optimize.pb.h"

namespace grpc {
class Channel;
}

/// The services of modulid as functions.
///
///   ASSIGN_OR_RETURN(auto channel, connectTo({.server = "localhost:7447"}));
///   Client client(channel);
///   ASSIGN_OR_RETURN(MeshBytes bytes, MeshBytes::ofFile("bunny.obj"));
///   v1::ComputeSignatureRequest request;
///   ASSIGN_OR_RETURN(*request.mutable_source(), client.sendMesh(bytes, "bunny.obj"));
///   ASSIGN_OR_RETURN(v1::Signature signature, client.computeSignature(request));
namespace moduli {

struct ClientOptions {
  /// All calls together must be done by then; empty: no limit.
  std::optional<std::chrono::steady_clock::time_point> deadline = {};
  std::string token = {};  ///< "": none.
  RetryPolicy retry = {};
  /// Told how far the running call is, from the thread that made the call.
  std::function<void(const v1::Progress&)> progress = {};
};

/// Each function makes one or more calls and returns when they are done. Failures are those of the
/// service, and kServerUnreachable, kServerTooOld, kServerDraining, kDeadlineExceeded, kCancelled.
/// Calls that may safely run twice are retried as ClientOptions::retry says. Thread-safe.
class Client {
 public:
  explicit Client(std::shared_ptr<grpc::Channel> channel, ClientOptions options = {});
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Ends running calls with kCancelled and refuses later ones; from any thread but a signal
  /// handler.
  void cancel();

  Result<v1::ServerInfo> serverInfo();

  static constexpr std::uint64_t kInlineLimit = 4ULL << 20;

  /// Makes a mesh, or any file, known to the server: within the request up to `inline_limit` bytes
  /// (4 MiB; requests have 8 MiB in all), by an upload above. An upload that breaks is resumed; one
  /// that is there already is not sent again. name: for messages and its extension.
  Result<v1::MeshSource> sendMesh(
      const MeshBytes& bytes, const std::string& name,
      v1::MeshSource::Format format = v1::MeshSource::FORMAT_UNSPECIFIED,
      std::uint64_t inline_limit = kInlineLimit);

  Result<v1::Inspection> inspect(const v1::InspectMeshRequest& request);
  Result<v1::Signature> computeSignature(const v1::ComputeSignatureRequest& request);
  Result<v1::SignatureDistances> compareSignatures(const v1::CompareSignaturesRequest& request);
  /// Fails with kInternal where the arrays that arrive are broken (see ArrayAssembler).
  Result<ParameterizedMesh> parameterize(const v1::ParameterizeRequest& request);

  /// Fails with kInternal where the map that arrives is broken (see MatchAssembler).
  Result<MatchedSurfaces> match(const v1::MatchSurfacesRequest& request);

  /// A search that has not converged is no failure: the result tells. Fails with kInternal where
  /// the arrays that arrive are broken (see MinimizeAssembler).
  Result<MinimizedFunction> minimize(const v1::MinimizeRequest& request);
  /// Of a request with direction_at.
  Result<v1::AffineDirection> affineNormal(const v1::MinimizeRequest& request);

  /// Collections and shapes go by resource name: collections/C and collections/C/shapes/S.
  /// wanted_recall: as in v1::Collection.
  Result<v1::Collection> createCollection(const std::string& id,
                                          const std::optional<double>& wanted_recall = {});
  Result<v1::Collection> setWantedRecall(const std::string& name,
                                         const std::optional<double>& wanted_recall);
  Result<v1::Collection> getCollection(const std::string& name);
  Pager<v1::Collection> listCollections();
  Result<v1::DeleteCollectionResponse> deleteCollection(const std::string& name, bool force);

  Result<v1::Shape> getShape(const std::string& name);
  Pager<v1::Shape> listShapes(const std::string& collection, const std::string& filter);
  Status deleteShape(const std::string& name);
  Result<v1::BatchDeleteShapesResponse> deleteShapes(const v1::BatchDeleteShapesRequest& request);
  Result<v1::Shape> updateShape(const v1::UpdateShapeRequest& request);

  /// What download() says of the file before its first bytes.
  struct DownloadHeader {
    v1::MeshSource::Format format = v1::MeshSource::FORMAT_UNSPECIFIED;
    std::string file_name;
    std::int64_t size = 0;
  };
  /// Hands the stored file's bytes to `sink`, in pieces. A failure of the sink ends the download
  /// and is returned. Fails with kInternal if the bytes end too early.
  Result<DownloadHeader> download(const std::string& name,
                                  const std::function<Status(std::string_view)>& sink);

  /// All of the k hits, page by page. A mesh that needs several pages is signed once.
  Result<v1::SearchResult> search(const v1::SearchShapesRequest& request);
  /// A result for each query, in their order; any number of queries, over several requests where
  /// one cannot hold them. A query that fails says so in its result.
  Result<std::vector<v1::QueryResult>> searchMany(const v1::BatchSearchShapesRequest& request);
  Result<v1::Evaluation> evaluate(const v1::EvaluateCollectionRequest& request);
  Result<v1::Duplicates> findDuplicates(const v1::FindDuplicatesRequest& request);

  /// Signs and stores many files; see ingest.h.
  Status ingest(const IngestOptions& options, const IngestSource& next,
                const IngestListener& listener);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

std::string collectionName(const std::string& collection_id);
std::string shapeName(const std::string& collection_id, const std::string& shape_id);
/// The part after the last "/": the id of a resource name.
std::string idOf(const std::string& resource_name);

}  // namespace moduli
