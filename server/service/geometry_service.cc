#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/mesh/inspect.h"
#include "core/mesh/repair.h"
#include "core/signature/distance.h"
#include "moduli/v1/geometry_service.grpc.pb.h"
#include "server/rpc/convert.h"
#include "server/service/event_stream.h"
#include "server/service/matching.h"
#include "server/service/parameterizing.h"
#include "server/service/request.h"
#include "server/service/services.h"
#include "server/service/signing.h"
#include "server/service/unary_call.h"
#include "server/service/upload_call.h"
#include "server/service/version.h"

namespace moduli {
namespace {

using Rpc = grpc::CallbackServerContext;

v1::ServerInfo serverInfo(const Backend& backend) {
  v1::ServerInfo info;
  info.set_version(std::string(kVersion));
  info.set_descriptor_version(kDescriptorVersion);
  info.set_max_inline_bytes(kMaxInlineBytes);
  info.set_max_chunk_bytes(kMaxChunkBytes);
  info.set_max_faces(static_cast<int>(
      std::min<std::size_t>(backend.limits.max_faces, std::numeric_limits<std::int32_t>::max())));
  info.set_max_upload_bytes(static_cast<double>(backend.limits.max_upload_bytes));
  return info;
}

Result<v1::InspectMeshResponse> inspect(Context& context, const Backend& backend,
                                        const v1::InspectMeshRequest& request) {
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, request.source()));
  ASSIGN_OR_RETURN(const ParsedSurface parsed, parseSurface(context, backend, file));
  Context::Stage stage(context, "inspect");
  v1::InspectMeshResponse response;
  if (const auto* intrinsic = std::get_if<IntrinsicSurface>(&parsed)) {
    *response.mutable_inspection() = toProto(inspectSurface(*intrinsic), {});
    return response;
  }
  const auto& soup = std::get<TriangleSoup>(parsed);
  ASSIGN_OR_RETURN(const Inspection inspection, inspectSoup(context, soup));
  ASSIGN_OR_RETURN(const std::vector<RepairAction> repair, proposeRepair(context, soup));
  *response.mutable_inspection() = toProto(inspection, repair);
  return response;
}

Refusal checkSpectrumLength(const v1::ComputeSignatureRequest& request) {
  if (!request.has_spectrum_length()) return {};
  const double length = request.spectrum_length();
  if (std::isfinite(length) && length > 0) return {};
  return {{Reason::kInvalidOption, "the spectrum's length is not a positive number",
           "give a length, of curvature -1, such as 4"},
          "spectrum_length"};
}

Result<v1::ComputeSignatureResponse> sign(Context& context, const Backend& backend,
                                          const v1::ComputeSignatureRequest& request) {
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, request.source()));
  SignatureOptions options;
  options.space = fromProto(request.space());
  if (request.has_initial_delaunay()) options.initial_delaunay = request.initial_delaunay();
  if (request.has_spectrum_length()) options.spectrum_length = request.spectrum_length();
  ASSIGN_OR_RETURN(const Signature signature,
                   signMesh(context, backend, file, fromProto(request.prepare()), options));
  v1::ComputeSignatureResponse response;
  *response.mutable_signature() = toProto(signature);
  return response;
}

using Side = v1::CompareSignaturesRequest::Side;

Refusal checkSide(const Side& side, const std::string& field) {
  if (side.has_source()) return checkSource(side.source(), field + ".source");
  if (side.has_signature()) {
    const Status status = fromProto(side.signature()).status();
    return status.ok() ? Refusal{} : Refusal{status, field + ".signature"};
  }
  return {{Reason::kInvalidRequest, "no surface is given", "set source or signature"}, field};
}

Result<Signature> signSide(Context& context, const Backend& backend, const Side& side,
                           const PrepareOptions& prepare) {
  if (side.has_signature()) return fromProto(side.signature());
  ASSIGN_OR_RETURN(const MeshFile file, loadMesh(context, backend, side.source()));
  return signMesh(context, backend, file, prepare, {});
}

Result<v1::CompareSignaturesResponse> compare(Context& context, const Backend& backend,
                                              const v1::CompareSignaturesRequest& request) {
  const PrepareOptions prepare = fromProto(request.prepare());
  ASSIGN_OR_RETURN(const Signature a, signSide(context, backend, request.a(), prepare));
  ASSIGN_OR_RETURN(const Signature b, signSide(context, backend, request.b(), prepare));
  if (a.descriptor_version != b.descriptor_version) {
    return Status(Reason::kIncomparableSignatures,
                  "descriptor versions " + std::to_string(a.descriptor_version) + " and " +
                      std::to_string(b.descriptor_version) + " are not compared",
                  "sign both surfaces with the same version");
  }
  v1::CompareSignaturesResponse response;
  *response.mutable_distances() = toProto(signatureDistances(a, b));
  return response;
}

Result<EventStream<v1::ParameterizeResponse>::Parts> parameterize(
    Context& context, const Backend& backend, const v1::ParameterizeRequest& request) {
  ASSIGN_OR_RETURN(ParameterizedSurface surface, parameterizeMesh(context, backend, request));
  return parameterizationParts(std::make_shared<const ParameterizedSurface>(std::move(surface)),
                               request.omit_arrays());
}

