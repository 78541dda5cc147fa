#include "tests/server/service/fixture.h"

#include <grpcpp/generic/generic_stub.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <thread>
#include <utility>

#include "core/mesh/samples.h"
#include "core/mesh/write.h"

namespace moduli {
namespace {

namespace fs = std::filesystem;

// Below the 1 MiB that a chunk may have.
constexpr std::size_t kChunk = 256 << 10;

template <typename Response>
Result<Response> answered(const grpc::Status& status, const Response& response) {
  if (!status.ok()) return fromGrpcStatus(status);
  return response;
}

/// The health service's messages are one field each (grpc/health/v1/health.proto): the name of the
/// service asked for, and the state in the answer, 1 for SERVING.
grpc::ByteBuffer healthRequest(const std::string& service) {
  std::string bytes;
  if (!service.empty()) {
    bytes = "\x0a";
    bytes += static_cast<char>(service.size());
    bytes += service;
  }
  const grpc::Slice slice(bytes);
  return grpc::ByteBuffer(&slice, 1);
}

}  // namespace

TemporaryFolder::TemporaryFolder(Place place) {
  const fs::path memory = "/dev/shm";
  const bool use_memory = place == Place::kMemory && ::access(memory.c_str(), W_OK) == 0;
  std::string pattern =
      ((use_memory ? memory : fs::temp_directory_path()) / "moduli_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) std::abort();
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TemporaryFolder::file(const std::string& name, const std::string& content) const {
  const std::string path = path_ + "/" + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

std::string sampleFile(const std::string& kind, const std::map<std::string, double>& parameters) {
  const Result<TriangleSoup> soup = makeSample(kind, parameters);
  EXPECT_OK(soup);
  const Result<std::string> bytes = writeMesh(*soup, MeshFormat::kOff);
  EXPECT_OK(bytes);
  return *bytes;
}

std::string smallMesh(int number) {
  return sampleFile("ellipsoid", {{"resolution", 4}, {"b", 0.5 + 0.001 * number}});
}

const std::string& largeMesh() {
  static const std::string bytes = sampleFile("ellipsoid", {{"resolution", 101}});
  return bytes;
}

std::string numbered(std::string prefix, int number) {
  prefix += std::to_string(number);
  return prefix;
}

v1::MeshSource inlineSource(const std::string& bytes, const std::string& name) {
  v1::MeshSource source;
  source.set_inline_(bytes);
  source.set_file_name(name);
  return source;
}

v1::MeshSource digestSource(const std::string& digest) {
  v1::MeshSource source;
  source.set_digest(digest);
  return source;
}

v1::MeshSource shapeSource(const std::string& shape) {
  v1::MeshSource source;
  source.set_shape(shape);
  return source;
}

bool eventually(const std::function<bool()>& condition, std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

Peer::Peer(std::shared_ptr<grpc::Channel> channel)
    : channel_(std::move(channel)),
      geometry_(v1::GeometryService::NewStub(channel_)),
      catalog_(v1::CatalogService::NewStub(channel_)) {}

Peer Peer::at(const std::string& address) {
  grpc::ChannelArguments arguments;
  // A connection of its own: otherwise channels to one address share one.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return Peer(grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
}

Result<v1::Collection> Peer::createCollection(const std::string& id) {
  grpc::ClientContext context;
  v1::CreateCollectionRequest request;
  request.set_collection_id(id);
  v1::Collection response;
  return answered(catalog().CreateCollection(&context, request, &response), response);
}

Result<v1::Signature> Peer::sign(const v1::MeshSource& source, v1::Signature::Space space) {
  grpc::ClientContext context;
  v1::ComputeSignatureRequest request;
  *request.mutable_source() = source;
  request.set_space(space);
  ASSIGN_OR_RETURN(const auto last, lastEvent(*geometry().ComputeSignature(&context, request)));
  if (!last.has_signature()) return Status(Reason::kInternal, "the stream had no signature");
  return last.signature();
}

Result<v1::SearchShapesResponse> Peer::searchPage(const v1::SearchShapesRequest& request) {
  grpc::ClientContext context;
  ASSIGN_OR_RETURN(const auto last, lastEvent(*catalog().SearchShapes(&context, request)));
  if (!last.has_result()) return Status(Reason::kInternal, "the stream had no result");
  return last;
}

Result<v1::SearchResult> Peer::search(const v1::SearchShapesRequest& request) {
  ASSIGN_OR_RETURN(const v1::SearchShapesResponse page, searchPage(request));
  return page.result();
}

Result<std::vector<v1::QueryResult>> Peer::searchMany(const v1::BatchSearchShapesRequest& request) {
  grpc::ClientContext context;
  const auto reader = catalog().BatchSearchShapes(&context, request);
  std::vector<v1::QueryResult> results;
  v1::BatchSearchShapesResponse event;
  while (reader->Read(&event)) {
    if (event.has_result()) results.push_back(event.result());
  }
  return answered(reader->Finish(), results);
}

Result<v1::Shape> Peer::getShape(const std::string& name) {
  grpc::ClientContext context;
  v1::GetShapeRequest request;
  request.set_name(name);
  v1::Shape response;
  return answered(catalog().GetShape(&context, request, &response), response);
}

Result<std::vector<v1::Shape>> Peer::listShapes(const std::string& collection) {
  std::vector<v1::Shape> shapes;
  v1::ListShapesRequest request;
  request.set_parent("collections/" + collection);
  request.set_page_size(7);
  for (;;) {
    grpc::ClientContext context;
    v1::ListShapesResponse response;
    const grpc::Status status = catalog().ListShapes(&context, request, &response);
    if (!status.ok()) return fromGrpcStatus(status);
    shapes.insert(shapes.end(), response.shapes().begin(), response.shapes().end());
    if (response.next_page_token().empty()) return shapes;
    request.set_page_token(response.next_page_token());
  }
}

Result<std::string> Peer::download(const std::string& name) {
  grpc::ClientContext context;
  v1::DownloadMeshRequest request;
  request.set_name(name);
  const auto reader = catalog().DownloadMesh(&context, request);
  std::string bytes;
  v1::DownloadMeshResponse message;
  while (reader->Read(&message)) bytes += message.data();
  return answered(reader->Finish(), bytes);
}

Result<std::string> Peer::upload(const std::string& bytes) {
  grpc::ClientContext context;
  v1::UploadMeshResponse response;
  const auto writer = geometry().UploadMesh(&context, &response);
  v1::UploadMeshRequest request;
  request.set_digest(sha256Hex(bytes));
  bool open = true;
  for (std::size_t offset = 0; open && offset < bytes.size(); offset += kChunk) {
    request.set_write_offset(static_cast<std::int64_t>(offset));
    request.set_data(bytes.substr(offset, kChunk));
    if (offset + kChunk >= bytes.size()) {
      request.set_finish_write(true);
      request.set_total_size(static_cast<std::int64_t>(bytes.size()));
    }
    open = writer->Write(request);  // False once the server has answered: the file is there.
  }
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  return answered(status, response.digest());
}

Result<std::map<int, v1::IngestShapesResponse>> Peer::ingest(
    const v1::IngestShapesRequest::Header& header,
    const std::vector<v1::IngestShapesRequest::Item>& items) {
  grpc::ClientContext context;
  const auto stream = catalog().IngestShapes(&context);
  std::thread sender([&] {
    v1::IngestShapesRequest request;
    *request.mutable_header() = header;
    bool open = stream->Write(request);
    for (std::size_t i = 0; open && i < items.size(); ++i) {
      *request.mutable_item() = items[i];
      open = stream->Write(request);
    }
    stream->WritesDone();
  });
  std::map<int, v1::IngestShapesResponse> outcomes;
  v1::IngestShapesResponse outcome;
  while (stream->Read(&outcome)) outcomes[outcome.index()] = outcome;
  sender.join();
  return answered(stream->Finish(), outcomes);
}

Result<bool> Peer::healthy(const std::string& service, std::chrono::milliseconds limit) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + limit);
  const grpc::ByteBuffer request = healthRequest(service);
  grpc::ByteBuffer response;
  std::promise<grpc::Status> done;
  grpc::GenericStub(channel_).UnaryCall(&context, "/grpc.health.v1.Health/Check", {}, &request,
                                        &response, [&](grpc::Status end) { done.set_value(end); });
  const grpc::Status status = done.get_future().get();
  if (!status.ok()) return fromGrpcStatus(status);
  grpc::Slice slice;
  if (!response.DumpToSingleSlice(&slice).ok()) return Status(Reason::kInternal, "no answer");
  return slice.size() == 2 && slice.begin()[1] == 1;
}

v1::IngestShapesRequest::Header ingestHeader(const std::string& collection,
                                             v1::IngestShapesRequest::OnExists on_exists) {
  v1::IngestShapesRequest::Header header;
  header.set_parent("collections/" + collection);
  header.set_create_collection(true);
  header.set_on_exists(on_exists);
  return header;
}

v1::IngestShapesRequest::Item ingestItemOf(int index, const std::string& id,
                                           const std::string& bytes) {
  v1::IngestShapesRequest::Item item;
  item.set_index(index);
  item.set_shape_id(id);
  *item.mutable_source() = inlineSource(bytes, id + ".off");
  return item;
}

v1::IngestShapesRequest::Item probeItemOf(int index, const std::string& id,
                                          const std::string& bytes) {
  v1::IngestShapesRequest::Item item;
  item.set_index(index);
  item.set_shape_id(id);
  item.set_probe_digest(sha256Hex(bytes));
  return item;
}

void ServiceTest::SetUp() {
  options_.listen = "127.0.0.1:0";
  options_.data_dir = folder_.path() + "/store";
  options_.threads = 2;
  configure(options_);
  restart();
}

void ServiceTest::restart() {
  peer_.reset();
  server_.reset();
  auto server = Server::start(options_);
  ASSERT_OK(server);
  server_ = *std::move(server);
  peer_ = std::make_unique<Peer>(Peer::at(server_->address()));
}

}  // namespace moduli
