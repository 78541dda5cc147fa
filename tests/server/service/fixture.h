#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/digest.h"
#include "moduli/v1/catalog.grpc.pb.h"
#include "moduli/v1/geometry_service.grpc.pb.h"
#include "server/rpc/grpc_status.h"
#include "server/server.h"
#include "tests/core/testing.h"

/// What the tests of the services share: a server in this process, reached over TCP on a free port.
namespace moduli {

/// A folder of its own below the system's temporary one, or in memory where there is such a place
/// (no test of durability wants that), gone with the object.
class TemporaryFolder {
 public:
  enum class Place { kMemory, kDisk };

  explicit TemporaryFolder(Place place = Place::kDisk);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  /// Writes a file into it and returns its path.
  std::string file(const std::string& name, const std::string& content) const;

 private:
  std::string path_;
};

/// Bytes of an OFF file of a sample surface.
std::string sampleFile(const std::string& kind, const std::map<std::string, double>& parameters);
/// A sphere-like surface of 320 faces, a different one for each number.
std::string smallMesh(int number);
/// A surface of 204,800 faces: signing it takes seconds.
const std::string& largeMesh();

/// The prefix with a number behind it.
std::string numbered(std::string prefix, int number);

v1::MeshSource inlineSource(const std::string& bytes, const std::string& name = "sample.off");
v1::MeshSource digestSource(const std::string& digest);
v1::MeshSource shapeSource(const std::string& shape);

/// Calls `condition` again and again until it holds or the time is over.
bool eventually(const std::function<bool()>& condition,
                std::chrono::milliseconds limit = std::chrono::seconds(20));

/// Client side of one server.
class Peer {
 public:
  explicit Peer(std::shared_ptr<grpc::Channel> channel);
  static Peer at(const std::string& address);

  v1::GeometryService::Stub& geometry() { return *geometry_; }
  v1::CatalogService::Stub& catalog() { return *catalog_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

  /// For calls that need no context of their own.
  Result<v1::Collection> createCollection(const std::string& id);
  Result<v1::Signature> sign(const v1::MeshSource& source,
                             v1::Signature::Space space = v1::Signature::SPACE_UNSPECIFIED);
  Result<v1::SearchResult> search(const v1::SearchShapesRequest& request);
  /// With the token of the next page.
  Result<v1::SearchShapesResponse> searchPage(const v1::SearchShapesRequest& request);
  Result<std::vector<v1::QueryResult>> searchMany(const v1::BatchSearchShapesRequest& request);
  Result<v1::Shape> getShape(const std::string& name);
  Result<std::vector<v1::Shape>> listShapes(const std::string& collection);
  Result<std::string> download(const std::string& name);
  /// The digest.
  Result<std::string> upload(const std::string& bytes);
  /// Sends the items and returns the outcomes by index.
  Result<std::map<int, v1::IngestShapesResponse>> ingest(
      const v1::IngestShapesRequest::Header& header,
      const std::vector<v1::IngestShapesRequest::Item>& items);
  /// Whether health says SERVING, within the time given.
  Result<bool> healthy(const std::string& service, std::chrono::milliseconds limit);

 private:
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::GeometryService::Stub> geometry_;
  std::unique_ptr<v1::CatalogService::Stub> catalog_;
};

v1::IngestShapesRequest::Header ingestHeader(
    const std::string& collection,
    v1::IngestShapesRequest::OnExists on_exists = v1::IngestShapesRequest::SKIP);
v1::IngestShapesRequest::Item ingestItemOf(int index, const std::string& id,
                                           const std::string& bytes);
v1::IngestShapesRequest::Item probeItemOf(int index, const std::string& id,
                                          const std::string& bytes);

/// Reads a stream of events to its end and returns the last one.
template <typename Response>
Result<Response> lastEvent(grpc::ClientReader<Response>& reader) {
  Response last, event;
  while (reader.Read(&event)) last = event;
  if (const grpc::Status status = reader.Finish(); !status.ok()) return fromGrpcStatus(status);
  return last;
}

/// A test with a server on a free port and an empty store.
class ServiceTest : public testing::Test {
 protected:
  /// Called with the usual options before the server starts.
  virtual void configure(ServerOptions&) {}

  void SetUp() override;
  /// Ends the server and starts one anew on the same store.
  void restart();

  TemporaryFolder folder_;
  ServerOptions options_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<Peer> peer_;
};

}  // namespace moduli