Result<EventStream<v1::MatchSurfacesResponse>::Parts> match(
    Context& context, const Backend& backend, const v1::MatchSurfacesRequest& request) {
  ASSIGN_OR_RETURN(MatchedMeshes meshes, matchMeshes(context, backend, request));
  return matchParts(std::make_shared<const MatchedMeshes>(std::move(meshes)), request);
}

v1::QueryUploadResponse uploadState(const UploadState& state) {
  v1::QueryUploadResponse response;
  response.set_committed_size(state.committed_size);
  response.set_complete(state.complete);
  return response;
}

class GeometryService final : public v1::GeometryService::CallbackService {
 public:
  explicit GeometryService(Backend& backend) : backend_(backend) {}

  grpc::ServerUnaryReactor* GetServerInfo(Rpc* rpc, const v1::GetServerInfoRequest*,
                                          v1::ServerInfo* response) override {
    return UnaryCall<v1::ServerInfo>::answer(
        backend_, *rpc, *response, {"GetServerInfo"}, {},
        [this](Context&) -> Result<v1::ServerInfo> { return serverInfo(backend_); });
  }

  grpc::ServerReadReactor<v1::UploadMeshRequest>* UploadMesh(
      Rpc* rpc, v1::UploadMeshResponse* response) override {
    return UploadCall::answer(backend_, *rpc, *response);
  }

  grpc::ServerUnaryReactor* QueryUpload(Rpc* rpc, const v1::QueryUploadRequest* request,
                                        v1::QueryUploadResponse* response) override {
    return UnaryCall<v1::QueryUploadResponse>::answer(
        backend_, *rpc, *response, {"QueryUpload"}, checkDigest(request->digest(), "digest"),
        [this, digest = request->digest()](Context&) -> Result<v1::QueryUploadResponse> {
          ASSIGN_OR_RETURN(const UploadState state, backend_.store->uploads().query(digest));
          return uploadState(state);
        });
  }

  grpc::ServerWriteReactor<v1::InspectMeshResponse>* InspectMesh(
      Rpc* rpc, const v1::InspectMeshRequest* request) override {
    return EventStream<v1::InspectMeshResponse>::answer(
        backend_, *rpc, {"InspectMesh"}, checkSource(request->source(), "source"),
        [this, kept = std::make_shared<v1::InspectMeshRequest>(*request)](Context& context) {
          return inspect(context, backend_, *kept);
        });
  }

  grpc::ServerWriteReactor<v1::ComputeSignatureResponse>* ComputeSignature(
      Rpc* rpc, const v1::ComputeSignatureRequest* request) override {
    return EventStream<v1::ComputeSignatureResponse>::answer(
        backend_, *rpc, {"ComputeSignature"},
        firstOf(checkSource(request->source(), "source"),
                checkPrepare(request->prepare(), "prepare"), checkSpace(request->space(), "space"),
                checkSpectrumLength(*request)),
        [this, kept = std::make_shared<v1::ComputeSignatureRequest>(*request)](Context& context) {
          return sign(context, backend_, *kept);
        });
  }

  grpc::ServerWriteReactor<v1::CompareSignaturesResponse>* CompareSignatures(
      Rpc* rpc, const v1::CompareSignaturesRequest* request) override {
    return EventStream<v1::CompareSignaturesResponse>::answer(
        backend_, *rpc, {"CompareSignatures"},
        firstOf(checkSide(request->a(), "a"), checkSide(request->b(), "b"),
                checkPrepare(request->prepare(), "prepare")),
        [this, kept = std::make_shared<v1::CompareSignaturesRequest>(*request)](Context& context) {
          return compare(context, backend_, *kept);
        });
  }

  grpc::ServerWriteReactor<v1::ParameterizeResponse>* Parameterize(
      Rpc* rpc, const v1::ParameterizeRequest* request) override {
    return EventStream<v1::ParameterizeResponse>::answerInParts(
        backend_, *rpc, {"Parameterize"},
        firstOf(checkSource(request->source(), "source"),
                checkPrepare(request->prepare(), "prepare",
                             request->options().target() == v1::ParameterizationOptions::FLAT),
                checkParameterization(request->options(), "options")),
        [this, kept = std::make_shared<v1::ParameterizeRequest>(*request)](Context& context) {
          return parameterize(context, backend_, *kept);
        });
  }

  grpc::ServerWriteReactor<v1::MatchSurfacesResponse>* MatchSurfaces(
      Rpc* rpc, const v1::MatchSurfacesRequest* request) override {
    return EventStream<v1::MatchSurfacesResponse>::answerInParts(
        backend_, *rpc, {"MatchSurfaces"},
        firstOf(checkSource(request->a(), "a"), checkSource(request->b(), "b"),
                checkPrepare(request->prepare(), "prepare"),
                checkMatch(request->options(), "options")),
        [this, kept = std::make_shared<v1::MatchSurfacesRequest>(*request)](Context& context) {
          return match(context, backend_, *kept);
        });
  }

 private:
  Backend& backend_;
};

}  // namespace

std::unique_ptr<grpc::Service> makeGeometryService(Backend& backend) {
  return std::make_unique<GeometryService>(backend);
}

}  // namespace moduli
